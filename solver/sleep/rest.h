#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// Before a frame: wakes sleeping blocks on which a user force will act, and all of them when gravity has changed since they fell
/// asleep.
void wakeForInputs(Simulation& simulation);

/// Once a frame's near pairs are found: wakes sleeping blocks on which awake ones slide fast, or which they may hit in this
/// frame, and all sleeping blocks connected to them by contacts: such an impact is over before its load change could be checked.
/// Returns whether there were any; near pairs then have to be found again. Blocks that touch others at another time of the frame
/// (engine.scratch.inParts) sleep on until those are stepped together again.
bool wakeOnImpact(Simulation& simulation);

/// At the end of a frame: finds the sleeping blocks to wake because the load from their awake neighbours has changed
/// (engine.scratch.toWake). If the supports of some fail, all found are woken and true is returned; the frame then has to be run
/// again from its start. Blocks that touch others at another time of the frame wake as the frame ends.
bool wakeFailedSupports(Simulation& simulation);

/// After that: updates the sleep timer of every awake block from its rigid motion and its force balance, wakes the blocks that
/// wakeFailedSupports has found, and puts groups of touching blocks to sleep that are all at rest.
void updateRest(Simulation& simulation);

/// Wakes one block, if it sleeps, and counts the reason.
void wake(Simulation& simulation, std::size_t block, WakeReason reason);

}  // namespace springtower
