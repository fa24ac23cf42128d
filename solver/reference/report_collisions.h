#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// The report's collision loop (its 4.4, 4.5 and 5.4) for one island: `simulation.state.position` holds the valid current
/// positions, `velocity` the next velocities. Passes over the floor, all point-face and all edge-edge pairs of near blocks are
/// repeated until one finds no collision or Settings::reportIterations is reached; each collision is resolved at once by an
/// impulse along its normal and recorded for the friction of the next step. Collisions left after the last pass are not resolved.
/// Counts the stages of culling (block pairs only, not the floor) and passes. Precondition: the island's lists of contacts are
/// empty.
void resolveCollisions(IslandStep& step);

/// Accepts the next state: moves the island's blocks by their velocities. Start positions go to engine.memo.previous.
void moveByVelocities(IslandStep& step);

}  // namespace springtower
