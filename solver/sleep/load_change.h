#pragma once

#include "solver/world/engine.h"

#include <span>

namespace springtower {

// A sleeping block keeps its contact forces. What its awake neighbours do to it otherwise than when it fell asleep is taken over
// without waking it as long as its other contacts can bear the change: so one block can be drawn out of a tower that sleeps.

/// Before blocks fall asleep: notes how the contacts of those push that will, the awake ones whose `staysAwake` is 0 ([blocks]).
/// Sleeping neighbours for whom that is a change go to engine.scratch.toWake: nobody falls asleep on forces that do not balance.
void recordSleepLoads(Simulation& simulation, std::span<const std::uint8_t> staysAwake);

/// Fills engine.scratch.toWake with the sleeping blocks that have lost or gained a contact, or whose other contacts cannot bear
/// what awake neighbours do to them now; and groups whose supports fail (solver/sleep/support_check). Returns whether there are
/// any of the latter: what awake neighbours did in this frame was done to blocks that should have moved.
bool findWakeCandidates(Simulation& simulation);

}  // namespace springtower
