#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances simulation.state by one step of the classical Runge-Kutta method of fourth order, and leaves the positions it started
/// from in engine.memo.previous. The contact memory is brought up to date once a step.
void stepRungeKutta4(IslandStep& step);

}  // namespace springtower
