#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

// The manifolds of narrowphase/ as sequential impulses see them. Their memory as in solver/contact/rigid_contacts.h.

/// Lists all points of an island's touching manifolds at the places of engine.memo.frames, with the impulses of the step before.
/// `again`: in a step taken again from the same places, where only the contacts found in it are new. Reads the movers.
void gatherPoints(IslandStep& step, RigidIsland& island, bool again);

/// Puts the impulses of a step back into the manifolds, as forces.
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

/// A matrix by its columns, times a vector.
SPRINGTOWER_INLINE void timesLanes(const Lanes* columns, const Lanes& v, Lanes& result) {
  result = columns[0] * v[0] + columns[1] * v[1] + columns[2] * v[2];
}

}  // namespace springtower
