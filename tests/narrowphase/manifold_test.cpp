// Overlaps of faces as contact points.
#include "narrowphase/manifold.h"

#include "core/state.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

namespace springtower {
namespace {

constexpr double kLength_m = 0.08;
constexpr double kWidth_m = 0.025;
constexpr double kHeight_m = 0.018;
constexpr ManifoldLimits kLimits{1e-2 * kHeight_m, 0.05 * kHeight_m};
constexpr int kTop = 5;     // face of the largest z
constexpr int kBottom = 4;  // and of the smallest

// Two blocks of one size, the second lying on the first, rotated about the vertical and shifted.
Manifold manifoldOf(double turn_rad, const Vec3& shift_m, const ManifoldLimits& limits = kLimits) {
  ParticleArray position;
  position.resize(2);
  const Eigen::AngleAxisd turn(turn_rad, Vec3::UnitZ());
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 corner((c & 1U) != 0 ? 0.5 * kLength_m : -0.5 * kLength_m, (c & 2U) != 0 ? 0.5 * kWidth_m : -0.5 * kWidth_m,
                      (c & 4U) != 0 ? 0.5 * kHeight_m : -0.5 * kHeight_m);
    position.set(0, c, corner);
    position.set(1, c, turn * corner + shift_m + Vec3(0.0, 0.0, kHeight_m));
  }
  Manifold manifold;
  manifold.upper = 1;
  manifold.lower = 0;
  buildFaceManifold(cornersOf(position, 1), cornersOf(position, 0), kBottom, kTop, limits, manifold);
  return manifold;
}

// Flush blocks are never flush to the last bit. Where coinciding sides cross by rounding only, or by micrometres, their crossing
// must not be a point: it would appear and vanish, and the load with it.
TEST(Manifold, FlushSidesGiveTheCornersAlone) {
  for (const double turn_rad : {0.0, 1e-15, -1e-12, 1e-9, 1e-6, -1e-5, 1e-4}) {
    for (const double shift_m : {0.0, 1e-17, 1e-9, -1e-7}) {
      EXPECT_EQ(manifoldOf(turn_rad, Vec3(shift_m, shift_m, 0.0)).count, 4) << turn_rad << " rad, " << shift_m << " m";
    }
  }
}

// Each side of one face crosses two sides of the other, at points where the boundary is bent by more than the limit for straight
// edges.
TEST(Manifold, TurnedSidesCrossInEightPoints) {
  EXPECT_EQ(manifoldOf(0.01, Vec3::Zero()).count, 8);
  EXPECT_EQ(manifoldOf(0.2, Vec3::Zero()).count, 8);
  EXPECT_EQ(manifoldOf(0.5 * std::numbers::pi, Vec3::Zero()).count, 4) << "across";
}

// m, on the incident face, whose first side is the block's width.
Eigen::Vector2d pointOf(const Manifold& m, std::size_t point) {
  const PlaceRow& row = m.place[rowOf(point)];
  return {kWidth_m * row.u[laneOf(point)], kLength_m * row.v[laneOf(point)]};
}

// m, distance of a point from the boundary of a manifold's polygon.
double distanceToBorder(const Eigen::Vector2d& point, const Manifold& m) {
  double least = std::numeric_limits<double>::infinity();
  const auto count = static_cast<std::size_t>(m.count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d from = pointOf(m, i);
    const Eigen::Vector2d side = pointOf(m, i + 1 == count ? 0 : i + 1) - from;
    const double share = std::clamp((point - from).dot(side) / side.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (point - from - share * side).norm());
  }
  return least;
}

// A side that crosses another at a small angle bends the boundary there by half the width or length times that angle, slightly
// less where it is longer: it counts as straight up to 9 micrometres.
TEST(Manifold, ABendOfATwentiethOfTheRadiusIsStraight) {
  const double bend_rad = 0.05 * kLimits.mergeRadius / (0.5 * kLength_m);
  EXPECT_EQ(manifoldOf(0.8 * bend_rad, Vec3::Zero()).count, 4);
  EXPECT_GT(manifoldOf(4.0 * bend_rad, Vec3::Zero()).count, 4);
}

// Every point of the overlap is within the merge radius, plus a twentieth for straight edges, of the remaining boundary.
TEST(Manifold, ItsPointsSpanTheOverlap) {
  const Vec3 shift_m(0.003, 0.002, 0.0);
  for (double turn_rad = 0.0; turn_rad < 1.5; turn_rad += 0.0007) {
    const Manifold kept = manifoldOf(turn_rad, shift_m);
    const Manifold all = manifoldOf(turn_rad, shift_m, {1e-12, kLimits.reach});
    ASSERT_GE(kept.count, 3);
    ASSERT_GE(all.count, kept.count);
    for (std::size_t i = 0; i < static_cast<std::size_t>(all.count); ++i)
      EXPECT_LT(distanceToBorder(pointOf(all, i), kept), 1.05 * kLimits.mergeRadius) << turn_rad << " rad, point " << i;
  }
}

}  // namespace
}  // namespace springtower
