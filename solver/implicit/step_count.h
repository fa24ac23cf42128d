#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Speed of a block's corners, m/s, up to which one step a frame tells what they do as well as four.
double quiescentSpeed(const Simulation& simulation);

/// Takes the implicit step just found into what each block's clock knows of its ringing: how much the change of velocity in a
/// step differs from that in the step before. Blocks without a step before tell nothing. Precondition:
/// engine.scratch.pastPosition and engine.scratch.freePosition are the step's, of the two-step formula; `effective_s` as in
/// `foretell`.
void updateFrequencyEstimate(IslandStep& step, double effective_s);

/// Steps of a frame that follow the island's ringing: the two-step formula damps a swing of angular frequency w by (w h)^4 / 4 of
/// its amplitude in each step h (its largest eigenvalue, to the first order), and a frame of n steps T / n by (w T)^4 / (4 n^3).
/// They stay at `present` where half as much damping again or as little would want other ones, as other steps want other factors.
int stepsForFrequency(const IslandStep& step, int present);

}  // namespace springtower
