// Elementary functions against long double arithmetic, whose 64 bits are 11 more than theirs: it is itself off by less than a
// thousandth of a unit in the last place of a double.
#include "core/elementary.h"

#include "core/hash.h"
#include "core/random.h"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

namespace springtower {
namespace {

static_assert(LDBL_MANT_DIG >= 64, "the reference needs 64 bits");

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kDraws = 200000;

// Unit in the last place of the double nearest to a value.
long double ulpOf(long double value) {
  int exponent = 0;
  std::frexp(static_cast<double>(value), &exponent);
  return std::ldexp(1.0L, std::max(exponent - DBL_MANT_DIG, DBL_MIN_EXP - DBL_MANT_DIG));
}

double errorOf(double found, long double exact) {
  return static_cast<double>(std::abs(found - exact) / ulpOf(exact));
}

enum class Spacing { even, logarithmic };

// The largest error of a function over arguments drawn from a range, ulp.
template <class Function, class Reference>
double largestError(const Function& function, const Reference& reference, double least, double most,
                    Spacing spacing = Spacing::even) {
  RandomStream random(1, 0);
  double largest = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const double share = random.uniform();
    const double value = spacing == Spacing::even ? least + (most - least) * share
                                                  : std::exp2(std::log2(least) + (std::log2(most) - std::log2(least)) * share);
    const double error = errorOf(function(value), reference(static_cast<long double>(value)));
    if (!(error <= largest)) largest = error;
  }
  return largest;
}

long double sine(long double x) {
  return std::sin(x);
}
long double cosine(long double x) {
  return std::cos(x);
}
long double tangent(long double x) {
  return std::tan(x);
}

TEST(Elementary, SineAndCosineAreWithinAUnit) {
  for (const double most : {0.8, 10.0, 1e4, elementary::kMaxAngle_rad}) {
    EXPECT_LE(largestError(elementary::sin, sine, -most, most), 1.0) << most;
    EXPECT_LE(largestError(elementary::cos, cosine, -most, most), 1.0) << most;
  }
  EXPECT_LE(largestError(elementary::sin, sine, 1e-300, 1.0, Spacing::logarithmic), 1.0);
}

// The doubles next to multiples of pi / 2, where all but the last bits of the angle cancel.
TEST(Elementary, SineAndCosineAreWithinAUnitBesideTheirZeros) {
  for (std::int64_t multiple = 1; multiple < 600000000; multiple += multiple / 64 + 1) {
    const double angle = static_cast<double>(multiple) * (0.5 * std::numbers::pi);
    if (angle > elementary::kMaxAngle_rad) break;
    EXPECT_LE(errorOf(elementary::sin(angle), sine(angle)), 1.0) << multiple;
    EXPECT_LE(errorOf(elementary::cos(angle), cosine(angle)), 1.0) << multiple;
  }
}

TEST(Elementary, TangentIsWithinThree) {
  EXPECT_LE(largestError(elementary::tan, tangent, -2.0, 2.0), 3.0);
  EXPECT_LE(largestError(elementary::tan, tangent, -1e4, 1e4), 3.0);
}

TEST(Elementary, AnglesBeyondTheRangeAreRefused) {
  for (const double angle : {1.1 * elementary::kMaxAngle_rad, -kInfinity, kInfinity, std::nan("")}) {
    EXPECT_TRUE(std::isnan(elementary::sin(angle)));
    EXPECT_TRUE(std::isnan(elementary::cos(angle)));
    EXPECT_TRUE(std::isnan(elementary::tan(angle)));
  }
}

TEST(Elementary, InverseTangentsAreWithinTwo) {
  const auto reference = [](long double x) { return std::atan(x); };
  EXPECT_LE(largestError(elementary::atan, reference, -1.5, 1.5), 2.0);
  EXPECT_LE(largestError(elementary::atan, reference, 1e-300, 1e300, Spacing::logarithmic), 2.0);
  EXPECT_EQ(elementary::atan(kInfinity), 0.5 * std::numbers::pi);
  EXPECT_EQ(elementary::atan(-kInfinity), -0.5 * std::numbers::pi);
}

TEST(Elementary, AnglesOfDirectionsAreWithinTwo) {
  RandomStream random(2, 0);
  for (int draw = 0; draw < kDraws; ++draw) {
    const double x = std::ldexp(random.uniform() - 0.5, static_cast<int>(60.0 * random.uniform()) - 30);
    const double y = random.uniform() - 0.5;
    ASSERT_LE(errorOf(elementary::atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x))), 2.0)
        << y << ' ' << x;
  }
}

