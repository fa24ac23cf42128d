#include "solver/metrics/measures.h"

#include "core/scene/scene.h"
#include "tests/solver/frame/boxes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace springtower {
namespace {

const Vec3 kBlock(kBlockLength_m, kBlockWidth_m, kBlockHeight_m);

std::vector<TestBox> boxesOf(const Scene& scene) {
  std::vector<TestBox> boxes;
  for (const BlockSpec& block : scene.blocks) boxes.push_back({block.centre, block.dimensions, block.orientation});
  return boxes;
}

std::vector<int> rowsOf(const Scene& scene) {
  std::vector<int> rows;
  for (const BlockSpec& block : scene.blocks) rows.push_back(block.row);
  return rows;
}

// Two blocks of which the second is changed after the start.
struct StandingTest : ::testing::Test {
  std::vector<TestBox> boxes = {{{0.0, 0.0, 0.0091}, kBlock},
                                {{0.0, 0.0, 0.0273}, {0.05, 0.02, 0.01}, turned(90.0, Vec3::UnitZ())}};
  BlockModel model = modelOf(boxes);
  std::vector<FittedBox> start = fittedBoxes(cornersOf(boxes));

  [[nodiscard]] Standing now() const { return standing(model, start, cornersOf(boxes)); }
};

TEST_F(StandingTest, StandsAtTheStart) {
  EXPECT_TRUE(now().stands);
  EXPECT_EQ(now().block, kFloor);
  EXPECT_EQ(describe(now()), "all blocks stand");
}

TEST_F(StandingTest, FallsWhenHalfItsHeightLower) {
  boxes[1].centre.z() -= 0.004999;
  EXPECT_TRUE(now().stands);
  boxes[1].centre.z() -= 0.000002;
  EXPECT_FALSE(now().stands);
  EXPECT_EQ(now().block, blockId(1));
  EXPECT_EQ(now().fall, Fall::lower);
  EXPECT_NEAR(now().amount, 0.005001, 1e-12);
  EXPECT_EQ(describe(now()), "block 1 is 5 mm lower than at the start");
  boxes[1].centre.z() += 1.0;
  EXPECT_TRUE(now().stands) << "higher is not fallen";
}

TEST_F(StandingTest, FallsWhenHalfItsWidthAside) {
  boxes[1].centre += Vec3(0.0079, 0.0060, 0.0);
  EXPECT_TRUE(now().stands);
  boxes[1].centre += Vec3(0.0002, 0.0001, 0.0);
  EXPECT_EQ(now().fall, Fall::sideways);
  EXPECT_NEAR(now().amount, std::hypot(0.0081, 0.0061), 1e-12);
}

TEST_F(StandingTest, FallsWhenTurnedByMoreThanFiveDegreesAboutAnyAxis) {
  const Eigen::Quaterniond before = boxes[1].orientation;
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, -2, 3)}) {
    boxes[1].orientation = turned(4.999, axis) * before;
    EXPECT_TRUE(now().stands);
    boxes[1].orientation = turned(5.001, axis) * before;
    EXPECT_EQ(now().fall, Fall::turned);
    EXPECT_NEAR(now().amount, 5.001, 1e-9);
  }
  boxes[1].orientation = turned(180.0, Vec3::UnitZ()) * before;
  EXPECT_NEAR(now().amount, 180.0, 1e-5);
}

// The second block's sides are 50, 20 and 10 mm: neither which of them is upright nor how the scene is turned matters.
TEST_F(StandingTest, MeasuresABlockByItsSortedSides) {
  boxes[1].dimensions = Vec3(0.01, 0.05, 0.02);  // on its edge
  model = modelOf(boxes);
  for (const double turn_deg : {0.0, 33.0}) {
    const Eigen::Quaterniond turn = turned(turn_deg, Vec3::UnitZ());
    std::vector<TestBox> placed = boxes;
    for (TestBox& box : placed) {
      box.centre = turn * box.centre;
      box.orientation = turn * box.orientation;
    }
    start = fittedBoxes(cornersOf(placed));
    const auto moved = [&](const Vec3& by, double angle_deg, const Vec3& axis) {
      std::vector<TestBox> now = placed;
      now[1].centre += turn * by;
      now[1].orientation = turned(angle_deg, turn * axis) * now[1].orientation;
      return standing(model, start, cornersOf(now)).fall;
    };
    EXPECT_EQ(moved({0.0, 0.0, -0.0049}, 0.0, Vec3::UnitX()), Fall::none);
    EXPECT_EQ(moved({0.0, 0.0, -0.0051}, 0.0, Vec3::UnitX()), Fall::lower);
    for (const Vec3& aside : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0.6, 0.8, 0)}) {
      EXPECT_EQ(moved(0.0099 * aside, 0.0, Vec3::UnitX()), Fall::none);
      EXPECT_EQ(moved(0.0101 * aside, 0.0, Vec3::UnitX()), Fall::sideways);
    }
    EXPECT_EQ(moved(Vec3::Zero(), 4.9, Vec3::UnitZ()), Fall::none);
    EXPECT_EQ(moved(Vec3::Zero(), 5.1, Vec3::UnitZ()), Fall::turned);
    EXPECT_EQ(moved({0.0, 0.0, -0.001}, 90.0, Vec3::UnitX()), Fall::turned) << "tipped over";
  }
}

