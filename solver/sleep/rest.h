#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// Before a frame: wakes sleeping blocks that a user's force will act on, and all of them when gravity has changed since they
/// fell asleep.
void wakeForInputs(Simulation& simulation);

/// Once a frame's near pairs are found: wakes sleeping blocks on which awake ones slide fast, or that they may hit in it, with
/// all sleepers they touch, directly or through others: such a blow is over before what it does can be looked at. Returns whether
/// there were any; near pairs have then to be found again.
bool wakeOnImpact(Simulation& simulation);

/// At the end of a frame: finds the sleeping blocks to wake, whose awake neighbours push them otherwise than when they fell
/// asleep (engine.scratch.toWake). Where supports of some fail all are woken, and the frame has to be run again from its start:
/// returns whether it has.
bool wakeFailedSupports(Simulation& simulation);

/// After that: judges the rest of every awake block by its rigid motion and its balance, wakes what wakeFailedSupports has found,
/// and puts groups of touching blocks to sleep that are all at rest.
void updateRest(Simulation& simulation);

/// Wakes one block, if it sleeps, and counts why.
void wake(Simulation& simulation, std::size_t block, WakeReason reason);

}  // namespace springtower
