#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances simulation.state by one step of the explicit midpoint rule, and leaves its start positions in engine.memo.previous.
/// Contact points are advanced once a step.
void stepMidpoint(IslandStep& step);

}  // namespace springtower
