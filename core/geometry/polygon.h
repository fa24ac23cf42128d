#pragma once

#include <cstddef>
#include <vector>

namespace springtower {

/// What of a convex polygon lies on the side `direction . x <= limit` of a line or a plane (one pass of Sutherland & Hodgman
/// 1974). `Point` is a vector of Eigen of any dimension. Give the limit a little slack where an edge may lie on it: it would be
/// cut somewhere along its length by rounding. (Contact manifolds clip rectangles in coordinates of the reference face, without
/// allocating: narrowphase/manifold.)
template <class Point>
std::vector<Point> clippedBy(const std::vector<Point>& polygon, const Point& direction, double limit) {
  std::vector<Point> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& from = polygon[i];
    const Point& to = polygon[(i + 1) % polygon.size()];
    const double before = from.dot(direction) - limit;
    const double after = to.dot(direction) - limit;
    if (before <= 0.0) kept.push_back(from);
    if ((before < 0.0 && after > 0.0) || (before > 0.0 && after < 0.0))
      kept.push_back(from + (to - from) * (before / (before - after)));
  }
  return kept;
}

}  // namespace springtower
