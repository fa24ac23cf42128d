#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// Finds sleeping blocks whose supports fail under the changed load from awake neighbours, and adds them to
/// engine.scratch.toWake: so a tower that a hand pulls over its edge topples, asleep or not. Returns whether there are any. Every
/// group of sleeping blocks above a level (level by level, from the top down) is treated as a rigid body on springs at the points
/// that support it there: a point that would pull opens, one whose friction reaches Coulomb's cone slips, and the group fails
/// when the remaining points cannot balance it. Preconditions: engine.scratch.pushed, engine.scratch.loadChange and
/// engine.scratch.joined are those of findWakeCandidates; the last two are overwritten.
bool findFailedSupports(Simulation& simulation);

}  // namespace springtower
