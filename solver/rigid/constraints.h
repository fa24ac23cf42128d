#pragma once

#include "core/lanes.h"
#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

/// Arms, normals, gaps and effective masses of all points at the present poses and orientations of the island's bodies. The
/// movers must have been read.
void placeConstraints(RigidIsland& island);

/// Gaps of all points after the bodies have moved by `moved` and `turned`, to first order.
void moveGaps(RigidIsland& island);

/// Velocities of the island's bodies for the passes, with what else these need of them; the velocities alone; and back.
void readMovers(RigidIsland& island);
void readVelocities(RigidIsland& island);
void writeMovers(RigidIsland& island);

/// A vector in the first three of four lanes.
SPRINGTOWER_INLINE void toLanes(const Vec3& v, Lanes& lanes) {
  lanes = Lanes{v[0], v[1], v[2], 0.0};
}

SPRINGTOWER_INLINE void crossLanes(const Lanes& p, const Lanes& q, Lanes& result) {
  Lanes pTurned, qTurned;
  shuffle<1, 2, 0, 3>(p, p, pTurned);
  shuffle<1, 2, 0, 3>(q, q, qTurned);
  const Lanes turned = p * qTurned - pTurned * q;
  shuffle<1, 2, 0, 3>(turned, turned, result);
}

/// A matrix, given by its columns, times a vector.
SPRINGTOWER_INLINE void timesLanes(const Lanes* columns, const Lanes& v, Lanes& result) {
  result = columns[0] * v[0] + columns[1] * v[1] + columns[2] * v[2];
}

}  // namespace springtower
