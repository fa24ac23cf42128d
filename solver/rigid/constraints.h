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

/// How soft contacts are in a substep.
struct Springs {
  double step_s;       ///< its length
  double tolerance_m;  ///< how deep a push may press blocks into one another
  double rounding_m;   ///< of gaps
  bool heap;           ///< whether most blocks have fallen: what springs push out then stays an overlap without force
  double share;        ///< weight of a substep's push in its running mean over about a frame
};

/// Arms, normals, gaps and effective masses of all packed points at the present poses and orientations of the island's bodies.
/// Their places and velocities must have been read, and pushes are those of the substep before. What turning closes of a gap
/// within the substep is beside it. Contacts are as soft as their springs, but blocks get no deeper into one another by a push
/// than by its mean over about a frame (what is more is an impact), nor than the tolerance.
void placeConstraints(const RigidIsland& island, const Springs& springs, PackedPoints& packed);

/// Gaps of all points after the bodies have moved by `moved` and `turned`, and what turning closes of them.
void moveGaps(RigidIsland& island);

/// Places and velocities of the island's bodies for the passes; the velocities alone; and back.
void readBodies(RigidIsland& island);
void readVelocities(RigidIsland& island);
void writeBodies(RigidIsland& island);

}  // namespace springtower
