#pragma once

#include "core/scene/scene.h"

#include <cstdint>

namespace springtower {

// Scenes of one kind each, drawn by a seed: the same on every machine. (scenarios/random_scene.h draws from all that there is.)

/// A tower of 3 to 10 rows of one to three blocks, up to 2 mm beside their places, as those of tests/data/oracle/shift.jsonl: it
/// stands or falls.
Scene shiftedTower(std::uint64_t seed);

/// A full tower of 6 to 18 rows whose heights differ, upright or under gravity that leans by up to 3 degrees.
Scene leaningUnevenTower(std::uint64_t seed);

/// Up to six blocks above one another in any orientation, turning as they fall.
Scene droppedBlocks(std::uint64_t seed);

/// A tower of 3 to 10 rows under gravity that leans more than it can stand, in any direction.
Scene topplingTower(std::uint64_t seed);

}  // namespace springtower
