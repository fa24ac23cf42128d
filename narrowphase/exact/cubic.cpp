#include "narrowphase/exact/cubic.h"

namespace springtower {

namespace {

/// A lower bound of the first s in [0, 1] at which the control polygon c0 c1 c2 c3, lowered by `error`, can be zero, for c0 >
/// error; above 1 if it cannot. All control points lie on or above the steepest line from the first one down to another.
double firstCrossing(double c0, double c1, double c2, double c3, double error) {
  const double height = c0 - error;
  const double descent = std::max({3.0 * (c0 - c1), 1.5 * (c0 - c2), c0 - c3});
  return height >= descent ? 2.0 : height / descent * (1.0 - 8.0 * std::numeric_limits<double>::epsilon());
}

}  // namespace

std::array<double, 4> powerCoefficients(const BernsteinCubic& cubic) {
  const auto& [c0, c1, c2, c3] = cubic.coefficients;
  return {(c3 - c0) + 3.0 * (c1 - c2), 3.0 * ((c0 - c1) + (c2 - c1)), 3.0 * (c1 - c0), c0};
}

bool clipToRoots(const BernsteinCubic& piece, TimeInterval& part) {
  const auto& [c0, c1, c2, c3] = piece.coefficients;
  const double width = part.to - part.from;
  double skippedAtStart = 0.0;
  if (c0 > piece.error) skippedAtStart = firstCrossing(c0, c1, c2, c3, piece.error);
  if (c0 < -piece.error) skippedAtStart = firstCrossing(-c0, -c1, -c2, -c3, piece.error);
  double skippedAtEnd = 0.0;
  if (c3 > piece.error) skippedAtEnd = firstCrossing(c3, c2, c1, c0, piece.error);
  if (c3 < -piece.error) skippedAtEnd = firstCrossing(-c3, -c2, -c1, -c0, piece.error);
  if (skippedAtStart + skippedAtEnd > 1.0 + 8.0 * std::numeric_limits<double>::epsilon()) return false;

  // The sums below are rounded; moving the bounds outwards by one part in 2^52 keeps every root inside.
  constexpr double kOutwards = std::numeric_limits<double>::epsilon();
  const double from = (part.from + width * skippedAtStart) * (1.0 - kOutwards);
  const double to = (part.to - width * skippedAtEnd) * (1.0 + kOutwards);
  part.from = std::max(part.from, from);
  part.to = std::min(part.to, std::max(to, part.from));
  return true;
}

}  // namespace springtower
