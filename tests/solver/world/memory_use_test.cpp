// Memory of pairs of blocks, touching or not.
#include "solver/world/memory_use.h"

#include "scenarios/walls.h"
#include "solver/runner/run.h"
#include "solver/world/contact_pool.h"
#include "tests/support/block_scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// Blocks side by side with gaps smaller than the margins of their swept boxes: near, but separated.
Scene blocksNearEachOther(int rows) {
  Scene scene;
  scene.name = "near blocks";
  for (int i = 0; i < rows * rows; ++i) {
    BlockSpec block;
    block.centre =
        Vec3((block.dimensions.x() + 1e-3) * (i % rows), (block.dimensions.y() + 1e-3) * (i / rows), 0.5 * block.dimensions.z());
    scene.blocks.push_back(block);
  }
  scene.settings.sleep = Sleep::off;
  return scene;
}

// Bytes: a key of 8, five numbers of 8, a phase and the index of its contact in the table; in addition indices in lists of 4 each
// (of its island, of active pairs, of saved pairs), and the two lists and the column for merging with the next sweep.
TEST(MemoryUse, ANearPairCostsAtMost96Bytes) {
  Simulation simulation(blocksNearEachOther(8));
  stepFor(simulation, 0.1);
  const MemoryUse use = memoryUse(simulation);
  ASSERT_GT(use.nearPairs, 2 * use.touchingPairs);
  const double each = static_cast<double>(use.pairs) / static_cast<double>(use.nearPairs);
  fmt::print("{} near pairs, {} touching, {:.1f} bytes a near pair\n", use.nearPairs, use.touchingPairs, each);
  EXPECT_LE(each, 96.0);
}

// 328 bytes with up to four points, and a second row of 320 with more; steps add the trial points, 256, and a pose, 48,
// where a manifold of the page has been refreshed; another 48 are there where a block has slept.
TEST(MemoryUse, ATouchingPairAddsAtMost650Bytes) {
  EXPECT_LE(ContactPool::kFirstBytes, 330U);
  EXPECT_LE(ContactPool::kFirstBytes + ContactPool::kSecondBytes, 650U);
  Simulation simulation(towerScene(18));
  stepFor(simulation, 0.2);
  const MemoryUse use = memoryUse(simulation);
  const auto each = [&](std::size_t bytes) { return static_cast<double>(bytes) / static_cast<double>(use.touchingPairs); };
  fmt::print("{} touching pairs, {:.0f} bytes each, and {:.0f} for steps and rollbacks\n", use.touchingPairs, each(use.touching),
             each(use.touchingSteps));
  EXPECT_LE(each(use.touching), 330.0);
  EXPECT_LE(each(use.touchingSteps), 310.0);
}

double bytesBesideTheFactor(Scene scene) {
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  stepFor(simulation, 0.5);
  const MemoryUse use = memoryUse(simulation);
  const double each = static_cast<double>(use.total() - use.factor) / static_cast<double>(simulation.model.blockCount());
  fmt::print("{} blocks, bytes each beside the factor: {:.0f}\n", simulation.model.blockCount(), each);
  return each;
}

// Of islands of any size. What a frame begins with is not copied at rest, and what was copied before is returned.
TEST(MemoryUse, AtRestABlockTakesAtMost6000BytesBesideTheFactor) {
  for (const int rows : {6, 18, 72}) EXPECT_LE(bytesBesideTheFactor(towerScene(rows)), 6000.0) << rows << " rows";
  EXPECT_LE(bytesBesideTheFactor(wallScene(20, 12)), 6000.0);
  EXPECT_LE(bytesBesideTheFactor(wallScene(200, 25)), 6000.0);
}

}  // namespace
}  // namespace springtower
