#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// Looks for sleepers whose supports fail under the loads that awake neighbours have changed since they fell asleep, and adds
/// them to engine.scratch.toWake: so a tower that a hand draws over its edge topples, asleep or not. Returns whether there are
/// any. Every group of sleepers above a level (storey by storey, from the top down) is a rigid body on the springs of the points
/// on which it rests there: a point that would pull lifts off, one whose friction is at Coulomb's cone slides, and the group
/// fails when what is left of them cannot balance it. Preconditions: engine.scratch.pushed, engine.scratch.loadChange and
/// engine.scratch.joined are those of findWakeCandidates; it works in the last two, which are of no use afterwards.
bool findFailedSupports(Simulation& simulation);

}  // namespace springtower
