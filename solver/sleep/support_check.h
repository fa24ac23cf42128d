#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// Looks for sleepers that give way to what awake neighbours do to them otherwise than when they fell asleep, and adds them to
/// engine.scratch.toWake: so a tower that a hand draws over its edge goes over, asleep or not. Returns whether there are any.
/// Every group of sleepers above a level (storey by storey, from the top down) is a rigid body on the springs of the points on
/// which it rests there: a point that would pull lifts off, one whose friction is at Coulomb's cone slides, and the group gives
/// way when what is left of them cannot hold it. Preconditions: engine.scratch.pushed, engine.scratch.loadChange and
/// engine.scratch.joined are those of findWakeCandidates; it works in the last two, which are of no use afterwards.
bool findFailedSupports(Simulation& simulation);

}  // namespace springtower
