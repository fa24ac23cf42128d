#pragma once

#include "narrowphase/exact/query_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace springtower {

inline Vec3 positionAt(const MovingPoint& point, double time) {
  return (1.0 - time) * point.start + time * point.end;
}

/// The differences of the two features of a query at one time, as the corners of a planar polygon in order: the features share a
/// point when it contains the origin. Three corners for a point and a triangle (the last one repeated), four for two edges.
inline std::array<Vec3, 4> differencesAt(const CollisionQuery& query, QueryKind kind, double time) {
  const auto& points = query.points;
  const Vec3 a = positionAt(points[0], time), b = positionAt(points[1], time), c = positionAt(points[2], time),
             d = positionAt(points[3], time);
  if (kind == QueryKind::pointTriangle) return {b - a, c - a, d - a, d - a};
  return {c - a, d - a, d - b, c - b};
}

/// Distance of the two features of a query at one time, from its definition: over the polygon's interior or its boundary.
inline double distanceAt(const CollisionQuery& query, QueryKind kind, double time) {
  const std::array<Vec3, 4> corners = differencesAt(query, kind, time);
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[1]);
  bool inside = normal.squaredNorm() > 0.0;
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 edge = corners[(i + 1) % 4] - corners[i];
    const double length2 = edge.squaredNorm();
    const double weight = length2 > 0.0 ? std::clamp(-corners[i].dot(edge) / length2, 0.0, 1.0) : 0.0;
    distance = std::min(distance, (corners[i] + weight * edge).norm());
    if (length2 > 0.0) inside &= normal.dot(corners[i].cross(corners[(i + 1) % 4])) >= 0.0;
  }
  return inside ? std::min(distance, std::abs(normal.normalized().dot(corners[0]))) : distance;
}

/// The largest displacement of a corner of the polygon of differences in the step: an upper bound of the change of the features'
/// distance.
inline double relativeMotion(const CollisionQuery& query, QueryKind kind) {
  const std::array<Vec3, 4> start = differencesAt(query, kind, 0.0), end = differencesAt(query, kind, 1.0);
  double motion = 0.0;
  for (std::size_t i = 0; i < 4; ++i) motion = std::max(motion, (end[i] - start[i]).norm());
  return motion;
}

}  // namespace springtower
