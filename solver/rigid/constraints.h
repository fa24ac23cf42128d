#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

/// A vector in the first three of four lanes.
SPRINGTOWER_INLINE void toLanes(const Vec3& v, Lanes& lanes) {
  lanes = Lanes{v[0], v[1], v[2], 0.0};
}
SPRINGTOWER_INLINE void fromLanes(const Lanes& lanes, Vec3& v) {
  for (int k = 0; k < 3; ++k) v[k] = lanes[k];
}

/// Arms, normals, gaps and effective masses of all packed points at the present poses and orientations of the island's bodies.
/// Their places must have been read. Contacts are as soft as their springs in a substep of `step_s`, but blocks get no deeper
/// into one another by a push than by the force with which the frame began (what is more is an impact), nor than `tolerance_m`.
/// `rounding_m`: of gaps.
void placeConstraints(const RigidIsland& island, double step_s, double tolerance_m, double rounding_m, PackedPoints& packed);

/// Gaps of all points after the bodies have moved by `moved` and `turned`, to first order.
void moveGaps(RigidIsland& island);

/// Places and velocities of the island's bodies for the passes; the velocities alone; and back.
void readBodies(RigidIsland& island);
void readVelocities(RigidIsland& island);
void writeBodies(RigidIsland& island);

}  // namespace springtower
