#pragma once

#include "solver/world/engine.h"

#include <cstdint>
#include <span>

namespace springtower {

// A sleeping block keeps its contact forces. A change of the load from its awake neighbours does not wake it as long as its other
// contacts can support the change; so one block can be drawn out of a sleeping tower.

/// Before blocks fall asleep: records the contact loads of those that will, the awake ones whose `staysAwake` is 0 ([blocks]).
/// Sleeping neighbours whose load is changed by that are added to engine.scratch.toWake: no block falls asleep on forces that do
/// not balance.
void recordSleepLoads(Simulation& simulation, std::span<const std::uint8_t> staysAwake);

/// Fills engine.scratch.toWake with the sleeping blocks that have lost or gained a contact, or whose other contacts cannot
/// support the present change of load from awake neighbours; and with groups whose supports fail (solver/sleep/support_check).
/// Returns whether there are any of the latter: then this frame was computed with sleeping blocks that should have moved.
bool findWakeCandidates(Simulation& simulation);

}  // namespace springtower
