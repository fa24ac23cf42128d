#include "core/elementary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace springtower::elementary {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A number as the sum of two: `high` is the sum rounded, `low` what is left.
struct Twofold {
  double high;
  double low;
};

// Exactly a + b (Knuth 1969, The Art of Computer Programming 2, 4.2.2).
Twofold sumOf(double a, double b) {
  const double sum = a + b;
  const double ofB = sum - a;
  return {sum, (a - (sum - ofB)) + (b - ofB)};
}

// Exactly a * b, without a fused multiplication (Dekker 1971, A floating-point technique for extending the available precision).
// Precondition: |a|, |b| in 1e-140 .. 1e150, or zero.
Twofold productOf(double a, double b) {
  constexpr double kSplitter = 134217729.0;  // 2^27 + 1
  const double scaledA = kSplitter * a;
  const double scaledB = kSplitter * b;
  const double highA = scaledA - (scaledA - a);
  const double highB = scaledB - (scaledB - b);
  const double lowA = a - highA;
  const double lowB = b - highB;
  const double product = a * b;
  return {product, ((highA * highB - product) + highA * lowB + lowA * highB) + lowA * lowB};
}

// Sum of coefficient[i] x^i (Horner's scheme).
template <std::size_t kCount>
double polynomial(const std::array<double, kCount>& coefficient, double x) {
  double sum = coefficient[kCount - 1];
  for (std::size_t i = kCount - 1; i-- > 0;) sum = sum * x + coefficient[i];
  return sum;
}

// Taylor's coefficients: what is left out is less than 2^-60 of the sum where each is used.
constexpr std::array kSine = {-1.0 / 6.0,        1.0 / 120.0,        -1.0 / 5040.0,          1.0 / 362880.0,
                              -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368000.0, 1.0 / 355687428096000.0};
constexpr std::array kCosine = {1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,          -1.0 / 3628800.0,
                                1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0, -1.0 / 6402373705728000.0};
constexpr std::array kArcTangent = {-1.0 / 3.0, 1.0 / 5.0, -1.0 / 7.0, 1.0 / 9.0, -1.0 / 11.0, 1.0 / 13.0};
constexpr std::array kExponential = {1.0 / 2.0,       1.0 / 6.0,        1.0 / 24.0,        1.0 / 120.0,
                                     1.0 / 720.0,     1.0 / 5040.0,     1.0 / 40320.0,     1.0 / 362880.0,
                                     1.0 / 3628800.0, 1.0 / 39916800.0, 1.0 / 479001600.0, 1.0 / 6227020800.0};
constexpr std::array kAreaTangent = {1.0 / 3.0,  1.0 / 5.0,  1.0 / 7.0,  1.0 / 9.0,  1.0 / 11.0,
                                     1.0 / 13.0, 1.0 / 15.0, 1.0 / 17.0, 1.0 / 19.0, 1.0 / 21.0};

// An angle within pi / 4 of a multiple of pi / 2.
struct Reduced {
  Twofold rest;
  unsigned quarter;  // the multiple, modulo 4
};

// Precondition: |angle| <= kMaxAngle_rad.
Reduced reduce(double angle) {
  // pi / 2 in parts of at most 23 bits and one of 53: the products with a multiple of 30 bits are exact but for the last.
  constexpr std::array kHalfPi = {0x1.921fb4p+0, 0x1.4442dp-24, 0x1.84698p-48, 0x1.3198ap-69, 0x1.701b839a25205p-92};
  constexpr double kPerHalfPi = 0x1.45f306dc9c883p-1;
  const double multiple = std::floor(angle * kPerHalfPi + 0.5);
  Twofold rest{angle, 0.0};
  for (const double part : kHalfPi) {
    const Twofold sum = sumOf(rest.high, -multiple * part);
    rest = {sum.high, rest.low + sum.low};
  }
  return {sumOf(rest.high, rest.low), static_cast<unsigned>(static_cast<std::int64_t>(multiple)) & 3U};
}

double sineOf(const Twofold& angle) {
  const double square = angle.high * angle.high;
  const double beyond = angle.high * square * polynomial(kSine, square);
  return angle.high + (beyond + angle.low * (1.0 - 0.5 * square));
}

double cosineOf(const Twofold& angle) {
  const double square = angle.high * angle.high;
  const double half = 0.5 * square;
  const double first = 1.0 - half;
  // (1 - first) - half is exactly what `first` was rounded by.
  return first + (((1.0 - first) - half) + (square * square * polynomial(kCosine, square) - angle.high * angle.low));
}

double sineOfQuarter(const Reduced& angle, unsigned quarters) {
  const unsigned quarter = (angle.quarter + quarters) & 3U;
  const double value = (quarter & 1U) != 0U ? cosineOf(angle.rest) : sineOf(angle.rest);
  return (quarter & 2U) != 0U ? -value : value;
}

bool isAngle(double angle) {
  return std::abs(angle) <= kMaxAngle_rad;
}

