#pragma once

#include "solver/world/island_step.h"

#include <cstdint>
#include <vector>

namespace springtower {

/// The first of the islands that are copies of one another as placed, shifted along the floor: for each island its index, or its
/// own where no island before it is equal. Equal: blocks, in their order, of the same size and velocity, of the same mass,
/// stiffness and placement within tuning::kEqualIslands, and the same near pairs of these. Single blocks are not compared, as
/// the search takes no longer for them. Precondition: near pairs are found.
std::vector<std::int32_t> firstEqualIslands(const Simulation& simulation);

/// Moves and joins the blocks of `to` as those of `from`, which is equal, have moved and been joined since they were placed.
/// Precondition: `from` has a checkpoint of where it was placed, and `to` is there still.
void copyEquilibrium(const IslandStep& from, IslandStep& to);

}  // namespace springtower
