#pragma once

#include "core/vector.h"

#include <algorithm>

namespace springtower {

/// A point that moves at constant velocity over a step: p(t) = start + t (end - start), t in [0, 1] (report Eq. 4.8a). Metres.
struct MovingPoint {
  Vec3 start;
  Vec3 end;
};

/// The size of a query: the largest difference of one coordinate between any two of four moving points, both at the start or both
/// at the end (m). It is invariant under translation of all points.
inline double queryExtent(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d) {
  const Vec3 start = a.start.cwiseMax(b.start).cwiseMax(c.start).cwiseMax(d.start) -
                     a.start.cwiseMin(b.start).cwiseMin(c.start).cwiseMin(d.start);
  const Vec3 end = a.end.cwiseMax(b.end).cwiseMax(c.end).cwiseMax(d.end) - a.end.cwiseMin(b.end).cwiseMin(c.end).cwiseMin(d.end);
  return std::max(start.maxCoeff(), end.maxCoeff());
}

/// Whether the axis-aligned box swept by a point meets the one swept by the triangle a b c (report 4.4.3). Only given coordinates
/// are compared, so nothing is rounded and no margin is needed: false proves that the features never touch.
inline bool pointTriangleBoxesOverlap(const MovingPoint& point, const MovingPoint& a, const MovingPoint& b,
                                      const MovingPoint& c) {
  for (int axis = 0; axis < 3; ++axis) {
    const double low = std::min({a.start[axis], a.end[axis], b.start[axis], b.end[axis], c.start[axis], c.end[axis]});
    if (std::max(point.start[axis], point.end[axis]) < low) return false;
    const double high = std::max({a.start[axis], a.end[axis], b.start[axis], b.end[axis], c.start[axis], c.end[axis]});
    if (std::min(point.start[axis], point.end[axis]) > high) return false;
  }
  return true;
}

/// Whether the axis-aligned boxes swept by the edges a-b and c-d meet (report 4.4.3). False proves that the edges never touch.
inline bool edgeEdgeBoxesOverlap(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d) {
  for (int axis = 0; axis < 3; ++axis) {
    const double lowSecond = std::min({c.start[axis], c.end[axis], d.start[axis], d.end[axis]});
    if (std::max({a.start[axis], a.end[axis], b.start[axis], b.end[axis]}) < lowSecond) return false;
    const double highSecond = std::max({c.start[axis], c.end[axis], d.start[axis], d.end[axis]});
    if (std::min({a.start[axis], a.end[axis], b.start[axis], b.end[axis]}) > highSecond) return false;
  }
  return true;
}

}  // namespace springtower
