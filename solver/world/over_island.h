#pragma once

#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/world/island_step.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace springtower {

/// Whether an island has so many blocks that its kernels run on many threads.
inline bool isWide(const IslandStep& step) {
  return step.blocks.size() >= tuning::kParallelBlocks;
}

/// Runs kernel(first, last) over positions in step.blocks, or in step.pairs; see forRanges.
template <class Kernel>
void overBlocks(const IslandStep& step, const Kernel& kernel) {
  forRanges(step.blocks.size(), tuning::kBlockGrain, isWide(step), kernel);
}
template <class Kernel>
void overPairs(const IslandStep& step, const Kernel& kernel) {
  forRanges(step.pairs.size(), tuning::kPairGrain, isWide(step), kernel);
}

/// Whether predicate(block) holds for every block of the island; stops early where it runs on one thread.
template <class Predicate>
bool everyBlock(const IslandStep& step, const Predicate& predicate) {
  const auto all = [&](std::size_t first, std::size_t last) {
    return std::all_of(step.blocks.begin() + static_cast<std::ptrdiff_t>(first),
                       step.blocks.begin() + static_cast<std::ptrdiff_t>(last),
                       [&](std::int32_t block) { return predicate(static_cast<std::size_t>(block)); });
  };
  return mergeRanges(step.blocks.size(), tuning::kBlockGrain, isWide(step), true, all, [](bool a, bool b) { return a && b; });
}

/// Whether predicate(pair) holds for any pair of the island, by position in engine.pairs.
template <class Predicate>
bool anyPair(const IslandStep& step, const Predicate& predicate) {
  const auto any = [&](std::size_t first, std::size_t last) {
    return std::any_of(step.pairs.begin() + static_cast<std::ptrdiff_t>(first),
                       step.pairs.begin() + static_cast<std::ptrdiff_t>(last),
                       [&](std::int32_t pair) { return predicate(static_cast<std::size_t>(pair)); });
  };
  return mergeRanges(step.pairs.size(), tuning::kPairGrain, isWide(step), false, any, [](bool a, bool b) { return a || b; });
}

/// The largest value(block) of the island's blocks, at least 0.
template <class Value>
double largestOfBlocks(const IslandStep& step, const Value& value) {
  const auto largest = [&](std::size_t first, std::size_t last) {
    double most = 0.0;
    for (std::size_t i = first; i < last; ++i) most = std::max(most, value(static_cast<std::size_t>(step.blocks[i])));
    return most;
  };
  return mergeRanges(step.blocks.size(), tuning::kBlockGrain, isWide(step), 0.0, largest,
                     [](double a, double b) { return std::max(a, b); });
}

/// Whether more than half of the island's blocks have fallen since they slept last.
inline bool isMostlyFallen(const IslandStep& step) {
  const auto fallen = std::count_if(step.blocks.begin(), step.blocks.end(), [&](std::int32_t block) {
    return step.engine.memo.blockHistory[static_cast<std::size_t>(block)].hasFallen;
  });
  return 2 * static_cast<std::size_t>(fallen) > step.blocks.size();
}

}  // namespace springtower
