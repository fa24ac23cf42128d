#include "broadphase/swept_boxes.h"

#include "tests/support/random.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>

namespace springtower {
namespace {

constexpr double kGravity = 9.81;

MotionState randomMotion(std::size_t blocks, Random& random) {
  MotionState state;
  state.resize(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    const Vec3 place{random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(0.0, 1.0)};
    for (std::size_t c = 0; c < kCorners; ++c) {
      const auto number = [&](double most) { return random.between(-most, most); };
      state.position.set(b, c, place + Vec3(number(0.04), number(0.04), number(0.04)));
      state.velocity.set(b, c, Vec3(number(3.0), number(3.0), number(3.0)));
    }
  }
  return state;
}

// Margins of all blocks, m.
std::vector<double> margins(std::size_t blocks, double margin_m) {
  return std::vector<double>(blocks, margin_m);
}

// Two blocks, of which the second is a box of 2 x 4 x 1 m about (5, -7, 0) m at rest.
MotionState boxAtFiveMinusSeven() {
  MotionState state;
  state.resize(2);
  for (std::size_t c = 0; c < kCorners; ++c) {
    state.position.set(1, c, Vec3(5.0 + cornerSide(c, 0), -7.0 + 2.0 * cornerSide(c, 1), 0.5 * cornerSide(c, 2)));
  }
  return state;
}

TEST(SweptBoxes, AreTheCornersOnTheirWayGrownByTheReach) {
  MotionState state = boxAtFiveMinusSeven();
  for (std::size_t c = 0; c < kCorners; ++c) state.velocity.set(1, c, Vec3(4.0, -2.0, 0.0));
  state.velocity.add(1, 3, Vec3(2.0, 3.0, 6.0));  // two opposite corners, so that the centre moves at the same speed
  state.velocity.add(1, 4, Vec3(-2.0, -3.0, -6.0));
  SweptBoxes boxes;
  boxes.resize(2);
  std::vector<double> reach(2, -1.0);

  // Speed 7 about the centre, duration 1/2, gravity 8, margin 1/4: reach 3.5 + 1 + 0.25. The centre moves by (2, -1, 0).
  computeSweptBoxes(state, std::vector<std::int32_t>{1}, 8.0, 0.5, Way::onwards, margins(2, 0.25), boxes, reach);

  EXPECT_EQ(reach[1], 4.75);
  EXPECT_EQ(boxes.lower[0][1], 4.0 - 4.75);
  EXPECT_EQ(boxes.upper[0][1], 6.0 + 2.0 + 4.75);
  EXPECT_EQ(boxes.lower[1][1], -9.0 - 1.0 - 4.75);
  EXPECT_EQ(boxes.upper[1][1], -5.0 + 4.75);
  EXPECT_EQ(boxes.lower[2][1], -0.5 - 4.75);
  EXPECT_EQ(boxes.upper[2][1], 0.5 + 4.75);
}

// What may rebound is looked for on all sides, as far as its fastest corner goes.
TEST(SweptBoxes, GrowByTheSpeedOnAllSidesWhereBlocksRebound) {
  MotionState state = boxAtFiveMinusSeven();
  state.velocity.set(1, 3, Vec3(0.0, 1.0, 0.0));
  state.velocity.set(1, 6, Vec3(2.0, -3.0, 6.0));
  SweptBoxes boxes;
  boxes.resize(2);
  std::vector<double> reach(2, -1.0);

  // Speed 7, duration 1/2, gravity 8, margin 1/4: reach 3.5 + 1 + 0.25.
  computeSweptBoxes(state, std::vector<std::int32_t>{1}, 8.0, 0.5, Way::anySide, margins(2, 0.25), boxes, reach);

  EXPECT_EQ(reach[1], 4.75);
  EXPECT_EQ(boxes.lower[0][1], 4.0 - 4.75);
  EXPECT_EQ(boxes.upper[0][1], 6.0 + 4.75);
  EXPECT_EQ(boxes.lower[1][1], -9.0 - 4.75);
  EXPECT_EQ(boxes.upper[1][1], -5.0 + 4.75);
  EXPECT_EQ(boxes.lower[2][1], -0.5 - 4.75);
  EXPECT_EQ(boxes.upper[2][1], 0.5 + 4.75);
}

TEST(SweptBoxes, LeaveOtherBlocksAlone) {
  Random random{SplitMix64(1)};
  const MotionState state = randomMotion(3, random);
  SweptBoxes boxes;
  boxes.resize(3);
  std::vector<double> reach(3, -1.0);
  for (std::size_t a = 0; a < 3; ++a) {
    boxes.lower[a].assign(3, -1.0);
    boxes.upper[a].assign(3, -1.0);
  }
  computeSweptBoxes(state, std::vector<std::int32_t>{0, 2}, kGravity, 0.1, Way::onwards, margins(3, 0.001), boxes, reach);
  EXPECT_EQ(reach[1], -1.0);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_EQ(boxes.lower[a][1], -1.0);
    EXPECT_EQ(boxes.upper[a][1], -1.0);
    EXPECT_NE(boxes.lower[a][0], -1.0);
    EXPECT_NE(boxes.lower[a][2], -1.0);
  }
}

TEST(SweptBoxes, HoldEveryCornerInFreeFlight) {
  Random random{SplitMix64(2)};
  constexpr std::size_t kBlocks = 50;
  const MotionState state = randomMotion(kBlocks, random);
  std::vector<std::int32_t> all(kBlocks);
  std::iota(all.begin(), all.end(), 0);
  SweptBoxes boxes;
  boxes.resize(kBlocks);
  std::vector<double> reach(kBlocks);
  constexpr double kDuration_s = 0.05;
  constexpr double kRounding_m = 1e-15;
  computeSweptBoxes(state, all, kGravity, kDuration_s, Way::onwards, margins(kBlocks, kRounding_m), boxes, reach);
  for (std::size_t b = 0; b < kBlocks; ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      for (const double time_s : {0.0, 0.5 * kDuration_s, kDuration_s}) {
        const Vec3 travel = state.velocity.at(b, c) * time_s + Vec3(0.0, 0.0, -0.5 * kGravity * time_s * time_s);
        const Vec3 corner = state.position.at(b, c) + travel;
        for (std::size_t a = 0; a < 3; ++a) {
          EXPECT_LE(boxes.lower[a][b], corner[static_cast<Eigen::Index>(a)]);
          EXPECT_GE(boxes.upper[a][b], corner[static_cast<Eigen::Index>(a)]);
        }
      }
    }
  }
}

