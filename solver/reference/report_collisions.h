#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// The report's collision loop (its 4.4, 4.5 and 5.4) for one island: `simulation.state.position` holds the valid current
/// positions, `velocity` the next velocities. Passes over the floor, all point-face and all edge-edge pairs of near blocks go on
/// until one finds no collision or Settings::reportIterations is reached; each collision is answered at once by an impulse along
/// its normal and noted for the friction of the next step. What still collides after the last pass stays. Counts the stages of
/// culling (block pairs alone, not the floor) and passes. Precondition: the island's lists of contacts are empty.
void resolveCollisions(IslandStep& step);

/// Accepts the next state: moves the island's blocks by their velocities. Positions they started from go to engine.memo.previous.
void moveByVelocities(IslandStep& step);

}  // namespace springtower