TEST_F(StandingTest, LeavesOutHeldAndRemovedBlocks) {
  boxes[1].centre.z() -= 1.0;
  EXPECT_FALSE(now().stands);
  const std::vector<std::uint8_t> leftOut = {0, 1};
  EXPECT_TRUE(standing(model, start, cornersOf(boxes), leftOut).stands);
}

TEST_F(StandingTest, APositionThatIsNoNumberHasFallen) {
  ParticleArray position = cornersOf(boxes);
  position.component[0][9] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(standing(model, start, position).stands);
}

TEST(StackedReference, IsTheTowerWithoutItsStartGap) {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  const Scene tight = towerScene(6, options);
  options.startGap_m = 0.004;
  const Scene spaced = towerScene(6, options);
  const ParticleArray expected = cornersOf(boxesOf(tight));
  const ParticleArray closed = stackedReference(cornersOf(boxesOf(spaced)), rowsOf(spaced), true);
  EXPECT_GT(largestCornerMove(cornersOf(boxesOf(spaced)), expected), 0.0199);
  EXPECT_LT(largestCornerMove(closed, expected), 1e-15);
}

TEST(StackedReference, IsTheStartItselfWhenThereIsNoGap) {
  const Scene scene = bitCodeScene("(101)-(010)-(111)");
  const ParticleArray start = cornersOf(boxesOf(scene));
  EXPECT_LT(largestCornerMove(start, stackedReference(start, rowsOf(scene), true)), 1e-15);
}

TEST(StackedReference, LeavesWhatIsInNoRowOrOverNothing) {
  std::vector<TestBox> boxes = {{{0.0, 0.0, 0.5}, kBlock}, {{0.5, 0.0, 0.5}, kBlock}, {{0.0, 0.0, 0.6}, kBlock}};
  const ParticleArray start = cornersOf(boxes);
  const std::vector<int> row = {-1, 1, 2};
  EXPECT_EQ(largestCornerMove(start, stackedReference(start, row, true)), 0.0);
  const std::vector<int> bottom = {0, -1, 1};
  EXPECT_EQ(stackedReference(start, bottom, false).component[2], [&] {
    boxes[2].centre.z() = 0.5 + kBlock.z();
    return cornersOf(boxes).component[2];
  }()) << "without a floor the bottom row stays, the next closes up to it";
  EXPECT_NEAR(centre(stackedReference(start, bottom, true), 2).z(), 1.5 * kBlock.z(), 1e-15);
}

TEST(BottomRow, IsRowZeroOrTheLowestBlocks) {
  const Scene scene = bitCodeScene("(1L0)-(010)");
  const ParticleArray start = cornersOf(boxesOf(scene));
  const BlockModel model = modelOf(boxesOf(scene));
  const std::vector<BlockId> expected = {blockId(0), blockId(1)};
  EXPECT_EQ(bottomRow(model, start, rowsOf(scene)), expected);
  EXPECT_EQ(bottomRow(model, start, std::vector<int>{-1, -1, -1}), expected);
}

TEST(MeanRowCompression, IsTheMeanHeightLost) {
  std::vector<TestBox> boxes = {{Vec3::Zero(), kBlock}, {{0.2, 0.0, 0.0}, kBlock}};
  const ParticleArray start = cornersOf(boxes);
  const BlockModel model = modelOf(boxes);
  boxes[0].dimensions.z() -= 2e-5;
  boxes[1].dimensions.z() -= 4e-5;
  boxes[1].dimensions.x() += 1e-3;
  const std::vector<BlockId> both = {blockId(0), blockId(1)};
  EXPECT_NEAR(meanRowCompression(model, start, cornersOf(boxes), both), 3e-5, 1e-16);
  EXPECT_NEAR(meanRowCompression(model, start, cornersOf(boxes), std::vector<BlockId>{blockId(1)}), 4e-5, 1e-16);
  EXPECT_EQ(meanRowCompression(model, start, cornersOf(boxes), {}), 0.0);
}

TEST(MeanRowCompression, OfABlockOnItsEndIsAlongItsLength) {
  std::vector<TestBox> boxes = {{Vec3::Zero(), kBlock, turned(90.0, Vec3::UnitY())}};
  const ParticleArray start = cornersOf(boxes);
  const BlockModel model = modelOf(boxes);
  boxes[0].dimensions.x() -= 1e-4;
  EXPECT_NEAR(meanRowCompression(model, start, cornersOf(boxes), std::vector<BlockId>{blockId(0)}), 1e-4, 1e-16);
}

