#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// Overwrites with NaN, and integers with -1, what no frame may read before it writes it: engine.scratch, the working space of
/// Newton's iteration, and of contacts what rollbacks keep. Builds with assertions call it as a frame begins; hashes
/// must not change.
void poisonScratch(Engine& engine);

}  // namespace springtower
