#pragma once

#include "core/scene/drive.h"
#include "solver/world/island_step.h"

#include <cstdint>
#include <span>

namespace springtower {

// Driven blocks are fixed blocks that drives of the scene move (core/scene/drive.h). No force moves them, so they sleep as fixed
// blocks do; but while they move, the blocks near one of them are one island, which writes the driven block's pose at the times
// of its own steps: the pose is a function of time alone, and needs no rollback.

/// What the velocities of driven blocks are after a step: those at its end, or its means, as explicit steps have them.
enum class DrivenVelocity : std::uint8_t { atEnd, mean };

/// The pose of a driven block at a time, s.
DrivenPose poseAt(const Simulation& simulation, std::int32_t block, double time_s);

/// Whether any drive moves a block in some part of this time, s.
bool anyDriveActs(const Simulation& simulation, double begin_s, double end_s);

/// Whether a drive moves this block in the frame that is run, and the island's steps with it.
inline bool isDriven(const IslandStep& step, std::int32_t block) {
  for (const BlockPair& driven : step.driven) {
    if (driven.b == block) return true;
  }
  return false;
}

/// Before pairs are searched for: lists the driven blocks that move in this frame, and gives them boxes that they do not leave in
/// it. Returns the flags of sleep for the search, [blocks], in which these count as awake.
std::span<const std::uint8_t> sweepDriven(Simulation& simulation);

/// After it: drops pairs of two fixed blocks, and lists the blocks near driven ones; nothing where none moves.
void listNearDriven(Simulation& simulation);

/// Once islands are found: lists the driven blocks of each.
void listDrivenOfIslands(Simulation& simulation);

/// Moves the driven blocks of an island to their poses at `now_s`, and what they were at the start of the step to those at
/// `before_s` (absolute times, s). Positions, velocities, frames, motions and travel follow.
void placeDriven(IslandStep& step, double before_s, double now_s, DrivenVelocity which = DrivenVelocity::atEnd);

/// At the end of a frame: moves all driven blocks to where they are then.
void finishDriven(Simulation& simulation);

}  // namespace springtower
