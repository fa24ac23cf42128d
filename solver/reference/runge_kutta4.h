#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Advances simulation.state by one step of the classical Runge-Kutta method of fourth order, and leaves its start positions in
/// engine.memo.previous. Contact points are advanced once a step.
void stepRungeKutta4(IslandStep& step);

}  // namespace springtower
