#include "broadphase/islands.h"

#include <algorithm>
#include <numeric>

namespace springtower {
namespace {

using Parent = std::vector<std::int32_t>;

std::int32_t& at(std::vector<std::int32_t>& values, std::int32_t block) {
  return values[static_cast<std::size_t>(block)];
}

void makeSingletons(Parent& parent, std::size_t blocks) {
  parent.resize(blocks);
  std::iota(parent.begin(), parent.end(), 0);
}

void unite(Parent& parent, const BlockPair& edge) {
  const std::int32_t a = findRoot(parent, edge.a);
  const std::int32_t b = findRoot(parent, edge.b);
  at(parent, std::max(a, b)) = std::min(a, b);
}

}  // namespace

std::int32_t findRoot(std::vector<std::int32_t>& parent, std::int32_t block) {
  while (at(parent, block) != block) {
    at(parent, block) = at(parent, at(parent, block));
    block = at(parent, block);
  }
  return block;
}

bool updateIslands(Islands& islands, std::span<const BlockPair> edges, std::span<const std::uint8_t> asleep) {
  if (!islands.start.empty() && std::ranges::equal(edges, islands.edges) && std::ranges::equal(asleep, islands.asleep)) {
    return false;
  }
  islands.edges.assign(edges.begin(), edges.end());
  islands.asleep.assign(asleep.begin(), asleep.end());
  const auto isAsleep = [&](std::int32_t block) { return asleep[static_cast<std::size_t>(block)] != 0; };
  const auto count = static_cast<std::int32_t>(asleep.size());

  makeSingletons(islands.parent, asleep.size());
  for (const BlockPair& edge : edges) {
    if (!isAsleep(edge.a) && !isAsleep(edge.b)) unite(islands.parent, edge);
  }

  // A root is the smallest block of its island, so it comes first and determines the number of its island. start[i + 1] counts
  // island i.
  islands.islandOf.assign(asleep.size(), -1);
  islands.start.assign(1, 0);
  for (std::int32_t block = 0; block < count; ++block) {
    if (isAsleep(block)) continue;
    const std::int32_t root = findRoot(islands.parent, block);
    if (root == block) {
      at(islands.islandOf, block) = static_cast<std::int32_t>(islands.start.size()) - 1;
      islands.start.push_back(0);
    }
    const std::int32_t island = at(islands.islandOf, root);
    at(islands.islandOf, block) = island;
    ++at(islands.start, island + 1);
  }
  std::partial_sum(islands.start.begin(), islands.start.end(), islands.start.begin());

  // Filling moves each start to the end of its island, which is the start of the next one; afterwards they are shifted back by
  // one.
  islands.blocks.resize(static_cast<std::size_t>(islands.start.back()));
  for (std::int32_t block = 0; block < count; ++block) {
    if (!isAsleep(block)) at(islands.blocks, at(islands.start, at(islands.islandOf, block))++) = block;
  }
  std::copy_backward(islands.start.begin(), islands.start.end() - 1, islands.start.end());
  islands.start.front() = 0;
  return true;
}

void connectedBlocks(std::span<const BlockPair> edges, std::span<const std::int32_t> seeds, std::vector<std::int32_t>& parent,
                     std::span<std::uint8_t> connected) {
  makeSingletons(parent, connected.size());
  for (const BlockPair& edge : edges) unite(parent, edge);
  std::ranges::fill(connected, std::uint8_t{0});
  for (const std::int32_t seed : seeds) connected[static_cast<std::size_t>(findRoot(parent, seed))] = 1;
  for (std::size_t b = 0; b < connected.size(); ++b) {
    connected[b] = connected[static_cast<std::size_t>(findRoot(parent, static_cast<std::int32_t>(b)))];
  }
}

}  // namespace springtower
