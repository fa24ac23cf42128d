#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances an island through one frame by the scene's method. `inside` of the result is false where a block left its swept box:
/// the frame is then to be taken again from its checkpoint. Throws DivergenceError.
IslandOutcome advanceIsland(IslandStep& step);

}  // namespace springtower
