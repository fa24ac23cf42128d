#pragma once

#include "narrowphase/exact/moving_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace springtower {

/// A cubic polynomial on t in [0, 1] in Bernstein form, sum of c_i C(3,i) t^i (1-t)^(3-i), with an absolute error bound: the true
/// polynomial and this one differ by at most `error` everywhere on [0, 1].
struct BernsteinCubic {
  std::array<double, 4> coefficients;
  double error;
};

/// A part of the step, 0 <= from <= to <= 1.
struct TimeInterval {
  double from;
  double to;
};

/// det(x, y, z) of three vectors that change linearly from x0, y0, z0 to x1, y1, z1, as a cubic in time. Each coordinate given
/// may be wrong by `inputError` (absolute) and by one rounding; the cubic's error covers that, its own rounding and underflow.
/// (Bounds: the six terms of a determinant sum up to at most 6 |x| |y| |z| in the largest norm; three input errors of u = 2^-53,
/// five roundings in a determinant, three in a mean of three of them.)
inline BernsteinCubic determinantCubic(const Vec3& x0, const Vec3& y0, const Vec3& z0, const Vec3& x1, const Vec3& y1,
                                       const Vec3& z1, double inputError) {
  const Vec3 startNormal = x0.cross(y0);
  const Vec3 endNormal = x1.cross(y1);
  const Vec3 mixedNormal = x0.cross(y1) + x1.cross(y0);
  const double x = x0.cwiseAbs().cwiseMax(x1.cwiseAbs()).maxCoeff() + inputError;
  const double y = y0.cwiseAbs().cwiseMax(y1.cwiseAbs()).maxCoeff() + inputError;
  const double z = z0.cwiseAbs().cwiseMax(z1.cwiseAbs()).maxCoeff() + inputError;
  constexpr double kRounding = 6.0 * std::numeric_limits<double>::epsilon();  // 12 u
  constexpr double kUnderflow = 1e-300;
  return {{startNormal.dot(z0), (startNormal.dot(z1) + mixedNormal.dot(z0)) / 3.0,
           (mixedNormal.dot(z1) + endNormal.dot(z0)) / 3.0, endNormal.dot(z1)},
          6.0 * (kRounding * x * y * z + 1.01 * inputError * (x * y + y * z + z * x)) + kUnderflow * (1.0 + x + y + z)};
}

/// The coplanarity cubic of four moving points (report Eq. 4.9, 4.11 and appendix 1): det(b - a, c - a, d - a) as a function of
/// time, whose roots are the times at which the points lie in one plane. Its power form is the report's for a face a b c and a
/// point d, and minus the report's for edges a-b and c-d or a point a and a face b c d. Built from differences at the start and
/// at the end of the step, each rounded once, so its error is relative to the size of the features and not to their distance from
/// the origin.
inline BernsteinCubic coplanarityCubic(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d) {
  return determinantCubic(b.start - a.start, c.start - a.start, d.start - a.start, b.end - a.end, c.end - a.end, d.end - a.end,
                          0.0);
}

/// Whether the cubic may have a root in [0, 1]: false if all Bernstein coefficients lie on one side of zero by more than the
/// error, because a polynomial lies in the convex hull of its Bernstein coefficients. NaN counts as true.
inline bool mayVanish(const BernsteinCubic& cubic) {
  const auto& [c0, c1, c2, c3] = cubic.coefficients;
  const double error = cubic.error;
  return !((c0 > error && c1 > error && c2 > error && c3 > error) || (c0 < -error && c1 < -error && c2 < -error && c3 < -error));
}

/// Whether four moving points may lie in one plane at some time of the step: the second cull, after the boxes. False proves that
/// a point and a face, or two edges, made of them never meet.
inline bool coplanarityCubicMayVanish(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d) {
  return mayVanish(coplanarityCubic(a, b, c, d));
}

/// Coefficients a, b, c, d of a t^3 + b t^2 + c t + d (report Eq. 4.10) of a cubic in Bernstein form.
std::array<double, 4> powerCoefficients(const BernsteinCubic& cubic);

/// Bezier clipping (Sederberg and Nishita 1990): shrinks `part` to the interval in which the convex hull of the control polygon
/// of `piece`, widened by its error, reaches zero. `piece` is the cubic restricted to `part`: its s in [0, 1] is the time
/// part.from + s (part.to - part.from). Every root in `part` remains in it: bounds are rounded outwards. Returns false if the
/// cubic has no root in `part`, which is then unchanged. Converges quadratically to a simple root.
bool clipToRoots(const BernsteinCubic& piece, TimeInterval& part);

}  // namespace springtower
