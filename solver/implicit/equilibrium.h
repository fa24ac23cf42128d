#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Before the first frame: lays an island whose blocks all touch and do not move onto its springs, so that it starts in the
/// static equilibrium next to where it was placed. Placed as they are, blocks would carry nothing and drop by about the
/// tolerance, and that jolt throws over what stands by less. User forces do not act yet. The equilibrium is found by implicit
/// Euler steps that forget the velocity, with a step that grows until inertia no longer counts (pseudo-transient continuation:
/// Kelley & Keyes 1998). Where there is none nearby, everything is left as it was placed. Precondition: contacts are found.
/// Returns whether it rests now.
bool startInEquilibrium(IslandStep& step);

}  // namespace springtower