TEST(MaxStrain, OfACuboidStretchedOrSquashedAlongOneAxis) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const double strain : {0.01, -0.02}) {
      std::vector<TestBox> boxes = {{Vec3::Zero(), kBlock}, {{0.3, 0.0, 0.0}, kBlock, turned(20.0, {1.0, 1.0, 0.0})}};
      const BlockModel model = modelOf(boxes);
      EXPECT_NEAR(maxStrain(model, cornersOf(boxes)), 0.0, 1e-14);
      boxes[1].dimensions[axis] *= 1.0 + strain;
      EXPECT_NEAR(maxStrain(model, cornersOf(boxes)), std::abs(strain), 1e-14);
    }
  }
}

TEST(MaxStrain, OfAShearedCubeIsThatOfItsDiagonal) {
  const std::vector<TestBox> boxes = {{Vec3::Zero(), Vec3::Ones()}};
  ParticleArray position = cornersOf(boxes);
  const double shear = 0.1;
  for (std::size_t c = 0; c < kCorners; ++c) position.add(0, c, {shear * position.at(0, c).z(), 0.0, 0.0});
  EXPECT_NEAR(maxStrain(modelOf(boxes), position), std::sqrt((1.0 + shear) * (1.0 + shear) + 1.0) / std::sqrt(2.0) - 1.0, 1e-14);
}

TEST(MaxStrain, IncludesEachOfTheTwentyEightSprings) {
  const std::vector<TestBox> boxes = {{Vec3::Zero(), kBlock}};
  const ParticleArray position = cornersOf(boxes);
  for (std::size_t group = 0; group < kSpringGroups; ++group) {
    BlockModel model = modelOf(boxes);
    model.restLength[group][0] /= 1.5;
    EXPECT_NEAR(maxStrain(model, position), 0.5, 1e-14);
  }
  for (std::size_t c = 0; c < kCorners; ++c) {
    ParticleArray changed = position;
    changed.add(0, c, 1e-3 * Vec3(1.0, 2.0, 3.0));
    EXPECT_GT(maxStrain(modelOf(boxes), changed), 1e-3) << "corner " << c;
  }
}

TEST(LargestCornerMove, IsTheLargestDistance) {
  const ParticleArray before = cornersOf({{Vec3::Zero(), kBlock}, {Vec3::Ones(), kBlock}});
  ParticleArray after = before;
  after.add(0, 3, {1e-3, 0.0, 0.0});
  after.add(1, 6, {3e-3, -4e-3, 12e-3});
  EXPECT_NEAR(largestCornerMove(before, after), 13e-3, 1e-15);
  EXPECT_EQ(largestCornerMove(before, before), 0.0);
}

TEST(RootMeanSquareCornerSpeed, IsTheMeanOverAllCorners) {
  ParticleArray velocity;
  EXPECT_EQ(rootMeanSquareCornerSpeed(velocity), 0.0);
  velocity.resize(2);
  for (std::size_t c = 0; c < kCorners; ++c) velocity.set(1, c, {2.0, -3.0, 6.0});
  EXPECT_NEAR(rootMeanSquareCornerSpeed(velocity), 7.0 / std::sqrt(2.0), 1e-15);
}

TEST(TopHeight, IsTheMiddleOfTheFaceThatLooksUp) {
  EXPECT_EQ(topHeight(ParticleArray{}), 0.0);
  const Scene scene = towerScene(18);
  EXPECT_NEAR(topHeight(cornersOf(boxesOf(scene))), 18 * kBlockHeight_m, 1e-14);
  const std::vector<TestBox> onEnd = {{{0.0, 0.0, 0.05}, kBlock, turned(-90.0, Vec3::UnitY())}};
  EXPECT_NEAR(topHeight(cornersOf(onEnd)), 0.05 + 0.5 * kBlock.x(), 1e-15);
  const std::vector<TestBox> leaning = {{{0.0, 0.0, 0.05}, kBlock, turned(30.0, Vec3::UnitX())}};
  EXPECT_NEAR(topHeight(cornersOf(leaning)), 0.05 + 0.5 * kBlock.z() * std::cos(std::acos(-1.0) / 6.0), 1e-15);
}

TEST(TopHeightError, IsAgainstRigidBlocksWithoutGaps) {
  TowerOptions options;
  options.startGap_m = 0.001;
  const Scene scene = towerScene(4, options);
  const ParticleArray start = cornersOf(boxesOf(scene));
  const ParticleArray closed = stackedReference(start, rowsOf(scene), true);
  EXPECT_NEAR(topHeightError(closed, start), 0.003, 1e-14);
  ParticleArray lower = closed;
  for (double& z : lower.component[2]) z *= 0.99;
  EXPECT_NEAR(topHeightError(closed, lower), -0.04 * kBlockHeight_m, 1e-14);
}

}  // namespace
}  // namespace springtower
