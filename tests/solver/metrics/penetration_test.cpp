#include "solver/metrics/penetration.h"

#include "tests/solver/frame/boxes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace springtower {
namespace {

const Vec3 kSides(0.081, 0.0267, 0.0182);
constexpr double kExact = 1e-15;

// The world's axes are among the test axes, so each configuration is also rotated.
std::vector<Eigen::Quaterniond> views() {
  return {Eigen::Quaterniond::Identity(), turned(33.0, {1.0, 2.0, 3.0}), turned(141.0, {-2.0, 0.5, 1.0})};
}

double depthOf(const std::vector<TestBox>& boxes) {
  return overlapDepth(cornersOf(boxes), 0, 1);
}

// A cube of side a whose edge along `along` points to -z or +z, its edge at height z.
TestBox onEdge(double a, const Vec3& along, double edgeHeight, double towards) {
  return {{0.0, 0.0, edgeHeight - towards * a / std::sqrt(2.0)}, {a, a, a}, turned(45.0, along)};
}

TEST(OverlapDepth, FaceOnFaceIsTheOverlapInEveryView) {
  for (const double depth : {1e-9, 1e-5, 1e-3}) {
    const std::vector<TestBox> boxes = {{Vec3::Zero(), kSides},
                                        {{0.01, 0.005, kSides.z() - depth}, kSides, turned(90.0, Vec3::UnitZ())}};
    for (const auto& view : views()) EXPECT_NEAR(depthOf(moved(boxes, view, {0.3, -0.2, 0.5})), depth, kExact);
  }
}

TEST(OverlapDepth, FacesTurnedInTheirPlaneKeepTheirDepth) {
  for (const double degrees : {0.0, 1e-6, 0.01, 17.0, 45.0}) {
    const std::vector<TestBox> boxes = {{Vec3::Zero(), kSides},
                                        {{0.004, 0.002, kSides.z() - 2e-4}, kSides, turned(degrees, Vec3::UnitZ())}};
    for (const auto& view : views()) EXPECT_NEAR(depthOf(moved(boxes, view, Vec3::Zero())), 2e-4, kExact);
  }
}

TEST(OverlapDepth, CrossedEdgesAreMeasuredAlongTheirCommonNormal) {
  const double a = 0.02;
  for (const double depth : {1e-6, 1e-3}) {
    const std::vector<TestBox> boxes = {onEdge(a, Vec3::UnitX(), depth, 1.0), onEdge(a, Vec3::UnitY(), 0.0, -1.0)};
    for (const auto& view : views()) EXPECT_NEAR(depthOf(moved(boxes, view, {0.1, 0.1, 0.1})), depth, kExact);
  }
}

TEST(OverlapDepth, CrossedEdgesThatOnlyTheirCommonNormalSeparatesDoNotOverlap) {
  const double a = 0.02;
  const std::vector<TestBox> boxes = {onEdge(a, Vec3::UnitX(), -1e-6, 1.0), onEdge(a, Vec3::UnitY(), 0.0, -1.0)};
  for (const auto& view : views()) EXPECT_EQ(depthOf(moved(boxes, view, {0.1, 0.1, 0.1})), 0.0);
}

TEST(OverlapDepth, ACornerInAFaceIsMeasuredAlongTheNormalOfTheFace) {
  const double a = 0.02;
  const double depth = 5e-4;
  // A cube balanced on a corner stands sqrt(3) a high.
  const Eigen::Quaterniond balanced = Eigen::Quaterniond::FromTwoVectors(Vec3::Ones(), Vec3::UnitZ());
  const std::vector<TestBox> boxes = {{{0.0, 0.0, -0.5 * kSides.z()}, kSides},
                                      {{0.005, 0.001, 0.5 * std::sqrt(3.0) * a - depth}, {a, a, a}, balanced}};
  for (const auto& view : views()) EXPECT_NEAR(depthOf(moved(boxes, view, Vec3::Zero())), depth, kExact);
}

TEST(OverlapDepth, TouchingAndSeparateBlocksDoNotOverlap) {
  const std::vector<TestBox> touching = {{Vec3::Zero(), {1.0, 1.0, 1.0}}, {{0.25, 0.0, 1.0}, {1.0, 1.0, 1.0}}};
  EXPECT_EQ(depthOf(touching), 0.0);
  const std::vector<TestBox> apart = {{Vec3::Zero(), kSides}, {{0.0, kSides.y() + 1e-9, 0.0}, kSides}};
  for (const auto& view : views()) EXPECT_EQ(depthOf(moved(apart, view, Vec3::Zero())), 0.0);
}

TEST(OverlapDepth, ABlockInsideAnotherMustLeaveThroughTheNearestFace) {
  const std::vector<TestBox> boxes = {{Vec3::Zero(), {1.0, 1.0, 1.0}}, {{0.3, 0.0, 0.0}, {0.2, 0.2, 0.2}}};
  for (const auto& view : views()) EXPECT_NEAR(depthOf(moved(boxes, view, Vec3::Zero())), 0.3, 1e-14);
}

TEST(OverlapDepth, DeformationCountsInFull) {
  // One lower corner of the upper block hangs down: its fitted cuboid would miss three quarters of that.
  const std::vector<TestBox> boxes = {{Vec3::Zero(), kSides}, {{0.0, 0.0, kSides.z()}, kSides}};
  ParticleArray position = cornersOf(boxes);
  position.add(1, 0, {0.0, 0.0, -1e-4});
  EXPECT_NEAR(overlapDepth(position, 0, 1), 1e-4, 1e-9);
}

TEST(OverlapDepth, MayStopEarlyOnceThePairIsNotWorthIt) {
  const std::vector<TestBox> boxes = {{Vec3::Zero(), kSides}, {{0.0, 0.0, kSides.z() - 1e-4}, kSides}};
  const ParticleArray position = cornersOf(boxes);
  EXPECT_NEAR(overlapDepth(position, 0, 1, 0.99e-4), 1e-4, kExact);
  EXPECT_LE(overlapDepth(position, 0, 1, 1.01e-4), 1.01e-4);
}

TEST(MaxPenetration, OfNothingIsNone) {
  PenetrationWorkspace workspace;
  const Penetration none = maxPenetration(ParticleArray{}, true, workspace);
  EXPECT_EQ(none.depth, 0.0);
  EXPECT_EQ(none.first, kFloor);
}

TEST(MaxPenetration, NamesTheLowestCornerBelowTheFloor) {
  const std::vector<TestBox> boxes = {{{0.0, 0.0, 0.5 * kSides.z() - 1e-5}, kSides},
                                      {{1.0, 0.0, 0.5 * kSides.z()}, kSides, turned(2.0, Vec3::UnitX())}};
  const ParticleArray position = cornersOf(boxes);
  double lowest = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) lowest = std::min(lowest, position.at(1, c).z());
  PenetrationWorkspace workspace;
  const Penetration deepest = maxPenetration(position, true, workspace);
  EXPECT_EQ(deepest.depth, -lowest);
  EXPECT_EQ(deepest.first, blockId(1));
  EXPECT_EQ(deepest.second, kFloor);
  EXPECT_EQ(maxPenetration(position, false, workspace).depth, 0.0);
}

