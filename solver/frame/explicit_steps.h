#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances an island from `begin_s` after the frame's begin to its end by explicit steps of the scene's method (of an implicit
/// method, by its fallback), as many as are stable for the contacts there are and may come. `inside` of the result is false where
/// a block left its swept box; positions are then those of the step in which it did. Precondition: the method is not rigid.
/// Throws DivergenceError.
IslandOutcome runExplicitSteps(IslandStep& step, double begin_s);

}  // namespace springtower
