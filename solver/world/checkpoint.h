#pragma once

#include "solver/world/island_step.h"

namespace springtower {

// All rollbacks. A checkpoint of a frame covers the whole world and is saved island by island; that of a step covers one island.
// Everything that a step may change and a rejected one must not is listed here and nowhere else.

/// Sizes the checkpoint for the coming frame. Precondition: its near pairs are found.
void prepareFrameStart(Simulation& simulation);

/// Saves what an island starts the frame from: state, histories and the points of its contacts. Islands save in parallel, each
/// just before its data are read anyway.
void saveFrameStart(IslandStep& step);

/// Saves a pair (its position in engine.pairs) before anything changes in it other than what its points store; that is rare.
void savePair(Engine& engine, std::size_t at);

/// Restores the start of the frame, for a whole frame that is run again or for one island.
void restoreFrame(Simulation& simulation);
void restoreIsland(IslandStep& step);

/// Saves the positions of an island's blocks at the start of a step (in rigid steps poses, velocities and travel as well).
void saveStep(IslandStep& step);

/// Puts the blocks back to the start of the step: of implicit steps, whose prediction saves positions and velocities itself, and
/// of rigid ones. Contacts made in the step stay, because it is repeated with them. Call recomputeClearances afterwards.
void restoreStep(IslandStep& step);

}  // namespace springtower
