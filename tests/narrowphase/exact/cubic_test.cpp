#include "narrowphase/exact/cubic.h"

#include "core/random.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

using FourPoints = std::array<MovingPoint, 4>;

BernsteinCubic cubicOf(const FourPoints& points) {
  return coplanarityCubic(points[0], points[1], points[2], points[3]);
}

Vec3 randomVector(RandomStream& random, double size) {
  const double x = random.uniform(), y = random.uniform(), z = random.uniform();
  return size * (2.0 * Vec3(x, y, z) - Vec3::Ones());
}

FourPoints randomPoints(RandomStream& random, double size, double motion) {
  FourPoints points;
  for (MovingPoint& point : points) {
    point.start = randomVector(random, size);
    point.end = point.start + randomVector(random, motion);
  }
  return points;
}

/// Whole numbers from -8 to 8: everything made of them is exact in double.
FourPoints randomLatticePoints(RandomStream& random) {
  FourPoints points = randomPoints(random, 8.0, 8.0);
  for (MovingPoint& point : points) {
    point.start = point.start.array().round();
    point.end = point.end.array().round();
  }
  return points;
}

using LongVec3 = Eigen::Matrix<long double, 3, 1>;

/// The determinant at one time with 11 more bits than double has.
long double determinantAt(const FourPoints& points, double time) {
  const auto at = [&](std::size_t i) -> LongVec3 {
    const LongVec3 start = points[i].start.cast<long double>();
    return start + static_cast<long double>(time) * (points[i].end.cast<long double>() - start);
  };
  const LongVec3 origin = at(0);
  return (at(1) - origin).cross(at(2) - origin).dot(at(3) - origin);
}

double valueAt(const std::array<double, 4>& power, double time) {
  return ((power[0] * time + power[1]) * time + power[2]) * time + power[3];
}

// Appendix 1.1 and 1.2 of the report, word for word. Its edges are p1-p2 and p3-p4, its face f1 f2 f3 with the point p.
std::array<double, 4> reportCoefficients(const Vec3& a1, const Vec3& a2, const Vec3& a3, const Vec3& d1, const Vec3& d2,
                                         const Vec3& d3) {
  const Vec3 c1 = d1.cross(d2), c2 = a1.cross(a2), c3 = d1.cross(a2) + a1.cross(d2);
  return {d3.dot(c1), a3.dot(c1) + d3.dot(c3), a3.dot(c3) + d3.dot(c2), a3.dot(c2)};
}

Vec3 velocity(const MovingPoint& point) {
  return point.end - point.start;
}

TEST(Cubic, EqualsTheReportsForPointAndFace) {
  RandomStream random(1, 0);
  for (int n = 0; n < 1000; ++n) {
    const auto [f1, f2, f3, p] = randomLatticePoints(random);
    const std::array<double, 4> report =
        reportCoefficients(f2.start - f1.start, f3.start - f1.start, p.start - f1.start, velocity(f2) - velocity(f1),
                           velocity(f3) - velocity(f1), velocity(p) - velocity(f1));
    const std::array<double, 4> ours = powerCoefficients(coplanarityCubic(f1, f2, f3, p));
    const std::array<double, 4> pointFirst = powerCoefficients(coplanarityCubic(p, f1, f2, f3));
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(ours[i], report[i], 1e-9);
      EXPECT_NEAR(pointFirst[i], -report[i], 1e-9);
    }
  }
}

TEST(Cubic, EqualsTheReportsForTwoEdges) {
  RandomStream random(2, 0);
  for (int n = 0; n < 1000; ++n) {
    const auto [p1, p2, p3, p4] = randomLatticePoints(random);
    const std::array<double, 4> report =
        reportCoefficients(p2.start - p1.start, p4.start - p3.start, p3.start - p1.start, velocity(p2) - velocity(p1),
                           velocity(p4) - velocity(p3), velocity(p3) - velocity(p1));
    const std::array<double, 4> ours = powerCoefficients(coplanarityCubic(p1, p2, p3, p4));
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(ours[i], -report[i], 1e-9);
  }
}

TEST(Cubic, ErrorBoundHoldsAndIsNotLoose) {
  RandomStream random(3, 0);
  double worst = 0.0;
  for (int n = 0; n < 20000; ++n) {
    // Sizes of a block, of a room, far from the origin; slow and fast.
    const double size = n % 2 == 0 ? 0.08 : 5.0;
    FourPoints points = randomPoints(random, size, n % 3 == 0 ? 1e-6 * size : size);
    const Vec3 offset = n % 5 == 0 ? Vec3(10.0, -7.0, 3.0) : Vec3::Zero();
    for (MovingPoint& point : points) {
      point.start += offset;
      point.end += offset;
    }
    const BernsteinCubic cubic = cubicOf(points);
    EXPECT_LT(cubic.error, 1e-11 * size * size * size);
    for (const double time : {0.0, 0.25, 0.5, 0.8125, 1.0}) {
      const double s = 1.0 - time;
      const auto& c = cubic.coefficients;
      const long double value = static_cast<long double>(c[0]) * s * s * s + static_cast<long double>(c[1]) * 3 * s * s * time +
                                static_cast<long double>(c[2]) * 3 * s * time * time +
                                static_cast<long double>(c[3]) * time * time * time;
      const auto error = static_cast<double>(std::abs(value - determinantAt(points, time)));
      worst = std::max(worst, error / cubic.error);
    }
  }
  EXPECT_LT(worst, 1.0);
  EXPECT_GT(worst, 0.01);
}

