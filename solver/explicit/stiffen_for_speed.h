#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Makes the springs of an island's blocks stiffer where forces, a hand or drives have made it faster than its scene let foresee
/// (edgeForSpeed): softer ones would be turned inside out in an impact. They stay so, as springs that get softer while they are
/// strained lose energy. Before the steps of a frame, by explicit methods that choose their steps.
void stiffenForSpeed(IslandStep& step);

}  // namespace springtower
