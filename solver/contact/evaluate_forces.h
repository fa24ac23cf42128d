#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// What becomes of the contact memory that a force evaluation has brought up to date: dropped, kept, or put into the trial
/// points, where an implicit step keeps it until it is accepted.
enum class Memory { drop, advance, trial };

/// Forces on the island's corners at `state`: springs, contacts, user forces and the hand's tether (gravity is an acceleration
/// and comes with the integration); fills engine.memo.force for its blocks. `carried` are the velocities that moved the positions
/// during the last `advance_s`, to which a copy of the contact memory is brought. Deterministic: contacts are summed in the order
/// of the pairs for any number of threads.
void evaluateForces(IslandStep& step, const MotionState& state, const ParticleArray& carried, double advance_s, Memory memory);

/// Whether the hand holds a block of this island; whether a user force acts on one during the frame.
bool holdsTether(const IslandStep& step);
bool isPushed(const IslandStep& step);

/// Acceleration of one block's corners from engine.memo.force and gravity: a_i = (own f_i - shared F) / m + g.
void accelerate(const IslandStep& step, std::size_t block, double (&acceleration)[3][kCorners]);

}  // namespace springtower
