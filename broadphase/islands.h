#pragma once

#include "core/ids.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// The islands of the awake blocks: blocks joined by edges, directly or through others. Reused from call to call.
struct Islands {
  std::vector<std::int32_t> blocks;    ///< the awake blocks, island by island, ascending within an island
  std::vector<std::int32_t> start;     ///< [islands + 1]: island i is blocks[start[i]] up to blocks[start[i + 1]]
  std::vector<std::int32_t> islandOf;  ///< [blocks]: the island of each block, -1 for sleeping ones

  std::vector<BlockPair> edges;      ///< from which the islands were built
  std::vector<std::uint8_t> asleep;  ///< and the flags for which they were built
  std::vector<std::int32_t> parent;  ///< working space: union-find

  [[nodiscard]] std::size_t count() const { return start.empty() ? 0 : start.size() - 1; }
  [[nodiscard]] std::span<const std::int32_t> island(std::size_t i) const {
    const auto first = static_cast<std::size_t>(start[i]);
    return {blocks.data() + first, static_cast<std::size_t>(start[i + 1]) - first};
  }
};

/// Builds the islands of these edges and flags (`asleep` is [blocks], 1 where a block sleeps); an edge joins its two blocks if
/// both are awake, so a sleeping block joins nothing. Islands are ordered by their smallest block. Returns whether anything was
/// rebuilt, which is not the case for the edges (in the same order) and flags of the last call. Union-find with path halving
/// (Tarjan & van Leeuwen 1984), the smaller block becoming the root. Precondition: edges refer to blocks of the scene. Allocates
/// only when sizes exceed those of all earlier calls.
bool updateIslands(Islands& islands, std::span<const BlockPair> edges, std::span<const std::uint8_t> asleep);

/// The root of a block's tree in a union-find: `parent` is [blocks]; a root is its own parent. Halves the path on its way (Tarjan
/// & van Leeuwen 1984). Precondition: the block is in a tree.
std::int32_t findRoot(std::vector<std::int32_t>& parent, std::int32_t block);

/// Marks every block that the edges join to a seed, including the seeds: connected[b] becomes 1 there and 0 elsewhere, [blocks].
/// The caller selects the edges along which wake or sleep spreads. `parent` is working space, kept to save allocations.
/// Precondition: edges and seeds refer to blocks of the scene.
void connectedBlocks(std::span<const BlockPair> edges, std::span<const std::int32_t> seeds, std::vector<std::int32_t>& parent,
                     std::span<std::uint8_t> connected);

}  // namespace springtower
