#pragma once

// Elementary functions that are the same on every machine. The standard library's differ in their last bit from one C library to
// the next, and within one by the instructions that the processor has; these are made of additions, multiplications, divisions
// and square roots of doubles, which IEEE 754 fixes to the last bit, in a fixed order. What decides a state uses them alone
// (tests/structure looks for others); std::sqrt, floor, ceil, round, frexp and ldexp are exact and stay.
//
// Errors are in units in the last place (ulp) of the result, bounds that tests/core/elementary_test.cpp compares with long double
// arithmetic. Arguments that are not finite give NaN unless it says otherwise.

namespace springtower::elementary {

/// The largest argument of sin, cos and tan for which their errors hold.
inline constexpr double kMaxAngle_rad = 1073741824.0;  // 2^30

/// Sine of an angle in rad; 1 ulp up to kMaxAngle_rad, NaN beyond. Cody & Waite 1980: the nearest multiple of pi / 2 is
/// subtracted in five parts, of which four times it are exact; then Taylor's series on [-pi / 4, pi / 4].
double sin(double angle);
/// Cosine of an angle in rad; as sin.
double cos(double angle);
/// Tangent of an angle in rad; 3 ulp up to kMaxAngle_rad: the quotient of the two.
double tan(double angle);

/// Inverse tangent, rad, in [-pi / 2, pi / 2]; 2 ulp, also of infinities.
double atan(double tangent);
/// The angle of the direction (x, y) from +x over +y, rad, in [-pi, pi]; 2 ulp. Of (0, 0) 0 or pi, by the sign of x; the sign is
/// that of y. NaN of two infinities. The angle is reduced by
/// that of the nearest of nine directions, tan = 0, 1/8 .. 1, with the tangent's theorem of addition; then Taylor's series.
double atan2(double y, double x);
/// Inverse cosine, rad, in [0, pi]; 3 ulp. NaN outside of [-1, 1]. The half angle has the tangent sqrt(1 - x) / sqrt(1 + x).
double acos(double cosine);

/// e to a power; 1 ulp; 0 below -745.2, infinity above 709.8. Cody & Waite 1980: 2^k e^r, |r| <= ln 2 / 2, with Taylor's series.
double exp(double power);
/// Logarithm to the base 2; 3 ulp. Of 0 minus infinity, of what is less NaN, of infinity infinity. log2 m = 2 / ln 2 artanh((m -
/// 1) / (m + 1)) in Taylor's series, m in [sqrt(1/2), sqrt(2)), and the exponent; exact for powers of two.
double log2(double value);
/// Cube root, of either sign; 1 ulp, also of infinities. Halley's iteration (of third order) from a parabola, then one of
/// Newton's steps whose residual is computed in twice the precision (Dekker 1971).
double cbrt(double value);
/// Length of the vector (x, y); 2 ulp where x^2 + y^2 neither overflows nor underflows, which is where the larger is between
/// 1e-140 and 1e150; beyond, scaled by a power of two.
double hypot(double x, double y);

/// A value times itself, which std::pow(value, 2) is with some compilers alone.
constexpr double square(double value) {
  return value * value;
}

}  // namespace springtower::elementary
