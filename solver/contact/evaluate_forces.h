#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// What happens to the contact points advanced by a force evaluation: dropped, stored, or stored in the trial points until an
/// implicit step is accepted.
enum class PointUpdate { discard, store, trial };

/// Forces on the island's corners at `state`: springs, contacts, user forces and the hand's tether (gravity is an acceleration,
/// added by the integrators); fills engine.memo.force for its blocks. `carried` are the velocities that moved the positions
/// during the last `advance_s`, by which a copy of the contact points is advanced. Deterministic: contacts are summed in the
/// order of the pairs for any number of threads.
void evaluateForces(IslandStep& step, const MotionState& state, const ParticleArray& carried, double advance_s,
                    PointUpdate update);

/// The same at the end of an implicit step of step.drift_s, with trial points. The affine parts of the blocks' mean velocities
/// over the step are known: engine.memo.carriedMotion.
void evaluateTrialForces(IslandStep& step);

/// Whether the hand holds a block of this island; whether a user force acts on one during the frame.
bool holdsTether(const IslandStep& step);
bool isPushed(const IslandStep& step);
/// Whether any of these, or a driven block, does work on the island.
bool isWorkedOn(const IslandStep& step);

/// Acceleration of one block's corners from engine.memo.force and gravity: a_i = (own f_i - shared F) / m + g.
void accelerate(const IslandStep& step, std::size_t block, double (&acceleration)[3][kCorners]);

}  // namespace springtower
