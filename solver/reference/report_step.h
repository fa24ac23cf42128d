#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances simulation.state by one step of the 2003 report's program, and leaves its start positions in engine.memo.previous.
void stepReport(IslandStep& step);

}  // namespace springtower
