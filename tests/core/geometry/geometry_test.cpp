// Boxes, polygons and sweeps against what can be worked out by hand.
#include "core/geometry/oriented_box.h"
#include "core/geometry/polygon.h"
#include "core/geometry/sweep.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>
#include <vector>

namespace springtower {
namespace {

TEST(OrientedBox, ATurnedCubeReachesItsHalfDiagonal) {
  const Eigen::Quaterniond eighth(Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::UnitZ()));
  const OrientedBox box = orientedBox(Vec3(1.0, 2.0, 3.0), eighth, Vec3::Constant(2.0));
  EXPECT_NEAR(box.reachAlong(Vec3::UnitX()), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR((box.reach() - Vec3(std::sqrt(2.0), std::sqrt(2.0), 1.0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((box.corner(7) - Vec3(1.0, 2.0 + std::sqrt(2.0), 4.0)).norm(), 0.0, 1e-15);
}

TEST(OrientedBox, ParallelEdgesGiveNoDirection) {
  const auto world = [](int i) { return Vec3(Vec3::Unit(i)); };
  int visited = 0;
  forEachEdgeProduct(world, world, 1e-9, [&](int i, int j, const Vec3& axis) {
    EXPECT_NE(i, j);
    EXPECT_NEAR(axis.norm(), 1.0, 1e-15);
    return ++visited > 0;
  });
  EXPECT_EQ(visited, 6);
}

TEST(OrientedBox, EdgeProductsStopWhereTheVisitorHasEnough) {
  const auto world = [](int i) { return Vec3(Vec3::Unit(i)); };
  int visited = 0;
  forEachEdgeProduct(world, world, 1e-9, [&](int, int, const Vec3&) { return ++visited < 2; });
  EXPECT_EQ(visited, 2);
}

TEST(Polygon, ASquareCutThroughItsCornersIsHalfOfIt) {
  using Vec2 = Eigen::Vector2d;
  const std::vector<Vec2> square = {{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  const std::vector<Vec2> half = clippedBy(square, Vec2(1.0, 1.0), 1.0);
  ASSERT_EQ(half.size(), 3U);
  EXPECT_EQ(clippedBy(square, Vec2(1.0, 0.0), -0.1).size(), 0U);
  EXPECT_EQ(clippedBy(square, Vec2(1.0, 0.0), 0.25).size(), 4U);
}

TEST(Sweep, FindsWhatOverlapsOrLiesWithinTheMargin) {
  const std::vector<double> lower = {2.0, 0.0, 1.0};
  const std::vector<double> upper = {3.0, 1.5, 2.0};
  using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
  const auto found = [&](double margin) {
    Pairs pairs;
    forEachOverlap(lower, upper, margin, [&](std::size_t a, std::size_t b) { pairs.emplace_back(a, b); });
    return pairs;
  };
  EXPECT_EQ(found(0.0), (Pairs{{1, 2}})) << "those that only touch do not overlap";
  EXPECT_EQ(found(0.4), (Pairs{{1, 2}, {2, 0}}));
  EXPECT_EQ(found(0.6), (Pairs{{1, 2}, {1, 0}, {2, 0}}));
}

TEST(Sweep, TakesTheAxisAlongWhichPlacesAreSpread) {
  const std::vector<Vec3> row = {Vec3(1e6, 0.0, 0.0), Vec3(1e6 + 0.1, 5.0, 0.0), Vec3(1e6, 10.0, 0.2)};
  EXPECT_EQ(widestAxis(row.size(), [&](std::size_t i) { return row[i]; }), 1);
}

}  // namespace
}  // namespace springtower
