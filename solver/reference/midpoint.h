#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances simulation.state by one step of the explicit midpoint rule, and leaves the positions it started from in
/// engine.memo.previous. The contact memory is brought up to date once a step.
void stepMidpoint(IslandStep& step);

}  // namespace springtower
