#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
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

/// A polygon in the plane; its corners, m, in order.
using Polygon = std::vector<Eigen::Vector2d>;

/// Twice the signed area of a triangle; positive where a, b, c turn to the left.
inline double turnOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// The convex hull of points (m), counterclockwise, without those on its edges (monotone chain: Andrew 1979). O(n log n). Fewer
/// than three corners where all points lie on a line.
inline Polygon convexHull(Polygon points) {
  std::sort(points.begin(), points.end(),
            [](const Eigen::Vector2d& p, const Eigen::Vector2d& q) { return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y(); });
  Polygon hull;
  const auto extend = [&](const Eigen::Vector2d& point, std::size_t fixed) {
    while (hull.size() > fixed && turnOf(hull[hull.size() - 2], hull.back(), point) <= 0.0) hull.pop_back();
    hull.push_back(point);
  };
  for (const Eigen::Vector2d& point : points) extend(point, 1);
  const std::size_t lower = hull.size();
  for (std::size_t i = points.size(); i-- > 1;) extend(points[i - 1], lower);
  if (hull.size() > 1) hull.pop_back();
  return hull;
}

/// What two convex polygons, counterclockwise, have in common; empty where that is nothing.
inline Polygon overlapOf(Polygon polygon, const Polygon& other) {
  for (std::size_t i = 0; i < other.size() && !polygon.empty(); ++i) {
    const Eigen::Vector2d side = other[(i + 1) % other.size()] - other[i];
    const Eigen::Vector2d outwards(side.y(), -side.x());
    polygon = clippedBy(polygon, outwards, outwards.dot(other[i]));
  }
  return polygon;
}

/// Area, centroid, and second moments of area about the centroid over the area, of a convex polygon.
struct AreaMoments {
  double area_m2 = 0.0;
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();       ///< m
  Eigen::Matrix2d secondPerArea = Eigen::Matrix2d::Zero();  ///< m2
};

/// Zeros for fewer than three corners or no area. The triangles of a fan, each with second moments of its corners' and its
/// centroid's positions.
inline AreaMoments areaMoments(const Polygon& polygon) {
  AreaMoments sum;
  if (polygon.size() < 3) return sum;
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Eigen::Vector2d p = polygon[i - 1] - polygon[0];
    const Eigen::Vector2d q = polygon[i] - polygon[0];
    const double area = 0.5 * turnOf(polygon[0], polygon[i - 1], polygon[i]);
    sum.area_m2 += area;
    sum.centroid += area * (p + q) / 3.0;
    const Eigen::Vector2d both = p + q;
    second += area / 12.0 * (p * p.transpose() + q * q.transpose() + both * both.transpose());
  }
  if (!(sum.area_m2 > 0.0)) return {};
  sum.centroid /= sum.area_m2;
  sum.secondPerArea = second / sum.area_m2 - sum.centroid * sum.centroid.transpose();
  sum.centroid += polygon[0];
  return sum;
}

/// The least width of a convex polygon, counterclockwise, over all directions, m: that across one of its edges. 0 for fewer than
/// three corners.
inline double leastWidth(const Polygon& hull) {
  if (hull.size() < 3) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d& from = hull[i];
    const Eigen::Vector2d& to = hull[(i + 1) % hull.size()];
    double farthest = 0.0;
    for (const Eigen::Vector2d& corner : hull) farthest = std::max(farthest, turnOf(from, to, corner));
    least = std::min(least, farthest / (to - from).norm());
  }
  return least;
}

}  // namespace springtower
