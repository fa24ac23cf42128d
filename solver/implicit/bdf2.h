#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Fills engine.scratch.freePosition with each block's position at the step's end without forces, and engine.scratch.pastPosition
/// with the contribution of past positions to it: x = (4 x_n - x_(n-1)) / 3 + 2/3 h v at the end, and the same for v (Gear 1971).
/// A block without a history gets that of its present acceleration, taken as uniform, or of none where an impact makes that
/// acceleration implausibly large. `effective_s`: the step that multiplies the forces at the end, s. Precondition:
/// engine.memo.force holds the present forces where a block has no history.
void predictBdf2(IslandStep& step, double effective_s);

/// The same for implicit Euler, which uses no earlier step.
void predictEuler(IslandStep& step, double effective_s);

}  // namespace springtower
