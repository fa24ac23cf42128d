#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Before the first frame: moves an island whose blocks all touch and do not move into the static equilibrium next to its initial
/// placement. Blocks as placed would carry no contact forces and drop by about the tolerance, and that impact topples what stands
/// by less. User forces do not act yet. The equilibrium is found by implicit Euler steps without inertial history, with a step
/// that grows until inertia is negligible (pseudo-transient continuation: Kelley & Keyes 1998). If there is none nearby,
/// everything is left as placed. Precondition: contacts are found. Returns whether the island is in equilibrium.
bool startInEquilibrium(IslandStep& step);

}  // namespace springtower
