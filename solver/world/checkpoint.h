#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Makes room for what the frame ahead starts from. Call it once its near pairs are found.
void prepareFrameStart(Simulation& simulation);

/// Keeps what an island starts the frame from: state, clocks, contacts, and what implicit steps remember. Islands do it side by
/// side, each just before its data are needed anyway.
void saveFrameStart(IslandStep& step);

/// Keeps a pair before anything but what its points store changes: that is seldom.
void savePair(Engine& engine, std::size_t at);

/// Brings it back, for a whole frame that is run again or for one island.
void restoreFrame(Simulation& simulation);
void restoreIsland(IslandStep& step);

}  // namespace springtower
