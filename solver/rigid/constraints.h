#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

// The manifolds of narrowphase/ as constraints for sequential impulses. Their points store the same as in
// solver/contact/rigid_contacts.h.

/// Lists all points of an island's touching manifolds at the poses of engine.memo.frames, with the impulses of the step before.
/// `again`: the step is repeated from the same poses, where only the contacts found in it are new. Reads the movers.
void gatherPoints(IslandStep& step, RigidIsland& island, bool again);

/// Stores the impulses of a step in the manifolds, as forces.
void keepPoints(IslandStep& step, const RigidIsland& island);

/// Velocities of the island's bodies for the passes, and back.
void readMovers(RigidIsland& island);
void writeMovers(RigidIsland& island);

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
