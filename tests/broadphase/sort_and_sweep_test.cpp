#include "broadphase/sort_and_sweep.h"

#include "tests/support/random.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <ostream>
#include <string>

namespace springtower {
namespace {

using Flags = std::vector<std::uint8_t>;

void setBox(SweptBoxes& boxes, std::size_t block, const Vec3& lower, const Vec3& extent) {
  for (std::size_t a = 0; a < 3; ++a) {
    boxes.lower[a][block] = lower[static_cast<Eigen::Index>(a)];
    boxes.upper[a][block] = boxes.lower[a][block] + extent[static_cast<Eigen::Index>(a)];
  }
}

std::vector<BlockPair> bruteForce(const SweptBoxes& boxes, const Flags& asleep) {
  std::vector<BlockPair> pairs;
  for (std::size_t i = 0; i < asleep.size(); ++i) {
    for (std::size_t j = i + 1; j < asleep.size(); ++j) {
      bool meet = asleep[i] == 0 || asleep[j] == 0;
      for (std::size_t a = 0; a < 3; ++a) {
        meet = meet && boxes.lower[a][i] <= boxes.upper[a][j] && boxes.lower[a][j] <= boxes.upper[a][i];
      }
      if (meet) pairs.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)});
    }
  }
  return pairs;
}

std::vector<BlockPair> freshPairs(const SweptBoxes& boxes, const Flags& asleep) {
  SortAndSweep sweep;
  std::vector<BlockPair> pairs;
  reset(sweep, boxes);
  findPairs(sweep, boxes, asleep, pairs);
  return pairs;
}

// Boxes of `count` blocks in a field of towers on a square grid, 18 rows of three, each box `margin` wider on every side.
SweptBoxes towers(int count, double margin) {
  SweptBoxes boxes;
  boxes.resize(static_cast<std::size_t>(count));
  const int side = static_cast<int>(std::ceil(std::sqrt(count / 54.0)));
  for (int b = 0; b < count; ++b) {
    const int tower = b / 54;
    const int along = tower % side;
    const int beside = tower / side;
    const int row = b % 54 / 3;
    const bool alongX = row % 2 == 0;
    const double across = (b % 3 - 1) * 0.02715;
    const Vec3 centre(along * 0.3 + (alongX ? 0.0 : across), beside * 0.3 + (alongX ? across : 0.0), (row + 0.5) * 0.0182);
    const Vec3 extent = Vec3(alongX ? 0.081 : 0.0267, alongX ? 0.0267 : 0.081, 0.0182) + Vec3::Constant(2.0 * margin);
    setBox(boxes, static_cast<std::size_t>(b), centre - 0.5 * extent, extent);
  }
  return boxes;
}

// A cloud of boxes that move at random.
struct Cloud {
  const char* name;
  std::size_t blocks;
  double space;  // m, edge of the cube the boxes are in
  double least;  // m, least and most extent of a box
  double most;
  double giants;  // chance of a box as large as the space
  double grid;    // m, all bounds are multiples of this, so that boxes often just touch; 0 for none
  double asleep;  // share of the blocks
  double far;     // m, where a teleport may end, beside the space
};

std::ostream& operator<<(std::ostream& stream, const Cloud& cloud) {
  return stream << cloud.name;
}

class Clouds : public testing::TestWithParam<Cloud> {
 protected:
  void place(std::size_t block, const Vec3& lower) {
    const Cloud& cloud = GetParam();
    const auto extent = [&] { return random.chance(cloud.giants) ? cloud.space : random.between(cloud.least, cloud.most); };
    const Vec3 extents(extent(), extent(), extent());
    const auto snapped = [&](const Vec3& v) -> Vec3 {
      return cloud.grid == 0.0 ? v : Vec3((v / cloud.grid).array().round() * cloud.grid);
    };
    setBox(boxes, block, snapped(lower), snapped(extents));
  }
  Vec3 anywhere() {
    const double space = GetParam().space;
    return {random.between(0.0, space), random.between(0.0, space), random.between(0.0, space)};
  }
  // Awake blocks drift, a few of them jump; a block that falls asleep shrinks once and then lies still.
  void move(double jumps) {
    const Cloud& cloud = GetParam();
    for (std::size_t b = 0; b < asleep.size(); ++b) {
      const bool slept = asleep[b] != 0;
      if (random.chance(0.1)) asleep[b] = random.chance(cloud.asleep) ? 1 : 0;
      const Vec3 lower(boxes.lower[0][b], boxes.lower[1][b], boxes.lower[2][b]);
      if (asleep[b] == 0) {
        const Vec3 step = (anywhere() - Vec3::Constant(0.5 * cloud.space)) * 0.02;
        const bool jump = random.chance(jumps);
        const bool away = jump && random.chance(0.1);
        place(b, away ? Vec3(anywhere() + Vec3::Constant(cloud.far)) : jump ? anywhere() : Vec3(lower + step));
      } else if (!slept) {
        setBox(boxes, b, lower, Vec3::Constant(cloud.grid));
      }
    }
  }

