#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
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

/// a x b; positive where b lies to the left of a.
inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The convex hull of points (m), counterclockwise, without those on its edges and those that follow another in order of x, then
/// y, at a distance of `same` or less (monotone chain: Andrew 1979). O(n log n). Fewer than three corners where all points lie on
/// a line.
inline Polygon convexHull(Polygon points, double same = 0.0) {
  const auto before = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
  };
  const auto coincide = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return (a - b).norm() <= same; };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end(), coincide), points.end());
  if (points.size() < 3) return points;
  Polygon hull;
  for (const int pass : {0, 1}) {
    const std::size_t start = hull.size();
    for (const Eigen::Vector2d& point : points) {
      while (hull.size() >= start + 2 && cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    if (pass == 0) std::reverse(points.begin(), points.end());
  }
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
    const double area = 0.5 * cross(p, q);
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
    for (const Eigen::Vector2d& corner : hull) farthest = std::max(farthest, cross(to - from, corner - from));
    least = std::min(least, farthest / (to - from).norm());
  }
  return least;
}

}  // namespace springtower
