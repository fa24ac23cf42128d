#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// After explicit steps the velocities are half a step behind the positions, and the contact memory a whole one: brings both up.
void synchronise(IslandStep& step);

/// Fills engine.scratch.freePosition with where each block ends without forces and engine.scratch.pastPosition with what of it is
/// history: x = (4 x_n - x_(n-1)) / 3 + 2/3 h v at the end, and alike for v (Gear 1971). A block without a history gets that of
/// the uniform acceleration it has now, or of none where a contact has just kicked it. `effective_s`: the step the end's forces
/// go into, s. Precondition: engine.memo.force holds the forces now, where a block has no history.
void predictBdf2(IslandStep& step, double effective_s);

/// The same for implicit Euler, which knows of no step before.
void predictEuler(IslandStep& step, double effective_s);

}  // namespace springtower
