#pragma once

#include "solver/world/island_step.h"

namespace springtower {

// Common parts of the methods with stages inside a step. In their states positions and velocities belong to the same time;
// contact points are advanced from the step's start to a stage with the velocities that moved the stage's positions there.

/// Evaluates forces at `source` and stores the accelerations of the island's corners in `acceleration`.
void stageAcceleration(IslandStep& step, const MotionState& source, const ParticleArray& carried, double advance_s, bool commit,
                       ParticleArray& acceleration);

/// destination = base + duration (rate of position, rate of velocity), for the island's blocks (report Eq. 4.5 with separate
/// rates).
void advanceStage(const IslandStep& step, const MotionState& base, const ParticleArray& velocity,
                  const ParticleArray& acceleration, double duration_s, MotionState& destination);

/// Copies values of the corners of the island's blocks.
void copyCorners(const IslandStep& step, const ParticleArray& from, ParticleArray& to);

/// Stores the start positions of the step in engine.memo.previous.
void savePositions(IslandStep& step);

}  // namespace springtower
