#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances simulation.state by one step of semi-implicit Euler, as a leapfrog with varying steps, and leaves its start positions
/// in engine.memo.previous. Contact points are advanced once a step.
void stepSemiImplicitEuler(IslandStep& step);

}  // namespace springtower
