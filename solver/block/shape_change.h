#pragma once

#include "core/state.h"

#include <cstddef>

namespace springtower {

/// Change of a block's shape from one time to another, m2: squared changes of the distances between its corners, summed over
/// pairs, over the number of corners. Rotation changes none. Positions: m, [blocks][8].
double shapeChange(const ParticleArray& now, const ParticleArray& before, std::size_t block);

}  // namespace springtower
