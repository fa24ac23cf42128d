#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

/// Chooses the friction of all packed points: static, or where all points of a pair slip kinetic and that of even pressure
/// (solver/contact/slip.h). Precondition: island.motions has the velocities at the end of the substep before, and the points are
/// placed.
void choosePatchFriction(const IslandStep& step, RigidIsland& island);

}  // namespace springtower
