#pragma once

#include "solver/world/island_step.h"

namespace springtower {

// All rollbacks. A checkpoint of a frame is of the whole world and kept island by island; one of a step is of one island. What a
// step may change and a rejected one must not is listed here and nowhere else.

/// Makes room for what the frame ahead starts from. Call it once its near pairs are found.
void prepareFrameStart(Simulation& simulation);

/// Keeps what an island starts the frame from: state, histories and the points of its contacts. Islands do it side by side, each
/// just before its data are needed anyway.
void saveFrameStart(IslandStep& step);

/// Keeps a pair (its position in engine.pairs) before anything but what its points store changes: that is seldom.
void savePair(Engine& engine, std::size_t at);

/// Brings back what the frame began with, for a whole frame that is run again or for one island.
void restoreFrame(Simulation& simulation);
void restoreIsland(IslandStep& step);

/// Keeps where an island's blocks are as a step begins (rigid steps: poses, velocities and travel as well).
void saveStep(IslandStep& step);

/// Puts the blocks back to where the step began: implicit steps, whose prediction keeps positions and velocities itself, and
/// rigid ones. Contacts made in the step stay: it is taken again with them. Clearances are to be brought up to date after it
/// (recomputeClearances).
void restoreStep(IslandStep& step);

}  // namespace springtower
