#pragma once

#include "solver/world/newton_system.h"

#include <cstddef>

namespace springtower {

struct IslandStep;

/// Adds the stiffness of a touching pair's active points (position in island.touching, active set island.mask) to the matrix.
/// `step_s` is the step times the method's factor.
void addContactStiffness(const IslandStep& step, NewtonSystem& island, std::size_t at, double step_s);

}  // namespace springtower