// A corner's path about the centre is no longer than its speed times the duration.
TEST(SweptBoxes, HoldEveryCornerOfABlockThatSpins) {
  MotionState state;
  state.resize(1);
  const Vec3 velocity(3.0, -1.0, 0.5);
  const Vec3 spin(0.0, 0.0, 60.0);  // rad/s: a radian in the frame
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm(0.04 * cornerSide(c, 0), 0.013 * cornerSide(c, 1), 0.009 * cornerSide(c, 2));
    state.position.set(0, c, arm);
    state.velocity.set(0, c, velocity + spin.cross(arm));
  }
  SweptBoxes boxes;
  boxes.resize(1);
  std::vector<double> reach(1);
  constexpr double kDuration_s = 1.0 / 60.0;
  computeSweptBoxes(state, std::vector<std::int32_t>{0}, 0.0, kDuration_s, Way::onwards, margins(1, 0.0), boxes, reach);
  for (int i = 0; i <= 20; ++i) {
    const double time_s = i * kDuration_s / 20.0;
    const Eigen::AngleAxisd turned(spin.z() * time_s, Vec3::UnitZ());
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 corner = velocity * time_s + turned * state.position.at(0, c);
      for (std::size_t a = 0; a < 3; ++a) {
        EXPECT_LE(boxes.lower[a][0], corner[static_cast<Eigen::Index>(a)]);
        EXPECT_GE(boxes.upper[a][0], corner[static_cast<Eigen::Index>(a)]);
      }
    }
  }
  EXPECT_LT(boxes.upper[1][0] - boxes.lower[1][0], 0.21)
      << "along its way alone: speed times duration on all sides are 0.19 m more";
}

TEST(SweptBoxes, WithoutDurationReachJustTheMargin) {
  Random random{SplitMix64(3)};
  const MotionState state = randomMotion(4, random);
  SweptBoxes boxes;
  boxes.resize(4);
  std::vector<double> reach(4);
  computeSweptBoxes(state, std::vector<std::int32_t>{0, 1, 2, 3}, kGravity, 0.0, Way::onwards, margins(4, 0.002), boxes, reach);
  for (std::size_t b = 0; b < 4; ++b) {
    EXPECT_EQ(reach[b], 0.002);
    for (std::size_t a = 0; a < 3; ++a) {
      double least = std::numeric_limits<double>::infinity();
      double most = -least;
      for (std::size_t c = 0; c < kCorners; ++c) {
        least = std::min(least, state.position.values(a, b)[c]);
        most = std::max(most, state.position.values(a, b)[c]);
      }
      EXPECT_EQ(boxes.lower[a][b], least - 0.002);
      EXPECT_EQ(boxes.upper[a][b], most + 0.002);
    }
  }
}

}  // namespace
}  // namespace springtower
