#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances an island through the frame by explicit steps of the scene's method, as many as are stable for the contacts there are
/// and may come. `inside` of the result is false where a block left its swept box; positions are then those of the step in which
/// it did. Precondition: the method is an explicit one or `report`. Throws DivergenceError.
IslandOutcome runExplicitSteps(IslandStep& step);

}  // namespace springtower
