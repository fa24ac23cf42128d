// Points at which two blocks may touch after a short way.
#include "narrowphase/near_points.h"

#include "core/state.h"
#include "tests/support/random.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace springtower {
namespace {

const Vec3 kBrick_m(0.075, 0.025, 0.015);
constexpr double kMerge_m = 1e-5;

struct Pose {
  Vec3 centre = Vec3::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
};

ParticleArray cornersAt(const Pose& a, const Pose& b) {
  ParticleArray position;
  position.resize(2);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 corner = 0.5 * Vec3(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2)).cwiseProduct(kBrick_m);
    position.set(0, c, a.centre + a.turn * corner);
    position.set(1, c, b.centre + b.turn * corner);
  }
  return position;
}

NearPoints nearPointsOf(const ParticleArray& position, double reach) {
  const CornerView a = cornersOf(position, 0);
  const CornerView b = cornersOf(position, 1);
  NearPoints points;
  findNearPoints(a, b, findSeparation(a, b), Vec3(0.0, 0.0, -9.81), reach, kMerge_m, points);
  return points;
}

double gapOf(const NearPoint& point) {
  return point.normal.dot(point.onA - point.onB);
}

Eigen::Quaterniond quarterTurn() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitZ()));
}

// A brick across another has the four corners of their overlap, on both faces.
TEST(NearPoints, OfCrossedBricksAreTheCornersOfTheOverlap) {
  const double gap_m = 1e-4;
  const NearPoints points = nearPointsOf(cornersAt({Vec3(0.0, 0.0, kBrick_m.z() + gap_m), quarterTurn()}, {}), 1e-3);
  ASSERT_EQ(points.count, 4U);
  for (std::size_t i = 0; i < points.count; ++i) {
    EXPECT_NEAR(gapOf(points.point[i]), gap_m, 1e-12);
    EXPECT_NEAR(points.point[i].normal.z(), 1.0, 1e-12);
    EXPECT_NEAR(std::abs(points.point[i].onB.x()), 0.5 * kBrick_m.y(), 1e-9);
    EXPECT_NEAR(std::abs(points.point[i].onB.y()), 0.5 * kBrick_m.y(), 1e-9);
  }
}

TEST(NearPoints, FartherThanTheReachAreLeftOut) {
  const Pose above{Vec3(0.0, 0.0, kBrick_m.z() + 1.1e-3), quarterTurn()};
  EXPECT_EQ(nearPointsOf(cornersAt(above, {}), 1e-3).count, 0U);
  EXPECT_EQ(nearPointsOf(cornersAt(above, {}), 1.2e-3).count, 4U);
  // Tilted about its long axis by 0.1 rad, one side is 2.5 mm higher than the other.
  const Pose tilted{Vec3(0.0, 0.0, kBrick_m.z() + 1.4e-3), Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Vec3::UnitX()))};
  const NearPoints low = nearPointsOf(cornersAt(tilted, {}), 1e-3);
  ASSERT_GT(low.count, 0U);
  for (std::size_t i = 0; i < low.count; ++i) EXPECT_LE(gapOf(low.point[i]), 1e-3);
}

// A brick beside another of the same height, whose sides are apart: it may slide over, and nothing is in its way.
TEST(NearPoints, SidesThatPassOneAnotherHaveNone) {
  const double apart_m = 2e-3;
  EXPECT_EQ(nearPointsOf(cornersAt({Vec3(0.0, kBrick_m.y() + apart_m, 0.0), {1, 0, 0, 0}}, {}), 1e-3).count, 0U);
}

TEST(NearPoints, OfTheFloorAreTheLowCorners) {
  const ParticleArray position =
      cornersAt({Vec3(0.0, 0.0, 0.5 * kBrick_m.z() + 1.5e-3), Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Vec3::UnitX()))}, {});
  NearPoints points;
  findNearFloorPoints(cornersOf(position, 0), 1e-3, points);
  ASSERT_EQ(points.count, 2U) << "of the lower long side";
  for (std::size_t i = 0; i < 2; ++i) EXPECT_LT(gapOf(points.point[i]), 1e-3);
}

