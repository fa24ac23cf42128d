#pragma once

#include "solver/island_step.h"

namespace springtower {

/// The report's collision loop (its 4.4, 4.5 and 5.4) for one island: `simulation.state.position` holds the valid current
/// positions, `velocity` the next velocities. Passes over the floor, all point-face and all edge-edge pairs of near blocks go on
/// until one finds no collision or Settings::reportIterations is reached; each collision is answered at once by an impulse along
/// its normal and noted for the friction of the next step. What still collides after the last pass stays. Counts the stages of
/// culling (block pairs alone, not the floor) and passes. Precondition: the island's lists of contacts are empty.
void resolveCollisions(IslandStep& step);

/// Accepts the next state: moves the island's blocks by their velocities. Positions they started from go to engine.previous.
void moveByVelocities(IslandStep& step);

/// Before a frame: sizes what the collision loop needs for the pairs of the frame, and remembers the contacts.
void prepareReportFrame(Simulation& simulation);

/// When a frame has to be run again: wakes the disabled blocks that were hit hard and brings the contacts back to the frame's
/// start.
void rewindReportFrame(Simulation& simulation);

/// After a step: travel and divergence as for the other methods (addTravel). Returns false, so that the frame is run again, when
/// a block has left its swept box, or when a disabled block was hit hard enough to be enabled (report 4.7). Throws
/// DivergenceError.
bool acceptReportStep(IslandStep& step);

}  // namespace springtower
