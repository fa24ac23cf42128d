// Scenes of many blocks in motion.
#include "scenarios/falling.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace springtower {
namespace {

double leastDistance(const Scene& scene) {
  double least_m = 1.0;
  for (std::size_t a = 0; a < scene.blocks.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) least_m = std::min(least_m, (scene.blocks[a].centre - scene.blocks[b].centre).norm());
  }
  return least_m;
}

// However blocks are turned, they do not touch farther apart than a diagonal.
TEST(FallingScenes, StartWithoutATouch) {
  const BlockSpec block;
  for (const int blocks : {1, 7, 200, 500}) {
    EXPECT_GT(leastDistance(heapScene(blocks)), block.dimensions.norm()) << blocks;
    EXPECT_GT(leastDistance(rainScene(blocks)), block.dimensions.norm()) << blocks;
    EXPECT_EQ(heapScene(blocks).blocks.size(), static_cast<std::size_t>(blocks));
    EXPECT_EQ(rainScene(blocks).blocks.size(), static_cast<std::size_t>(blocks));
  }
}

// A heap of 200 is eight layers of 25.
TEST(FallingScenes, AHeapIsSomeOneAndAHalfTimesAsHighAsWide) {
  const Scene scene = heapScene(200);
  EXPECT_EQ(std::count_if(scene.blocks.begin(), scene.blocks.end(),
                          [&](const BlockSpec& block) { return block.centre.z() == scene.blocks.back().centre.z(); }),
            25);
  const Vec3 across = scene.blocks.back().centre - scene.blocks.front().centre;
  EXPECT_NEAR(across.z(), 7.0 / 4.0 * across.x(), 1e-12);
}

// In free fall the 13 layers of 200 blocks land one after the other, equal times apart once there is room between them.
TEST(FallingScenes, RainLandsEvenly) {
  const Scene scene = rainScene(200);
  std::vector<double> lands_s;
  for (std::size_t i = 0; i < scene.blocks.size(); i += 16)
    lands_s.push_back(std::sqrt(2.0 * scene.blocks[i].centre.z() / kStandardGravity_m_s2));
  for (std::size_t i = 6; i < lands_s.size(); ++i) EXPECT_NEAR(lands_s[i] - lands_s[i - 1], 1.0 / 13.0, 1e-12);
}

TEST(FallingScenes, AShotFliesAtThreeFifthsOfTheHeight) {
  const Scene scene = shotTowerScene(10);
  ASSERT_EQ(scene.blocks.size(), 31U);
  EXPECT_NEAR(scene.blocks.back().centre.z(), 6.0 * kBlockHeight_m, 1e-12);
  EXPECT_EQ(scene.blocks.back().velocity, Vec3(5.0, 0.0, 0.0));
}

}  // namespace
}  // namespace springtower
