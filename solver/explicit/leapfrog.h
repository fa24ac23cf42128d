#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances simulation.state by one step of semi-implicit Euler, as a leapfrog with changing steps, and leaves the positions it
/// started from in engine.memo.previous. The contact memory is brought up to date once a step.
void stepSemiImplicitEuler(IslandStep& step);

}  // namespace springtower
