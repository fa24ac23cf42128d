#pragma once

#include "solver/world/simulation.h"

namespace springtower {

/// Advances all awake islands through the frame. Those in rigid steps go first and in parts of the frame, each with a sweep of
/// its own, so that no block moves much farther in a part than the margin of the boxes, which is what a block that is hit may do:
/// the boxes stay small, and what is run again where a block leaves its own is one part of one island. All others, which are at
/// rest or move slowly, take the whole frame at once at the end, unless a block in parts comes near to one of theirs: then their
/// island is run up to that time, and moves on in parts as well. Postcondition: simulation.substeps is the sum over parts of the
/// most steps of any island. Throws DivergenceError.
void advanceThroughParts(Simulation& simulation);

}  // namespace springtower
