#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// Sort and sweep for the coming frame: swept boxes of the awake blocks (grown by memo.sweepMargin), pairs, islands, and the
/// pairs of each island. Pairs found before keep their contacts; pairs of two sleeping blocks are unchanged. Throws
/// DivergenceError where the state of an awake block is not finite.
void findNearPairs(Simulation& simulation);

/// Where a block has left its swept box (scratch.islandOutcome is negative), larger ones for all blocks of its island at the next
/// sweep.
void growSweepMargins(Engine& engine);

}  // namespace springtower
