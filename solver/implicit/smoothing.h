#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Moves an island at rest near to a static equilibrium with smoothed contacts (ContactStep::smoothing_j), which are smoothed
/// less from step to step, as the barrier of an interior point method does (Nocedal & Wright 2006, chapter 19). As all points
/// push from the start, also those that the weight only brings into contact, no load front has to find them one row after the
/// other, and friction comes to bear on normal forces that are nearly right. At the end contacts are as they were; friction is
/// within its bounds. Returns false where a step does not converge.
bool approachSmoothed(IslandStep& step);

/// The first of these steps, which tells at a part of the cost whether the island stands; contacts stay smoothed.
bool beginSmoothed(IslandStep& step);
/// The others. Precondition: beginSmoothed has converged, and nothing has changed since.
bool finishSmoothed(IslandStep& step);

/// Whether blocks bear so different weights that smoothed contacts differ (BlockStiffness::loadShare). Then the search takes no
/// stiffer diagonal than pivots need, not even after a short line search, since that would hold a light block beside a heavy one.
inline bool hasUnlikeLoads(const IslandStep& step) {
  return !step.simulation.stiffness.loadShare.empty();
}

}  // namespace springtower
