#include "solver/world/island_history.h"

#include <array>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// Blocks 1 and 3 were in an island that rigid steps carried, block 2 in one whose vibration needed six steps.
TEST(IslandHistory, OfIslandsThatMergeTheStrongestCountsAndTheRestIsTheFirstBlocks) {
  std::array<IslandHistory, 4> histories{};
  histories[1] = {.rigidFrames = 2, .implicitSteps = 1, .forced = true};
  histories[2] = {.implicitSteps = 6};
  histories[3] = {.rigidFrames = 4, .rigid = true};
  const std::array<std::int32_t, 3> blocks{1, 2, 3};

  const IslandHistory merged = mergedHistory(histories, blocks);

  EXPECT_EQ(merged.rigidFrames, 4);
  EXPECT_EQ(merged.implicitSteps, 6);
  EXPECT_TRUE(merged.rigid);
  EXPECT_TRUE(merged.forced);
}

TEST(IslandHistory, ABlockThatIsAloneHasItsOwn) {
  std::array<IslandHistory, 2> histories{};
  histories[0].rigid = true;
  const std::array<std::int32_t, 1> alone{1};

  EXPECT_FALSE(mergedHistory(histories, alone).rigid);
}

}  // namespace
}  // namespace springtower
