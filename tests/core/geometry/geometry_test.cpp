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

TEST(Polygon, TheHullOfARectangleAndPointsInItAndOnItIsTheRectangle) {
  const Polygon hull = convexHull({{2.0, 1.0}, {0.0, 0.0}, {1.0, 0.0}, {1.0, 0.5}, {0.0, 1.0}, {2.0, 0.0}, {2.0, 0.5}});
  ASSERT_EQ(hull.size(), 4U);
  EXPECT_NEAR(areaMoments(hull).area_m2, 2.0, 1e-15) << "counterclockwise";
  EXPECT_NEAR(leastWidth(hull), 1.0, 1e-15);
  EXPECT_LT(convexHull({{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}}).size(), 3U) << "on a line";
}

// Two unit squares, one turned by an eighth about the common centre: a regular octagon of inradius 1/2.
TEST(Polygon, TheOverlapOfTwoSquaresTurnedByAnEighthIsAnOctagon) {
  const double half = 0.5 * std::sqrt(2.0);
  const Polygon square = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  const Polygon turned = {{0.0, -half}, {half, 0.0}, {0.0, half}, {-half, 0.0}};
  const Polygon octagon = overlapOf(square, turned);
  EXPECT_EQ(octagon.size(), 8U);
  EXPECT_NEAR(areaMoments(octagon).area_m2, 2.0 * (std::sqrt(2.0) - 1.0), 1e-14);
  EXPECT_NEAR(leastWidth(octagon), 1.0, 1e-14);
  EXPECT_TRUE(overlapOf(square, {{2.0, 0.0}, {3.0, 0.0}, {3.0, 1.0}}).empty());
}

// A rectangle a x b has second moments a^2 / 12 and b^2 / 12 per area, about its centre, wherever it lies.
TEST(Polygon, MomentsOfARectangleAreThoseOfTheTextbook) {
  const AreaMoments of = areaMoments({{10.0, 20.0}, {13.0, 20.0}, {13.0, 22.0}, {10.0, 22.0}});
  EXPECT_NEAR(of.area_m2, 6.0, 1e-13);
  EXPECT_NEAR((of.centroid - Eigen::Vector2d(11.5, 21.0)).norm(), 0.0, 1e-13);
  EXPECT_NEAR(of.secondPerArea(0, 0), 9.0 / 12.0, 1e-13);
  EXPECT_NEAR(of.secondPerArea(1, 1), 4.0 / 12.0, 1e-13);
  EXPECT_NEAR(of.secondPerArea(0, 1), 0.0, 1e-13);
  EXPECT_EQ(areaMoments({{0.0, 0.0}, {1.0, 0.0}}).area_m2, 0.0);
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