// As the standard library has them, signs of zeros included.
TEST(Elementary, AnglesAlongTheAxesAreExact) {
  for (const double y : {0.0, -0.0, 1.0, -1.0, 1e-310, -1e-310, 1e308}) {
    for (const double x : {0.0, -0.0, 2.0, -2.0, 1e-310, -1e-310, -1e308}) {
      if (y != 0.0 && x != 0.0) continue;
      EXPECT_EQ(elementary::atan2(y, x), std::atan2(y, x)) << y << ' ' << x;
      EXPECT_EQ(std::signbit(elementary::atan2(y, x)), std::signbit(y)) << y << ' ' << x;
    }
  }
}

TEST(Elementary, InverseCosineIsWithinThree) {
  const auto reference = [](long double x) { return std::acos(x); };
  EXPECT_LE(largestError(elementary::acos, reference, -1.0, 1.0), 3.0);
  EXPECT_LE(largestError(elementary::acos, reference, 0.9999, 1.0), 3.0);
  EXPECT_EQ(elementary::acos(1.0), 0.0);
  EXPECT_EQ(elementary::acos(-1.0), std::numbers::pi);
  EXPECT_TRUE(std::isnan(elementary::acos(1.0000001)));
}

TEST(Elementary, ExponentialIsWithinAUnit) {
  const auto reference = [](long double x) { return std::exp(x); };
  for (const double most : {1e-6, 1.0, 700.0}) EXPECT_LE(largestError(elementary::exp, reference, -most, most), 1.0) << most;
  EXPECT_EQ(elementary::exp(0.0), 1.0);
  EXPECT_EQ(elementary::exp(-746.0), 0.0);
  EXPECT_EQ(elementary::exp(-kInfinity), 0.0);
  EXPECT_EQ(elementary::exp(710.0), kInfinity);
}

TEST(Elementary, LogarithmIsWithinThree) {
  const auto reference = [](long double x) { return std::log2(x); };
  EXPECT_LE(largestError(elementary::log2, reference, 0.999, 1.001), 3.0);
  EXPECT_LE(largestError(elementary::log2, reference, 0.1, 10.0), 3.0);
  EXPECT_LE(largestError(elementary::log2, reference, 1e-300, 1e300, Spacing::logarithmic), 3.0);
  for (int exponent = -1074; exponent < 1024; ++exponent) EXPECT_EQ(elementary::log2(std::ldexp(1.0, exponent)), exponent);
  EXPECT_EQ(elementary::log2(0.0), -kInfinity);
  EXPECT_EQ(elementary::log2(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(elementary::log2(-1.0)));
}

TEST(Elementary, CubeRootIsWithinAUnit) {
  const auto reference = [](long double x) { return std::cbrt(x); };
  EXPECT_LE(largestError(elementary::cbrt, reference, -10.0, 10.0), 1.0);
  EXPECT_LE(largestError(elementary::cbrt, reference, 1e-300, 1e300, Spacing::logarithmic), 1.0);
  for (const double root : {0.0, 1.0, -3.0, 1e5, 0x1p-100}) EXPECT_EQ(elementary::cbrt(root * root * root), root);
  EXPECT_EQ(elementary::cbrt(-kInfinity), -kInfinity);
}

TEST(Elementary, LengthIsWithinTwo) {
  RandomStream random(3, 0);
  for (const double scale : {1e-300, 1.0, 1e300}) {
    for (int draw = 0; draw < kDraws / 10; ++draw) {
      const double x = scale * (random.uniform() - 0.5);
      const double y = scale * (random.uniform() - 0.5);
      ASSERT_LE(errorOf(elementary::hypot(x, y), std::hypot(static_cast<long double>(x), static_cast<long double>(y))), 2.0)
          << x << ' ' << y;
    }
  }
  EXPECT_EQ(elementary::hypot(-3.0, 4.0), 5.0);
  EXPECT_EQ(elementary::hypot(0.0, 0.0), 0.0);
  EXPECT_EQ(elementary::hypot(-kInfinity, 1.0), kInfinity);
}

// Bits that every machine has: a build whose compiler contracts or reorders would have others.
TEST(Elementary, BitsAreTheseEverywhere) {
  Hash hash;
  RandomStream random(4, 0);
  const auto mix = [&](double value) { hash.word(std::bit_cast<std::uint64_t>(value)); };
  for (int draw = 0; draw < 10000; ++draw) {
    const double x = 20.0 * random.uniform() - 10.0;
    const double y = random.uniform();
    for (const auto function :
         {elementary::sin, elementary::cos, elementary::tan, elementary::atan, elementary::exp, elementary::cbrt})
      mix(function(x));
    mix(elementary::acos(y));
    mix(elementary::log2(y));
    mix(elementary::atan2(x, y - 0.5));
    mix(elementary::hypot(x, y));
  }
  EXPECT_EQ(hash.value(), 0xde2363e4b5ef0bfaU);
}

}  // namespace
}  // namespace springtower
