#pragma once

#include "core/vector.h"
#include "solver/world/island_step.h"

#include <cstddef>

namespace springtower {

// All rollbacks. A checkpoint of a frame covers the whole world and is saved island by island; that of a step covers one island.
// Everything that a step may change and a rejected one must not is listed here and nowhere else. memo.previous
// is not kept: BlockHistory::startKnown says so, and the next step does without.

/// Sizes the checkpoint for the coming frame. Precondition: its near pairs are found.
void prepareFrameStart(Simulation& simulation);

/// Saves the histories with which an island starts the frame. Islands save in parallel, each just before its data are read
/// anyway.
void saveFrameStart(IslandStep& step);

/// Copies the state and the points with which an island started the frame, unless they have been. To be called before they
/// change, except by the only implicit step of a frame, which holds them itself. Precondition: no step has been accepted without
/// a copy.
void copyFrameStart(IslandStep& step);

/// Whether no step of the frame has been accepted, and nothing has been copied: the next step accepted holds the frame's start.
bool holdsFrameStart(const IslandStep& step);
/// Notes that this step has been accepted, with what it began with in memo.previous, memo.previousVelocity and the trial points.
void setFrameStartHeld(IslandStep& step);

/// Position of a corner as the frame began, m. Precondition: the block's island has run.
Vec3 frameStartPosition(const Simulation& simulation, std::size_t block, std::size_t corner);

/// Returns the memory of what has been copied. Not while frames run.
void releaseFrameStart(Engine& engine);

/// Saves a pair (its position in engine.pairs), and its points as the frame began, before anything changes in it other than by
/// the steps. Any thread, one thread a pair; the first call in a frame saves, the others do nothing.
void savePair(Engine& engine, std::size_t at);

/// Restores the start of the frame, or of its part that was run last, for all islands that took part or for one.
void restoreFrame(Simulation& simulation);
void restoreIsland(IslandStep& step);

/// Saves the positions of an island's blocks at the start of a step (in rigid steps poses, velocities and travel as well).
void saveStep(IslandStep& step);

/// Puts the blocks back to the start of the step: of implicit steps, whose prediction saves positions and velocities itself, and
/// of rigid ones. Contacts made in the step stay, because it is repeated with them. Call recomputeClearances afterwards.
void restoreStep(IslandStep& step);

}  // namespace springtower
