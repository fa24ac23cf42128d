#include "solver/statics/tilt_limits.h"

#include "core/geometry/polygon.h"
#include "core/tuning.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springtower {
namespace {

// A group of blocks that moves as one body, and the edge it tips over: a line perpendicular to `direction`, which is horizontal.
struct Tipping {
  std::vector<char> moves;  // [blocks]
  Vec2 direction;
  double edge = 0.0;    // m, along the direction
  double height = 0.0;  // m
};

class Limits {
 public:
  Limits(const StaticsModel& model, std::span<const std::size_t> usable)
      : model_(model), usable_(usable), same_m_(tuning::kTiltSameHeight * model.lengthUnit_m) {}

  // All limits of the blocks above a height and of those on which they would tip.
  void addLevel(double height) {
    std::vector<char> above;
    for (const Vec3& centre : model_.centre) above.push_back(centre.z() > height ? 1 : 0);
    std::vector<Vec2> places;
    bool flat = true;
    for (const std::size_t p : usable_) {
      const ForcePoint& point = model_.points[p];
      if (!crosses(point, above)) continue;
      places.emplace_back(point.place.head<2>());
      flat = flat && pushesUp(point, above) && std::abs(point.place.z() - height) <= same_m_;
    }
    const std::vector<Vec2> hull = convexHull(places, tuning::kTiltSamePlace_m);
    if (hull.size() < 3) return;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Vec2 along = hull[(i + 1) % hull.size()] - hull[i];
      const Vec2 outward = Vec2(along.y(), -along.x()).normalized();
      addChain({above, outward, outward.dot(hull[i]), height});
    }
    if (!flat) return;
    for (const Vec2& side : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)}) found.push_back({side, model_.friction});
  }

  std::vector<GravityLimit> found;

 private:
  static bool isIn(std::int32_t block, const std::vector<char>& group) {
    return block >= 0 && group[static_cast<std::size_t>(block)] != 0;
  }
  static bool crosses(const ForcePoint& point, const std::vector<char>& group) {
    return isIn(point.upper, group) != isIn(point.lower, group);
  }
  static bool pushesUp(const ForcePoint& point, const std::vector<char>& group) {
    return isIn(point.upper, group) && point.frame(2, 0) > 1.0 - tuning::kTiltFlatSlack;
  }

  void addChain(Tipping tipping) {
    do {
      add(tipping);
    } while (reachDown(tipping));
  }

  void add(const Tipping& tipping) {
    for (const std::size_t p : usable_) {
      const ForcePoint& point = model_.points[p];
      if (!crosses(point, tipping.moves)) continue;
      const double behind = tipping.edge - tipping.direction.dot(point.place.head<2>());
      const bool letsGo = pushesUp(point, tipping.moves) &&
                          point.friction * std::abs(point.place.z() - tipping.height) <= behind + tuning::kTiltSamePlace_m;
      if (!letsGo) return;
    }
    double arm = 0.0;
    double rise = 0.0;
    for (std::size_t b = 0; b < model_.blockCount(); ++b) {
      if (tipping.moves[b] == 0) continue;
      arm += model_.weight[b] * (tipping.edge - tipping.direction.dot(model_.centre[b].head<2>()));
      rise += model_.weight[b] * (model_.centre[b].z() - tipping.height);
    }
    if (rise > 0.0) found.push_back({tipping.direction, arm / rise});
  }

  // Adds the blocks under the edge to the group. False if there is only the floor.
  bool reachDown(Tipping& tipping) {
    std::vector<char> taken(model_.blockCount(), 0);
    bool any = false;
    for (const std::size_t p : usable_) {
      const ForcePoint& point = model_.points[p];
      if (point.lower < 0 || !isIn(point.upper, tipping.moves) || isIn(point.lower, tipping.moves)) continue;
      if (tipping.direction.dot(point.place.head<2>()) < tipping.edge - same_m_) continue;
      taken[static_cast<std::size_t>(point.lower)] = 1;
      any = true;
    }
    if (!any) return false;
    for (std::size_t b = 0; b < taken.size(); ++b) tipping.moves[b] = static_cast<char>(tipping.moves[b] | taken[b]);
    double lowest = std::numeric_limits<double>::infinity();
    for (const std::size_t p : usable_) {
      const ForcePoint& point = model_.points[p];
      if (isIn(point.upper, taken) && !isIn(point.lower, tipping.moves)) lowest = std::min(lowest, point.place.z());
    }
    if (!std::isfinite(lowest)) return false;
    tipping.height = lowest;
    tipping.edge = -std::numeric_limits<double>::infinity();
    for (const std::size_t p : usable_) {
      const ForcePoint& point = model_.points[p];
      if (!isIn(point.upper, taken) || isIn(point.lower, tipping.moves) || point.place.z() > lowest + same_m_) continue;
      tipping.edge = std::max(tipping.edge, tipping.direction.dot(point.place.head<2>()));
    }
    return true;
  }

  const StaticsModel& model_;
  std::span<const std::size_t> usable_;
  double same_m_;
};

}  // namespace

std::vector<Vec2> keepTo(const std::vector<Vec2>& polygon, const GravityLimit& limit) {
  return clippedBy(polygon, limit.direction, limit.bound);
}

std::vector<GravityLimit> gravityLimits(const StaticsModel& model, std::span<const std::size_t> usable) {
  std::vector<double> heights;
  for (const std::size_t p : usable) heights.push_back(model.points[p].place.z());
  std::sort(heights.begin(), heights.end());
  const double same = tuning::kTiltSameHeight * model.lengthUnit_m;
  heights.erase(std::unique(heights.begin(), heights.end(), [&](double a, double b) { return b - a <= same; }), heights.end());
  Limits limits(model, usable);
  for (const double height : heights) limits.addLevel(height);
  return limits.found;
}

}  // namespace springtower
