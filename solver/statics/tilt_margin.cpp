#include "solver/statics/tilt_margin.h"

#include "core/elementary.h"
#include "core/geometry/polygon.h"
#include "core/tuning.h"
#include "solver/statics/tilt_limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

namespace springtower {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
const double kMaxSlope = elementary::tan(89.0 / kDegrees);

// Point of a hull nearest to the origin. For an origin inside: the outward normal of the nearest edge and its distance; for one
// outside: the direction from the nearest point to the origin, and minus its distance.
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

// Two unit vectors perpendicular to gravity; for gravity straight down the world's x and y.
Eigen::Matrix<double, 3, 2> planeAcross(const Vec3& gravity) {
  const Vec3 hint = std::abs(gravity.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  Eigen::Matrix<double, 3, 2> plane;
  plane.col(0) = (hint - gravity * gravity.dot(hint)).normalized();
  plane.col(1) = plane.col(0).cross(gravity);
  return plane;
}

// The gravities that the points can balance, as slopes in the plane perpendicular to the given one.
class BalancedGravities {
 public:
  BalancedGravities(const StaticsModel& model, const std::vector<std::size_t>& usable, const Vec3& gravity)
      : model_(model), usable_(usable), gravity_(gravity), plane_(planeAcross(gravity)) {}

  // A sufficient test; false proves nothing.
  [[nodiscard]] bool isSurelyIn(const Vec2& slope) const { return parallelForcesBalance(model_, usable_, towards(slope)); }

  // Whether there are any. Call it before `extreme`.
  bool any() {
    program_ = std::make_unique<EquilibriumProgram>(model_, usable_, model_.gravityLoad(gravity_));
    for (int i = 0; i < 2; ++i) {
      program_->setBounds(program_->addVariableLoad(model_.gravityLoad(plane_.col(i))), -kMaxSlope, kMaxSlope);
    }
    return program_->isFeasible();
  }

  // The extreme point in one direction.
  Vec2 extreme(const Vec2& direction) {
    program_->maximise(std::array{direction.x(), direction.y()});
    return {program_->variableLoad(0), program_->variableLoad(1)};
  }

  [[nodiscard]] Vec3 towards(const Vec2& slope) const { return gravity_ + plane_ * slope; }

 private:
  const StaticsModel& model_;
  const std::vector<std::size_t>& usable_;
  Vec3 gravity_;
  Eigen::Matrix<double, 3, 2> plane_;
  std::unique_ptr<EquilibriumProgram> program_;
};

// A polygon around the circle of the given radius, with corners within friction, cut by the limits, which lie outside the circle
// by at least `slack`.
std::vector<Vec2> polygonWithin(const std::vector<GravityLimit>& limits, double radius, double slack, const Vec2& first,
                                double friction) {
  const double widest = elementary::acos(std::min(1.0, radius / friction));
  const double sides = std::max(4.0, std::ceil(std::numbers::pi / widest + 1e-6));
  if (!(sides <= tuning::kMaxTiltPolygonSides)) return {};
  std::vector<Vec2> polygon;
  for (int i = 0; i < static_cast<int>(sides); ++i) {
    const double angle = elementary::atan2(first.y(), first.x()) + std::numbers::pi * (2 * i + 1) / sides;
    polygon.emplace_back(radius / elementary::cos(std::numbers::pi / sides) *
                         Vec2(elementary::cos(angle), elementary::sin(angle)));
  }
  for (const GravityLimit& limit : limits) polygon = keepTo(polygon, {limit.direction, limit.bound - 0.5 * slack});
  return polygon;
}

}  // namespace

std::optional<StabilityMargin> tiltMargin(const StaticsModel& model, const std::vector<std::size_t>& usable, const Vec3& gravity,
                                          double tolerance_deg) {
  // In the order in which equal margins are reported.
  const std::array<Vec2, 4> sides = {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)};
  const double tolerance = tolerance_deg / kDegrees;
  BalancedGravities balanced(model, usable, gravity);
  Nearest best{Vec2::UnitX(), std::numeric_limits<double>::infinity()};  // the nearest limit known
  std::vector<Vec2> hull;
  if (gravity.z() == -1.0) {
    const std::vector<GravityLimit> limits = gravityLimits(model, usable);
    for (const GravityLimit& limit : limits) {
      // Among limits that are equal within rounding, the first.
      if (limit.bound < best.distance - tuning::kTiltSameSlope) best = {limit.direction, limit.bound};
    }
    const double radius = elementary::tan(elementary::atan(best.distance) - 0.9 * tolerance);
    if (std::isfinite(best.distance) && radius > 0.0) {
      for (const Vec2& corner : polygonWithin(limits, radius, best.distance - radius, best.direction, model.friction)) {
        if (!balanced.isSurelyIn(corner)) break;
        hull.push_back(corner);
      }
    }
  }
  const auto addExtreme = [&](const Vec2& direction) {
    hull.push_back(balanced.extreme(direction));
    const double support = hull.back().dot(direction);
    if (support < best.distance - tuning::kTiltSameSlope) best = {direction, support};
  };
  bool prepared = false;
  for (int question = 0; question < tuning::kMaxTiltPrograms; ++question) {
    hull = convexHull(std::move(hull), tuning::kTiltSameSlope);
    const Nearest nearest = nearestTo(hull);
    if (std::isfinite(best.distance) && elementary::atan(best.distance) - elementary::atan(nearest.distance) <= tolerance) break;
    // If sliding sets the margin, the set is round, and its hull has many points: most are found by the cheaper test.
    const Vec2 guess = nearest.direction * best.distance;
    if (prepared && nearest.distance >= 0.0 && balanced.isSurelyIn(guess)) {
      hull.push_back(guess);
      continue;
    }
    if (prepared) {
      addExtreme(nearest.direction);
      continue;
    }
    prepared = true;
    if (!balanced.any()) return {};
    for (const Vec2& side : sides) addExtreme(side);
  }
  const double sign = best.distance < 0.0 ? -1.0 : 1.0;
  const Vec3 towards = sign * (balanced.towards(best.direction) - gravity);
  double direction_deg = kDegrees * elementary::atan2(towards.y(), towards.x());
  if (direction_deg < -1e-9) direction_deg += 360.0;
  return StabilityMargin{kDegrees * elementary::atan(best.distance), std::max(0.0, direction_deg)};
}

std::optional<double> tiltTowards(const StaticsModel& model, const std::vector<std::size_t>& usable, double direction_deg) {
  EquilibriumProgram program(model, usable, model.gravityLoad(-Vec3::UnitZ()));
  const double direction = direction_deg / kDegrees;
  program.addVariableLoad(model.gravityLoad(Vec3(elementary::cos(direction), elementary::sin(direction), 0.0)));
  if (!program.isFeasible()) return {};
  program.setBounds(0, 0.0, kMaxSlope);
  return kDegrees * elementary::atan(program.maximise(std::array{1.0}));
}

}  // namespace springtower
