#pragma once

#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/world/rigid_island.h"

#include <cstddef>

namespace springtower {

/// Runs kernel(i) for the bodies i of an island; on many threads where it is wide. A call writes only what belongs to its body.
template <class Kernel>
void overBodies(const RigidIsland& island, const Kernel& kernel) {
  const std::size_t count = island.bodies.size();
  forRanges(count, tuning::kBlockGrain, count >= tuning::kParallelBlocks, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) kernel(i);
  });
}

}  // namespace springtower
