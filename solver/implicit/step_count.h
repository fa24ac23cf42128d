#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Speed of a block's corners, m/s, up to which one step a frame is as accurate as four.
double quiescentSpeed(const Simulation& simulation);

/// Updates the frequency estimate in each block's history from the implicit step just computed: from the difference between its
/// change of velocity and that of the step before. Blocks without an earlier step are skipped. Precondition:
/// engine.scratch.pastPosition and engine.scratch.freePosition are the step's, of BDF2; `effective_s` as in `predictBdf2`.
void updateFrequencyEstimate(IslandStep& step, double effective_s);

/// Steps of a frame that resolve the island's vibration: BDF2 damps a vibration of angular frequency w by (w h)^4 / 4 of its
/// amplitude in each step h (its largest eigenvalue, to first order), and so a frame of n steps T / n by (w T)^4 / (4 n^3). The
/// count stays at `present` while the damping a frame is between half the allowed one and the allowed one, because a change of
/// the step requires new factors.
int stepsForFrequency(const IslandStep& step, int present);

}  // namespace springtower