// The angle whose tangent is `opposite` / `adjacent`, in [0, pi / 4], in two parts. Precondition: 0 <= opposite <= adjacent,
// adjacent > 0.
Twofold angleOf(double opposite, double adjacent) {
  // Inverse tangents of i / 8, rounded, and what they were rounded by.
  constexpr std::array<Twofold, 9> kAngle = {{{0.0, 0.0},
                                              {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
                                              {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                              {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
                                              {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                              {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
                                              {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                              {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
                                              {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}}};
  const double nearest = std::floor(8.0 * (opposite / adjacent) + 0.5);
  const double slope = 0.125 * nearest;
  const double tangent = (opposite - slope * adjacent) / (adjacent + slope * opposite);
  const double square = tangent * tangent;
  const Twofold& known = kAngle[static_cast<std::size_t>(nearest)];
  return sumOf(known.high, tangent + (tangent * square * polynomial(kArcTangent, square) + known.low));
}

// `whole` - `angle`.
double lessThan(const Twofold& whole, const Twofold& angle) {
  const Twofold difference = sumOf(whole.high, -angle.high);
  return difference.high + (difference.low + (whole.low - angle.low));
}

}  // namespace

double sin(double angle) {
  return isAngle(angle) ? sineOfQuarter(reduce(angle), 0) : kNan;
}

double cos(double angle) {
  return isAngle(angle) ? sineOfQuarter(reduce(angle), 1) : kNan;
}

double tan(double angle) {
  if (!isAngle(angle)) return kNan;
  const Reduced reduced = reduce(angle);
  return sineOfQuarter(reduced, 0) / sineOfQuarter(reduced, 1);
}

double atan(double tangent) {
  return std::isnan(tangent) ? kNan : atan2(tangent, 1.0);
}

double atan2(double y, double x) {
  constexpr Twofold kHalfPi{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
  constexpr Twofold kPi{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
  const double up = std::abs(y);
  const double along = std::abs(x);
  if (!(up <= kInfinity && along <= kInfinity) || std::min(up, along) == kInfinity) return kNan;
  const double larger = std::max(up, along);
  Twofold angle{0.0, 0.0};  // of (larger, smaller)
  if (larger > 0.0 && larger < kInfinity) {
    // Neither sums nor products of the two may overflow or lose bits.
    const double scale = larger > 1.0 ? 0x1p-512 : 0x1p+500;
    const bool isFar = larger > 0x1p+500 || larger < 0x1p-500;
    angle = angleOf(std::min(up, along) * (isFar ? scale : 1.0), larger * (isFar ? scale : 1.0));
  }
  const bool isBack = std::signbit(x);
  double result = 0.0;
  if (up > along) {
    result = isBack ? lessThan(kHalfPi, {-angle.high, -angle.low}) : lessThan(kHalfPi, angle);
  } else {
    result = isBack ? lessThan(kPi, angle) : angle.high + angle.low;
  }
  return std::copysign(result, y);
}

double acos(double cosine) {
  if (!(std::abs(cosine) <= 1.0)) return kNan;
  return 2.0 * atan2(std::sqrt(1.0 - cosine), std::sqrt(1.0 + cosine));
}

double exp(double power) {
  constexpr double kLeast = -746.0;
  constexpr double kMost = 710.0;
  constexpr double kPerLn2 = 0x1.71547652b82fep+0;
  constexpr Twofold kLn2{0x1.62e42feep-1, 0x1.a39ef35793c76p-33};  // `high` has 31 bits: its multiples are exact
  if (!(power >= kLeast)) return std::isnan(power) ? kNan : 0.0;
  if (power > kMost) return kInfinity;
  const double exponent = std::floor(power * kPerLn2 + 0.5);
  const double high = power - exponent * kLn2.high;
  const double low = -exponent * kLn2.low;
  const double rest = high + low;
  const double beyond = rest * rest * polynomial(kExponential, rest);
  return std::ldexp(1.0 + (high + (low + beyond)), static_cast<int>(exponent));
}

double log2(double value) {
  constexpr Twofold kTwoPerLn2{0x1.71547652b82fep+1, 0x1.777d0ffda0d24p-55};
  constexpr double kHalfRoot = 0.70710678118654752;
  if (!(value > 0.0)) return value == 0.0 ? -kInfinity : kNan;
  if (value > std::numeric_limits<double>::max()) return kInfinity;
  int exponent = 0;
  double part = std::frexp(value, &exponent);  // 1/2 to 1
  if (part < kHalfRoot) {
    part *= 2.0;
    --exponent;
  }
  const double above = part - 1.0;  // exact
  const double quotient = above / (part + 1.0);
  const double square = quotient * quotient;
  const double series = quotient * square * polynomial(kAreaTangent, square);
  return exponent + (kTwoPerLn2.high * quotient + (kTwoPerLn2.low * quotient + kTwoPerLn2.high * series));
}

double cbrt(double value) {
  const double size = std::abs(value);
  if (!(size > 0.0 && size <= std::numeric_limits<double>::max())) return value;
  int exponent = 0;
  double part = std::frexp(size, &exponent);  // 1/2 to 1
  const int thirds = exponent >= 0 ? exponent / 3 : -((2 - exponent) / 3);
  part = std::ldexp(part, exponent - 3 * thirds);  // 1/2 to 4: exponent - 3 thirds is 0, 1 or 2
  // The parabola through the roots of 1/2, 2 and 4, within 0.03; each step of Halley's triples the digits.
  double root = 0.59627 + part * (0.41587 - part * 0.042021);
  for (int step = 0; step < 3; ++step) {
    const double cube = root * root * root;
    root *= (cube + 2.0 * part) / (2.0 * cube + part);
  }
  const Twofold square = productOf(root, root);
  const Twofold cube = productOf(square.high, root);
  const double missing = (part - cube.high) - (cube.low + square.low * root);
  root += missing / (3.0 * square.high);
  return std::copysign(std::ldexp(root, thirds), value);
}

double hypot(double x, double y) {
  constexpr double kLeast = 1e-140;
  constexpr double kMost = 1e150;
  const double larger = std::max(std::abs(x), std::abs(y));
  if ((larger >= kLeast && larger <= kMost) || !(larger > 0.0 && larger < kInfinity)) return std::sqrt(x * x + y * y);
  const double scale = larger > 1.0 ? 0x1p+600 : 0x1p-600;
  const double a = x / scale;
  const double b = y / scale;
  return scale * std::sqrt(a * a + b * b);
}

}  // namespace springtower::elementary
