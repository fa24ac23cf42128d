#pragma once

#include "solver/world/newton_system.h"

#include <cstddef>

namespace springtower {

struct IslandStep;

/// Adds the stiffness (N/m) of a touching pair's active points (position `at` in island.touching, active set island.mask) to the
/// matrix. `step_s`: the step times the method's factor, s. Preconditions: the matrix is laid out for the pairs that touch, and
/// frames and trial points belong to the present positions. Calls side by side must not share a block.
void addContactStiffness(const IslandStep& step, NewtonSystem& island, std::size_t at, double step_s);

}  // namespace springtower
