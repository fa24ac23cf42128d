#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace springtower {

/// What an island did in the frames before. Every block holds a copy of that of the island it was in last, since islands have no
/// identity of their own: they merge and split as blocks touch and part.
struct IslandHistory {
  std::int32_t rigidFrames = 0;    ///< frames for which implicit steps are not tried again
  std::int32_t implicitSteps = 0;  ///< steps of a frame that its vibration needed last
  bool forced = false;             ///< whether a user's force or the hand acted on it, as of the last frame begun
  bool rigid = false;              ///< whether rigid steps carried it in the last frame begun
};

/// What counts where islands have merged. `histories`: [blocks of the scene]; `blocks`: those of the island, ascending. Frames
/// and steps are the largest of any block's, it was rigid if any block was, and the rest is the first block's.
inline IslandHistory mergedHistory(std::span<const IslandHistory> histories, std::span<const std::int32_t> blocks) {
  IslandHistory merged = histories[static_cast<std::size_t>(blocks.front())];
  for (const std::int32_t block : blocks) {
    const IslandHistory& own = histories[static_cast<std::size_t>(block)];
    merged.rigidFrames = std::max(merged.rigidFrames, own.rigidFrames);
    merged.implicitSteps = std::max(merged.implicitSteps, own.implicitSteps);
    merged.rigid = merged.rigid || own.rigid;
  }
  return merged;
}

}  // namespace springtower