  Random random{SplitMix64(20030601)};
  SweptBoxes boxes;
  Flags asleep;
};

TEST_P(Clouds, GiveThePairsOfBruteForceInEveryFrame) {
  const Cloud& cloud = GetParam();
  boxes.resize(cloud.blocks);
  asleep.assign(cloud.blocks, 0);
  for (std::size_t b = 0; b < cloud.blocks; ++b) place(b, anywhere());
  SortAndSweep sweep;
  reset(sweep, boxes);
  std::vector<BlockPair> pairs;
  std::size_t found = 0;
  for (int frame = 0; frame < 200; ++frame) {
    move(frame % 50 == 49 ? 0.9 : 0.03);
    const std::uint64_t tests = findPairs(sweep, boxes, asleep, pairs);
    ASSERT_EQ(pairs, bruteForce(boxes, asleep)) << "frame " << frame;
    ASSERT_EQ(pairs, freshPairs(boxes, asleep)) << "frame " << frame;
    ASSERT_GE(tests, pairs.size());
    found += pairs.size();
  }
  EXPECT_GT(found, 200U);
}

INSTANTIATE_TEST_SUITE_P(SortAndSweep, Clouds,
                         testing::Values(Cloud{"awake", 150, 1.0, 0.05, 0.2, 0.0, 0.0, 0.0, 5.0},
                                         Cloud{"halfAsleep", 150, 1.0, 0.05, 0.2, 0.0, 0.0, 0.5, 5.0},
                                         Cloud{"mostlyAsleep", 300, 1.0, 0.05, 0.2, 0.0, 0.0, 0.95, 5.0},
                                         Cloud{"touching", 150, 1.0, 0.0, 0.25, 0.0, 0.125, 0.3, 5.0},
                                         Cloud{"mixedSizes", 150, 1.0, 1e-4, 0.3, 0.01, 0.0, 0.5, 5.0},
                                         Cloud{"dense", 60, 1.0, 0.5, 1.0, 0.0, 0.0, 0.5, 0.0},
                                         Cloud{"veryFar", 100, 1.0, 0.05, 0.2, 0.0, 0.0, 0.5, 1e9},
                                         Cloud{"beyondTheLastColumn", 100, 1e-9, 1e-10, 1e-9, 0.0, 0.0, 0.5, -1.0}),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(SortAndSweep, TouchingBoxesMeetAndBoxesApartByOneRoundingDoNot) {
  // Numbers without a finite binary form, so that extents are rounded.
  Random random{SplitMix64(7)};
  for (int trial = 0; trial < 20000; ++trial) {
    SweptBoxes boxes;
    boxes.resize(2);
    const auto number = [&](double least, double most) { return random.between(least, most) * std::exp2(-random.below(30)); };
    for (std::size_t b = 0; b < 2; ++b) {
      setBox(boxes, b, Vec3(-number(0.5, 1.0), -number(0.5, 1.0), -number(0.5, 1.0)), Vec3::Constant(2.0));
    }
    const auto axis = static_cast<std::size_t>(random.below(3));
    const auto first = static_cast<std::size_t>(random.below(2));
    const std::size_t second = 1 - first;
    boxes.lower[axis][first] = -number(0.0, 10.0);
    boxes.upper[axis][first] = number(-10.0, 10.0) + 10.0;
    boxes.lower[axis][second] = boxes.upper[axis][first];
    boxes.upper[axis][second] = boxes.lower[axis][second] + number(0.0, 10.0);
    // Each block must find the other: an awake one searches across the columns and along the axis in both directions.
    for (const Flags& asleep : {Flags{0, 0}, Flags{0, 1}, Flags{1, 0}}) {
      ASSERT_EQ(freshPairs(boxes, asleep), (std::vector<BlockPair>{{0, 1}})) << "trial " << trial;
    }
    boxes.lower[axis][second] = std::nextafter(boxes.lower[axis][second], std::numeric_limits<double>::infinity());
    boxes.upper[axis][second] = std::max(boxes.upper[axis][second], boxes.lower[axis][second]);
    ASSERT_TRUE(freshPairs(boxes, Flags{0, 0}).empty()) << "trial " << trial;
  }
}

TEST(SortAndSweep, PicksTheAxisAlongWhichBoxesAreThinnest) {
  SweptBoxes boxes;
  boxes.resize(2);
  SortAndSweep sweep;
  const auto axisFor = [&](const Vec3& extent) {
    for (std::size_t b = 0; b < 2; ++b) setBox(boxes, b, Vec3::Zero(), extent);
    reset(sweep, boxes);
    return sweep.axis;
  };
  EXPECT_EQ(axisFor(Vec3(3.0, 2.0, 1.0)), 2U);
  EXPECT_EQ(axisFor(Vec3(1.0, 2.0, 3.0)), 0U);
  EXPECT_EQ(axisFor(Vec3(2.0, 1.0, 3.0)), 1U);
  EXPECT_EQ(axisFor(Vec3(1.0, 1.0, 1.0)), 2U);
}

TEST(SortAndSweep, AnEmptyOrSleepingSceneHasNoPairs) {
  EXPECT_TRUE(freshPairs(SweptBoxes{}, Flags{}).empty());

  const SweptBoxes boxes = towers(54, 0.001);
  SortAndSweep sweep;
  reset(sweep, boxes);
  std::vector<BlockPair> pairs{{0, 1}};
  EXPECT_EQ(findPairs(sweep, boxes, Flags(54, 1), pairs), 0U);
  EXPECT_TRUE(pairs.empty());
}

TEST(SortAndSweep, AFieldOfTowersCostsAFewTestsPerBlock) {
  for (const int blocks : {54, 540, 5400}) {
    const SweptBoxes boxes = towers(blocks, 0.001);
    const Flags awake(static_cast<std::size_t>(blocks), 0);
    SortAndSweep sweep;
    reset(sweep, boxes);
    std::vector<BlockPair> pairs;
    const std::uint64_t tests = findPairs(sweep, boxes, awake, pairs);
    // A row touches the next with 9 pairs and itself with 2: (17 * 9 + 18 * 2) pairs in a tower.
    EXPECT_EQ(pairs.size(), static_cast<std::size_t>(blocks) / 54U * 189U);
    EXPECT_LE(tests, 6U * static_cast<std::uint64_t>(blocks));
  }
}

TEST(SortAndSweep, OneAwakeBlockOfAFieldCostsAFewTests) {
  SweptBoxes boxes = towers(5400, 0.001);
  Flags asleep(5400, 1);
  SortAndSweep sweep;
  reset(sweep, boxes);
  std::vector<BlockPair> pairs;
  findPairs(sweep, boxes, asleep, pairs);
  for (const std::int32_t block : {0, 1, 2700, 5399}) {
    const auto b = static_cast<std::size_t>(block);
    asleep[b] = 0;
    // It moves up through the rows of its tower, and back.
    for (const double step : {0.0, 0.02, 0.02, 0.02, -0.06}) {
      boxes.lower[2][b] += step;
      boxes.upper[2][b] += step;
      const std::uint64_t tests = findPairs(sweep, boxes, asleep, pairs);
      EXPECT_EQ(pairs, bruteForce(boxes, asleep));
      EXPECT_LE(tests, 20U);
    }
    asleep[b] = 1;
  }
}

TEST(SortAndSweep, ABlockThatGrowsTallIsSeenByTheBlocksAboveIt) {
  SweptBoxes boxes = towers(540, 0.001);
  Flags asleep(540, 1);
  SortAndSweep sweep;
  reset(sweep, boxes);
  std::vector<BlockPair> pairs;
  findPairs(sweep, boxes, asleep, pairs);
  // Blocks 3 and 20 are exchanged, so that the upper one of the pair has to find the lower one.
  setBox(boxes, 3, Vec3(0.0, 0.0, 0.5), Vec3(0.08, 0.03, 0.02));
  setBox(boxes, 20, Vec3(0.0, 0.0, 0.4), Vec3(0.08, 0.03, 0.02));
  asleep[3] = asleep[20] = 0;
  findPairs(sweep, boxes, asleep, pairs);
  EXPECT_TRUE(pairs.empty());
  // As when it accelerates, awake, and is then put to sleep in that position.
  boxes.upper[2][20] = 0.5;
  findPairs(sweep, boxes, asleep, pairs);
  EXPECT_EQ(pairs, (std::vector<BlockPair>{{3, 20}}));
  boxes.upper[2][20] = 0.45;
  setBox(boxes, 3, Vec3(0.0, 0.0, 0.7), Vec3(0.08, 0.03, 0.02));
  findPairs(sweep, boxes, asleep, pairs);
  EXPECT_TRUE(pairs.empty());
  boxes.upper[2][20] = 0.7;
  asleep[20] = 1;
  findPairs(sweep, boxes, asleep, pairs);
  EXPECT_EQ(pairs, (std::vector<BlockPair>{{3, 20}}));
}

TEST(SortAndSweep, AGiantBlockDoesNotSpoilTheOthers) {
  SweptBoxes boxes = towers(5400, 0.001);
  setBox(boxes, 17, Vec3(-10.0, -10.0, 0.1), Vec3(20.0, 20.0, 0.01));
  const Flags awake(5400, 0);
  SortAndSweep sweep;
  reset(sweep, boxes);
  std::vector<BlockPair> pairs;
  const std::uint64_t tests = findPairs(sweep, boxes, awake, pairs);
  EXPECT_EQ(pairs, bruteForce(boxes, awake));
  EXPECT_LE(tests, 8U * 5400U);
}

}  // namespace
}  // namespace springtower
