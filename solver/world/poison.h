#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// Overwrites with NaN, and integers with -1, what no frame may read before writing it: engine.scratch, the working space of
/// Newton's iteration, and the checkpoint rows of contacts. Builds with assertions call it as a frame begins; state hashes must
/// not change.
void poisonScratch(Engine& engine);

}  // namespace springtower
