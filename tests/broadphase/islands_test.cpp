#include "broadphase/islands.h"

#include "tests/support/random.h"

#include <deque>
#include <gtest/gtest.h>

namespace springtower {
namespace {

using Flags = std::vector<std::uint8_t>;
using Blocks = std::vector<std::int32_t>;

// All blocks that edges join to the seeds, breadth first, over blocks that are awake.
Flags breadthFirst(const std::vector<BlockPair>& edges, const Blocks& seeds, const Flags& asleep) {
  Flags reached(asleep.size(), 0);
  std::deque<std::int32_t> queue;
  const auto reach = [&](std::int32_t block) {
    const auto b = static_cast<std::size_t>(block);
    if (asleep[b] != 0 || reached[b] != 0) return;
    reached[b] = 1;
    queue.push_back(block);
  };
  for (const std::int32_t seed : seeds) reach(seed);
  while (!queue.empty()) {
    const std::int32_t block = queue.front();
    queue.pop_front();
    for (const BlockPair& edge : edges) {
      if (edge.a == block) reach(edge.b);
      if (edge.b == block) reach(edge.a);
    }
  }
  return reached;
}

std::vector<Blocks> referenceIslands(const std::vector<BlockPair>& edges, const Flags& asleep) {
  std::vector<Blocks> islands;
  Flags done = asleep;
  for (std::size_t b = 0; b < asleep.size(); ++b) {
    if (done[b] != 0) continue;
    const Flags reached = breadthFirst(edges, {static_cast<std::int32_t>(b)}, asleep);
    islands.emplace_back();
    for (std::size_t other = 0; other < asleep.size(); ++other) {
      if (reached[other] == 0) continue;
      islands.back().push_back(static_cast<std::int32_t>(other));
      done[other] = 1;
    }
  }
  return islands;
}

std::vector<Blocks> listed(const Islands& islands) {
  std::vector<Blocks> list;
  for (std::size_t i = 0; i < islands.count(); ++i) list.emplace_back(islands.island(i).begin(), islands.island(i).end());
  return list;
}

std::vector<BlockPair> randomEdges(Random& random, std::int32_t blocks, std::int32_t count) {
  std::vector<BlockPair> edges(static_cast<std::size_t>(count));
  for (BlockPair& edge : edges) edge = {random.below(blocks), random.below(blocks)};
  return edges;
}

Flags randomFlags(Random& random, std::int32_t blocks, double share) {
  Flags flags(static_cast<std::size_t>(blocks));
  for (auto& flag : flags) flag = random.chance(share) ? 1 : 0;
  return flags;
}

TEST(Islands, AreOrderedByTheirSmallestBlock) {
  Islands islands;
  const std::vector<BlockPair> edges = {{4, 6}, {1, 5}, {2, 3}, {3, 5}, {5, 7}};
  const Flags asleep = {0, 0, 0, 1, 0, 0, 0, 0};
  EXPECT_EQ(islands.count(), 0U);
  EXPECT_TRUE(updateIslands(islands, edges, asleep));
  EXPECT_EQ(listed(islands), (std::vector<Blocks>{{0}, {1, 5, 7}, {2}, {4, 6}}));
  EXPECT_EQ(islands.islandOf, (Blocks{0, 1, 2, -1, 3, 1, 3, 1}));
}

TEST(Islands, MatchBreadthFirstSearchOnRandomGraphs) {
  Random random{SplitMix64(11)};
  Islands islands;
  for (int trial = 0; trial < 500; ++trial) {
    const std::int32_t blocks = 1 + random.below(80);
    const std::vector<BlockPair> edges = randomEdges(random, blocks, random.below(2 * blocks));
    const Flags asleep = randomFlags(random, blocks, random.between(0.0, 1.0));
    updateIslands(islands, edges, asleep);
    const std::vector<Blocks> expected = referenceIslands(edges, asleep);
    ASSERT_EQ(listed(islands), expected) << "trial " << trial;
    Blocks islandOf(asleep.size(), -1);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      for (const std::int32_t block : expected[i]) islandOf[static_cast<std::size_t>(block)] = static_cast<std::int32_t>(i);
    }
    ASSERT_EQ(islands.islandOf, islandOf) << "trial " << trial;
  }
}

TEST(Islands, DoNotDependOnTheOrderOfTheEdges) {
  Random random{SplitMix64(12)};
  std::vector<BlockPair> edges = randomEdges(random, 100, 80);
  const Flags asleep = randomFlags(random, 100, 0.1);
  Islands forwards;
  Islands backwards;
  updateIslands(forwards, edges, asleep);
  std::reverse(edges.begin(), edges.end());
  updateIslands(backwards, edges, asleep);
  EXPECT_EQ(listed(forwards), listed(backwards));
}

TEST(Islands, AreKeptWhileNothingChanges) {
  Islands islands;
  std::vector<BlockPair> edges = {{0, 1}, {2, 3}};
  Flags asleep = {0, 0, 0, 0};
  EXPECT_TRUE(updateIslands(islands, edges, asleep));
  EXPECT_FALSE(updateIslands(islands, edges, asleep));

  edges[1] = {1, 3};
  EXPECT_TRUE(updateIslands(islands, edges, asleep));
  EXPECT_EQ(listed(islands), (std::vector<Blocks>{{0, 1, 3}, {2}}));
  EXPECT_FALSE(updateIslands(islands, edges, asleep));

  asleep[1] = 1;
  EXPECT_TRUE(updateIslands(islands, edges, asleep));
  EXPECT_EQ(listed(islands), (std::vector<Blocks>{{0}, {2}, {3}}));

  edges.clear();
  EXPECT_TRUE(updateIslands(islands, edges, asleep));
  EXPECT_FALSE(updateIslands(islands, edges, asleep));
}

TEST(Islands, ASleepingOrEmptySceneHasNone) {
  Islands islands;
  EXPECT_TRUE(updateIslands(islands, std::vector<BlockPair>{{0, 1}}, Flags{1, 1}));
  EXPECT_EQ(islands.count(), 0U);
  EXPECT_TRUE(islands.blocks.empty());
  EXPECT_EQ(islands.islandOf, (Blocks{-1, -1}));
  EXPECT_TRUE(updateIslands(islands, {}, {}));
  EXPECT_FALSE(updateIslands(islands, {}, {}));
  EXPECT_EQ(islands.count(), 0U);
}

TEST(ConnectedBlocks, MatchBreadthFirstSearchOnRandomGraphs) {
  Random random{SplitMix64(13)};
  std::vector<std::int32_t> parent;
  for (int trial = 0; trial < 500; ++trial) {
    const std::int32_t blocks = 1 + random.below(80);
    const std::vector<BlockPair> edges = randomEdges(random, blocks, random.below(blocks));
    Blocks seeds(static_cast<std::size_t>(random.below(4)));
    for (auto& seed : seeds) seed = random.below(blocks);
    const Flags nobodyAsleep(static_cast<std::size_t>(blocks), 0);
    Flags connected(static_cast<std::size_t>(blocks), 7);
    connectedBlocks(edges, seeds, parent, connected);
    ASSERT_EQ(connected, breadthFirst(edges, seeds, nobodyAsleep)) << "trial " << trial;
  }
}

}  // namespace
}  // namespace springtower
