#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

namespace springtower {

/// A block of the scene, counted from 0 in the order of the scene. Strong, so that it is never mixed up with a corner or a pair.
enum class BlockId : std::int32_t {};

/// Stands for the floor (or for no block at all) where a contact names its lower partner.
inline constexpr BlockId kFloor{-1};

/// The position of a block in per-block arrays. Precondition: not kFloor.
constexpr std::size_t index(BlockId block) {
  return static_cast<std::size_t>(block);
}

/// The block at a position of per-block arrays.
constexpr BlockId blockId(std::size_t position) {
  return static_cast<BlockId>(position);
}

/// Two blocks by number, a < b where the order means nothing; ordered by a, then b.
struct BlockPair {
  std::int32_t a;
  std::int32_t b;
  auto operator<=>(const BlockPair&) const = default;
};

}  // namespace springtower