TEST(Cubic, ErrorDoesNotGrowWithTheOffset) {
  RandomStream random(4, 0);
  FourPoints points = randomPoints(random, 0.08, 0.01);
  const double error = cubicOf(points).error;
  for (MovingPoint& point : points) {
    point.start += Vec3::Constant(1000.0);
    point.end += Vec3::Constant(1000.0);
  }
  EXPECT_NEAR(cubicOf(points).error, error, 1e-6 * error);
}

TEST(Cubic, CullsOnlyWhatHasNoRoot) {
  EXPECT_FALSE(mayVanish({{1.0, 2.0, 0.5, 3.0}, 0.1}));
  EXPECT_FALSE(mayVanish({{-1.0, -2.0, -0.5, -3.0}, 0.1}));
  EXPECT_TRUE(mayVanish({{1.0, 2.0, 0.1, 3.0}, 0.1}));
  EXPECT_TRUE(mayVanish({{1.0, -2.0, 2.0, 3.0}, 0.1}));
  EXPECT_TRUE(mayVanish({{0.0, 0.0, 0.0, 0.0}, 0.0}));
  EXPECT_TRUE(mayVanish({{1.0, 1.0, std::nan(""), 1.0}, 0.1}));
  EXPECT_TRUE(mayVanish({{1e300, 1e300, 1e300, 1e300}, std::numeric_limits<double>::infinity()}));
  RandomStream random(5, 0);
  int culled = 0;
  for (int n = 0; n < 5000; ++n) {
    const FourPoints points = randomPoints(random, 1.0, 0.3);
    if (coplanarityCubicMayVanish(points[0], points[1], points[2], points[3])) continue;
    ++culled;
    const bool positive = determinantAt(points, 0.0) > 0.0L;
    for (int i = 1; i <= 64; ++i) EXPECT_EQ(determinantAt(points, i / 64.0) > 0.0L, positive);
  }
  EXPECT_GT(culled, 1000);
}

BernsteinCubic fromRoots(double first, double second, double third) {
  // The polar form of (t - first) (t - second) (t - third) at (0,0,0), (0,0,1), (0,1,1), (1,1,1).
  const auto polar = [&](double u, double v, double w) {
    const auto product = [&](double x, double y, double z) { return (x - first) * (y - second) * (z - third); };
    return (product(u, v, w) + product(u, w, v) + product(v, u, w) + product(v, w, u) + product(w, u, v) + product(w, v, u)) /
           6.0;
  };
  return {{polar(0, 0, 0), polar(0, 0, 1), polar(0, 1, 1), polar(1, 1, 1)}, 1e-14};
}

TEST(Cubic, PowerFormHasTheRoots) {
  const std::array<double, 4> power = powerCoefficients(fromRoots(0.25, 0.5, 0.75));
  for (const double root : {0.25, 0.5, 0.75}) EXPECT_NEAR(valueAt(power, root), 0.0, 1e-15);
  EXPECT_NEAR(power[0], 1.0, 1e-14);
}

TEST(Cubic, ClippingKeepsEveryRoot) {
  RandomStream random(6, 0);
  for (int n = 0; n < 20000; ++n) {
    std::array<double, 3> roots;
    for (double& root : roots) root = 3.0 * random.uniform() - 1.0;
    if (n % 4 == 0) roots[1] = roots[0];
    TimeInterval part{0.0, 1.0};
    const bool any = clipToRoots(fromRoots(roots[0], roots[1], roots[2]), part);
    EXPECT_GE(part.from, 0.0);
    EXPECT_LE(part.from, part.to);
    EXPECT_LE(part.to, 1.0);
    for (const double root : roots) {
      if (!(root >= 0.0 && root <= 1.0)) continue;
      ASSERT_TRUE(any) << roots[0] << ' ' << roots[1] << ' ' << roots[2];
      EXPECT_LE(part.from, root);
      EXPECT_GE(part.to, root);
    }
  }
}

TEST(Cubic, ClippingConvergesToASimpleRoot) {
  // One clip of an almost straight cubic leaves almost only its root, and a cubic without roots is seen as such.
  TimeInterval part{0.0, 1.0};
  ASSERT_TRUE(clipToRoots(fromRoots(0.3, 40.0, -50.0), part));
  EXPECT_LT(part.to - part.from, 0.03);
  part = {0.0, 1.0};
  EXPECT_FALSE(clipToRoots(fromRoots(1.5, 2.0, -0.5), part));
  EXPECT_EQ(part.from, 0.0);
  EXPECT_EQ(part.to, 1.0);
  // Exactly linear: the root of 3 - 4 t, and of its mirror image.
  ASSERT_TRUE(clipToRoots({{3.0, 5.0 / 3.0, 1.0 / 3.0, -1.0}, 0.0}, part));
  EXPECT_LE(part.from, 0.75);
  EXPECT_GE(part.to, 0.75);
  EXPECT_LT(part.to - part.from, 1e-14);
}

}  // namespace
}  // namespace springtower
