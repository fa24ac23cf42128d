#pragma once

#include "solver/world/rigid_island.h"

namespace springtower {

// What contacts between an island's own blocks leave as it is: its momentum, and its angular momentum about its centre of mass.

/// Whether no block may touch what does not move by impulses in the substep: the floor, a fixed, driven or sleeping block. By the
/// points that are packed.
bool isIsolated(const RigidIsland& island);

/// Angular momentum about the centre of mass, kg m2/s.
Vec3 angularMomentum(const RigidIsland& island);

/// Turns the motion of the whole island so that its angular momentum is this again. Push-out moves blocks by other velocities
/// than they keep, and friction acts on two blocks as far apart as they overlap: by that much it is off after a substep.
void restoreAngularMomentum(const Vec3& momentum, RigidIsland& island);

/// Where push-out or unconverged passes have raised the kinetic energy of an isolated island by `added_j` (J) beyond the work of
/// gravity: scales the motion relative to that of the whole down by the excess.
void removeAddedEnergy(double added_j, RigidIsland& island);

}  // namespace springtower
