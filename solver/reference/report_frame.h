#pragma once

#include "solver/world/island_step.h"

namespace springtower {

// Work of method `report` around the steps of a frame.

/// Before the islands run: sizes the data of the collision loop for the pairs of the frame, and saves the contacts.
void prepareReportFrame(Simulation& simulation);

/// When a frame has to be run again: wakes the disabled blocks that were hit hard and restores the contacts of the frame's start.
void rewindReportFrame(Simulation& simulation);

/// After a step: travel and divergence as for the other methods (addTravel). Returns false, so that the frame is run again, when
/// a block has left its swept box, or when a disabled block was hit hard enough to be enabled (report 4.7). Throws
/// DivergenceError.
bool acceptReportStep(IslandStep& step);

}  // namespace springtower