TEST(MaxPenetration, NamesThePairThatOverlapsMost) {
  std::vector<TestBox> boxes(4, {Vec3(0.0, 0.0, 0.5 * kSides.z()), kSides});
  for (std::size_t i = 1; i < 4; ++i) boxes[i].centre.z() = boxes[i - 1].centre.z() + kSides.z() - 1e-5;
  boxes[3].centre.z() -= 3e-5;
  PenetrationWorkspace workspace;
  const Penetration deepest = maxPenetration(cornersOf(boxes), true, workspace);
  EXPECT_NEAR(deepest.depth, 4e-5, kExact);
  EXPECT_EQ(deepest.first, blockId(2));
  EXPECT_EQ(deepest.second, blockId(3));
}

// Against all pairs, on a moving cloud of blocks, with one workspace throughout and with a new one.
TEST(MaxPenetration, FindsTheDeepestOfAllPairsWhileBlocksMove) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto anyVector = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  std::vector<TestBox> boxes;
  std::vector<Vec3> velocity;
  for (int i = 0; i < 60; ++i) {
    const Vec3 spread(0.25, 0.15, 0.1);
    boxes.push_back({anyVector().cwiseProduct(spread), kSides, turned(180.0 * uniform(random), anyVector())});
    velocity.push_back(0.02 * anyVector().cwiseProduct(Vec3(0.2, 0.2, 3.0)));
  }
  PenetrationWorkspace kept;
  int overlapping = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const ParticleArray position = cornersOf(boxes);
    Penetration expected;
    for (std::size_t a = 0; a < boxes.size(); ++a) {
      for (std::size_t b = a + 1; b < boxes.size(); ++b) {
        const double depth = overlapDepth(position, a, b);
        if (depth > 0.0) ++overlapping;
        if (depth > expected.depth) expected = {depth, blockId(a), blockId(b)};
      }
    }
    const Penetration found = maxPenetration(position, false, kept);
    EXPECT_EQ(found.depth, expected.depth) << "frame " << frame;
    EXPECT_EQ(found.first, expected.first);
    EXPECT_EQ(found.second, expected.second);
    PenetrationWorkspace fresh;
    EXPECT_EQ(maxPenetration(position, false, fresh).depth, found.depth);
    for (std::size_t b = 0; b < boxes.size(); ++b) boxes[b].centre += velocity[b];
  }
  EXPECT_GT(overlapping, 100);
}

}  // namespace
}  // namespace springtower
