#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances simulation.state by one step of the 2003 report's program, and leaves the positions it started from in
/// engine.memo.previous. The contact memory is brought up to date once a step.
void stepReport(IslandStep& step);

}  // namespace springtower
