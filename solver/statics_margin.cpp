#include "solver/statics_margin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace springtower {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double kDegrees = 180.0 / std::numbers::pi;
const double kMostSlope = std::tan(89.0 / kDegrees);
constexpr double kSamePoint = 1e-9;
constexpr int kMostQuestions = 2000;  // a circle within 0.005 degrees takes some 130

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Convex hull, counterclockwise (Andrew 1979).
std::vector<Vec2> hullOf(std::vector<Vec2> points) {
  const auto before = [](const Vec2& a, const Vec2& b) { return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); };
  const auto same = [](const Vec2& a, const Vec2& b) { return (a - b).norm() <= kSamePoint; };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2> hull;
  for (const int pass : {0, 1}) {
    const std::size_t start = hull.size();
    for (const Vec2& point : points) {
      while (hull.size() >= start + 2 && cross(hull.back() - hull[hull.size() - 2], point - hull.back()) <= 0.0) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    if (pass == 0) std::reverse(points.begin(), points.end());
  }
  return hull;
}

// Where a hull is nearest to the origin: for an origin inside the outward normal of the nearest edge and its distance; for one
// outside the direction from the nearest point to the origin, and minus its distance.
struct Nearest {
  Vec2 direction = Vec2::UnitX();
  double distance = 0.0;
};

Nearest nearestTo(const std::vector<Vec2>& hull) {
  Nearest inside{Vec2::UnitX(), std::numeric_limits<double>::infinity()};
  Nearest outside{Vec2::UnitX(), -std::numeric_limits<double>::infinity()};
  bool isOutside = hull.size() < 3;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2& from = hull[i];
    const Vec2 along = hull[(i + 1) % hull.size()] - from;
    if (hull.size() >= 3) {
      const Vec2 normal = Vec2(along.y(), -along.x()).normalized();
      const double distance = normal.dot(from);
      if (distance < 0.0) isOutside = true;
      if (distance < inside.distance) inside = {normal, distance};
    }
    const double length = along.squaredNorm();
    const double part = length > 0.0 ? std::clamp(-from.dot(along) / length, 0.0, 1.0) : 0.0;
    const Vec2 nearest = from + part * along;
    const double distance = nearest.norm();
    if (-distance > outside.distance) outside = {distance > 0.0 ? Vec2(-nearest / distance) : Vec2::UnitX(), -distance};
  }
  return isOutside ? outside : inside;
}

// Two unit vectors across gravity; for gravity straight down the world's x and y.
Eigen::Matrix<double, 3, 2> planeAcross(const Vec3& gravity) {
  const Vec3 hint = std::abs(gravity.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  Eigen::Matrix<double, 3, 2> plane;
  plane.col(0) = (hint - gravity * gravity.dot(hint)).normalized();
  plane.col(1) = plane.col(0).cross(gravity);
  return plane;
}

class BearableGravities {
 public:
  BearableGravities(const StaticsModel& model, const std::vector<std::size_t>& usable, const Vec3& gravity)
      : model_(model),
        usable_(usable),
        gravity_(gravity),
        plane_(planeAcross(gravity)),
        program_(model, usable, model.gravityLoad(gravity)) {
    for (int i = 0; i < 2; ++i) program_.addVariableLoad(model.gravityLoad(plane_.col(i)));
  }

  bool any() {
    for (std::size_t i = 0; i < 2; ++i) program_.setBounds(i, -kMostSlope, kMostSlope);
    return program_.isFeasible();
  }

  // A quick yes; a no says nothing.
  [[nodiscard]] bool surely(const Vec2& point) const {
    return parallelForcesBalance(model_, usable_, gravity_ + plane_ * point);
  }

  Vec2 extreme(const Vec2& direction) {
    program_.maximise(std::array{direction.x(), direction.y()});
    return {program_.variableLoad(0), program_.variableLoad(1)};
  }

 private:
  const StaticsModel& model_;
  const std::vector<std::size_t>& usable_;
  Vec3 gravity_;
  Eigen::Matrix<double, 3, 2> plane_;
  EquilibriumProgram program_;
};

}  // namespace

std::optional<TiltMargin> tiltMargin(const StaticsModel& model, const std::vector<std::size_t>& usable, const Vec3& gravity,
                                     double tolerance_deg) {
  BearableGravities bearable(model, usable, gravity);
  if (!bearable.any()) return {};
  std::vector<Vec2> hull;
  Nearest best{Vec2::UnitX(), std::numeric_limits<double>::infinity()};  // least support found
  const auto ask = [&](const Vec2& direction) {
    const Vec2 point = bearable.extreme(direction);
    const double support = point.dot(direction);
    if (support < best.distance) best = {direction, support};
    hull.push_back(point);
  };
  // In the order in which equal margins are reported: +x, +y, -x, -y.
  for (const Vec2& direction : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)}) ask(direction);
  const double tolerance = tolerance_deg / kDegrees;
  for (int question = 0; question < kMostQuestions; ++question) {
    hull = hullOf(std::move(hull));
    const Nearest nearest = nearestTo(hull);
    // An origin on the outside: the support along the way to it is at most the true distance, taken negative.
    if (std::atan(best.distance) - std::atan(nearest.distance) <= tolerance) break;
    // Where sliding sets the margin the set is round, and its hull needs many points: most are found by the cheap question.
    const Vec2 point = nearest.direction * best.distance;
    if (nearest.distance >= 0.0 && bearable.surely(point)) {
      hull.push_back(point);
    } else {
      ask(nearest.direction);
    }
  }
  const double sign = best.distance < 0.0 ? -1.0 : 1.0;
  const Eigen::Matrix<double, 3, 2> plane = planeAcross(gravity);
  const Vec3 towards = sign * (plane * best.direction);
  double direction_deg = kDegrees * std::atan2(towards.y(), towards.x());
  if (direction_deg < -1e-9) direction_deg += 360.0;
  return TiltMargin{kDegrees * std::atan(best.distance), std::max(0.0, direction_deg)};
}

std::optional<double> tiltTowards(const StaticsModel& model, const std::vector<std::size_t>& usable, double direction_deg) {
  EquilibriumProgram program(model, usable, model.gravityLoad(-Vec3::UnitZ()));
  const double direction = direction_deg / kDegrees;
  program.addVariableLoad(model.gravityLoad(Vec3(std::cos(direction), std::sin(direction), 0.0)));
  if (!program.isFeasible()) return {};
  program.setBounds(0, 0.0, kMostSlope);
  return kDegrees * std::atan(program.maximise(std::array{1.0}));
}

}  // namespace springtower