// The overlap after a small rigid motion of both blocks is seen by a point, as fixed to its blocks: what no point sees is of
// second order in the motion over the sizes of the blocks. 2000 pairs at random, apart at first.
TEST(NearPoints, SeeTheOverlapAfterASmallMotion) {
  Random random{SplitMix64(11)};
  const auto vector = [&](double size) {
    const double x = random.between(-size, size);
    const double y = random.between(-size, size);
    return Vec3(x, y, random.between(-size, size));
  };
  const double way_m = 1e-3;  // of a corner, at most, of each block
  const double radius_m = 0.5 * kBrick_m.norm();
  int overlapping = 0;
  double worst_m = 0.0;
  for (int trial = 0; trial < 40000; ++trial) {
    const Pose a{Vec3::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd{random.between(0.0, 3.0), vector(1.0).normalized()})};
    const Pose b{vector(0.05), Eigen::Quaterniond(Eigen::AngleAxisd{random.between(0.0, 3.0), vector(1.0).normalized()})};
    const ParticleArray before = cornersAt(a, b);
    const double apart = findSeparation(cornersOf(before, 0), cornersOf(before, 1)).best();
    if (apart < 0.0 || apart > way_m) continue;
    const auto moved = [&](const Pose& from) {
      const Vec3 turn = vector(0.25 * way_m / radius_m);
      return Pose{from.centre + vector(0.4 * way_m),
                  Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * from.turn};
    };
    const Pose movedA = moved(a);
    const Pose movedB = moved(b);
    const ParticleArray after = cornersAt(movedA, movedB);
    const double depth = -findSeparation(cornersOf(after, 0), cornersOf(after, 1)).best();
    if (depth < 0.05 * way_m) continue;
    ++overlapping;
    const NearPoints points = nearPointsOf(before, 2.0 * way_m);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.count; ++i) {
      const NearPoint& point = points.point[i];
      const Vec3 onA = movedA.centre + movedA.turn * (a.turn.inverse() * (point.onA - a.centre));
      const Vec3 onB = movedB.centre + movedB.turn * (b.turn.inverse() * (point.onB - b.centre));
      const Vec3 normal = point.normalOf == NormalOf::a ? movedA.turn * (a.turn.inverse() * point.normal)
                                                        : movedB.turn * (b.turn.inverse() * point.normal);
      least = std::min(least, normal.dot(onA - onB));
    }
    worst_m = std::max(worst_m, depth + least);
  }
  EXPECT_GT(overlapping, 100);
  EXPECT_LT(worst_m, 0.2 * way_m);
}

// The same points whichever block is named first: of faces that are alike, as those of bricks that lie flat on one another or
// lean by a rounding error, those over the higher block's. 1000 pairs at random.
TEST(NearPoints, AreTheSameWhicheverBlockIsNamedFirst) {
  Random random{SplitMix64(12)};
  const auto leaning = [&](double most) {
    const Eigen::Quaterniond yaw(Eigen::AngleAxisd(random.between(0.0, 6.0), Vec3::UnitZ()));
    return Pose{Vec3{random.between(-0.02, 0.02), random.between(-0.02, 0.02), 0.0},
                Eigen::Quaterniond(Eigen::AngleAxisd(random.between(-most, most), Vec3::UnitX())) * yaw};
  };
  int compared = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const double lean = std::pow(10.0, random.between(-15.0, 0.0));
    Pose upper = leaning(lean);
    const Pose lower = leaning(lean);
    upper.centre.z() += kBrick_m.z() + random.between(-2e-4, 2e-4);
    const NearPoints one = nearPointsOf(cornersAt(upper, lower), 1e-3);
    const NearPoints other = nearPointsOf(cornersAt(lower, upper), 1e-3);
    ASSERT_EQ(one.count, other.count) << "trial " << trial;
    compared += one.count > 0 ? 1 : 0;
    for (std::size_t i = 0; i < one.count; ++i) {
      const NearPoint& point = one.point[i];
      const bool found = std::any_of(other.point.begin(), other.point.begin() + other.count, [&](const NearPoint& same) {
        return (same.onB - point.onA).norm() < 1e-12 && (same.onA - point.onB).norm() < 1e-12 &&
               (same.normal + point.normal).norm() < 1e-12;
      });
      EXPECT_TRUE(found) << "trial " << trial << ", point " << i;
    }
  }
  EXPECT_GT(compared, 900);
}

}  // namespace
}  // namespace springtower
