#include "solver/contact/slip.h"

#include "core/tuning.h"
#include "solver/block/affine.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/over_island.h"
#include "solver/world/scales.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace springtower {

namespace {

// Of the slip at the centre of pressure: a contact that turns by less slides, one that turns by twice as much turns.
constexpr double kLeastTurning = 0.01;

// Whether a point that pushes has stuck.
bool anySticks(const ContactView& manifold) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    if (touchingAt(manifold, i) == 1.0 && !slipsAt(manifold, i)) return true;
  }
  return false;
}

// Mean distance from the origin of the points between two others in a plane, m (Gauss & Legendre, three points).
double meanLength(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  constexpr double kOutside = 0.5 - 0.38729833462074170;  // (1 - sqrt(3 / 5)) / 2
  const auto at = [&](double share) { return (a + share * (b - a)).norm(); };
  return (5.0 * (at(kOutside) + at(1.0 - kOutside)) + 8.0 * at(0.5)) / 18.0;
}

// Grows with the angle of a vector from the x axis, counterclockwise.
double angleOrder(const Eigen::Vector2d& v) {
  const double size = std::abs(v.x()) + std::abs(v.y());
  if (!(size > 0.0)) return 0.0;
  return v.y() >= 0.0 ? 1.0 - v.x() / size : 3.0 + v.x() / size;
}

// A point of a contact as it is, and whether it slips.
struct ContactNow {
  PointForces points;
  SlipOfPoints slip;
  Vec3 middle = Vec3::Zero();    // m
  Vec3 velocity = Vec3::Zero();  // m/s, of upper against lower there
  double spin_rad_s = 0.0;       // about the normal
};

// Velocity along the faces at a place, by their motion as rigid ones, m/s.
Vec3 slideAt(const ContactNow& now, const Vec3& place) {
  return now.velocity + now.spin_rad_s * now.points.direction.cross(place - now.middle);
}

// Slip speeds of a contact's points by the motion of its faces as rigid ones, m/s: a face that spreads as it is squashed does not
// slip. `relative`: velocity of upper against lower at each point, along the faces.
void addRigidSlip(const ContactView& manifold, std::span<const Vec3> relative, ContactNow& now) {
  const double each = 1.0 / static_cast<double>(relative.size());
  for (std::size_t i = 0; i < relative.size(); ++i) {
    now.middle += each * now.points.place[i];
    now.velocity += each * relative[i];
  }
  double moment = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < relative.size(); ++i) {
    const Vec3 arm = now.points.place[i] - now.middle;
    moment += now.points.direction.dot(arm.cross(relative[i]));
    squares += arm.squaredNorm();
  }
  if (squares > 0.0) now.spin_rad_s = moment / squares;
  for (std::size_t i = 0; i < relative.size(); ++i)
    now.slip.add(touchingAt(manifold, i) == 1.0, slipsAt(manifold, i), slideAt(now, now.points.place[i]).norm());
}

// The slip of all points of a contact at the present positions and velocities.
ContactNow contactNow(const IslandStep& step, const ContactView& manifold) {
  static const AffineField kStill{};
  const MotionState& state = step.simulation.state;
  const bool floor = manifold.lower < 0;
  const auto upper = static_cast<std::size_t>(manifold.upper);
  const auto lower = static_cast<std::size_t>(floor ? manifold.upper : manifold.lower);
  const BlockFrame frames[2] = {blockFrame(state.position, upper), blockFrame(state.position, lower)};
  const bool still = floor || (sleeps(step.simulation, manifold.lower) && !isDriven(step, manifold.lower));
  const AffineField motion[2] = {affineField(state.velocity, upper), still ? kStill : affineField(state.velocity, lower)};
  ContactNow now;
  now.points = pointForces(manifold, {&frames[0], &kStill, &kStill}, {&frames[1], &kStill, &kStill}, step.law);
  const PointForces& points = now.points;
  std::array<Vec3, kManifoldPoints> relative;
  const auto count = static_cast<std::size_t>(manifold.count);
  for (std::size_t i = 0; i < count; ++i) {
    relative[i] = velocityAt(frames[0], motion[0], points.place[i]);
    if (!floor) relative[i] -= velocityAt(frames[1], motion[1], points.lowerPlace[i]);
    relative[i] -= relative[i].dot(points.direction) * points.direction;
  }
  addRigidSlip(manifold, std::span(relative).first(count), now);
  return now;
}

// Where friction acts on a contact that slips.
SlipPatch patchOf(const ContactView& manifold, const ContactNow& now) {
  PatchPoints points;
  double push = 0.0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    points.add(now.points.place[i], now.points.normal[i]);
    push += now.points.normal[i];
    centre += now.points.normal[i] * Eigen::Vector2d(manifold.u(i), manifold.v(i));
  }
  SlipPatch patch;
  if (manifold.phase == PairPhase::edge || !(push > 0.0)) return patch;
  patch.u = static_cast<float>(centre.x() / push);
  patch.v = static_cast<float>(centre.y() / push);
  const EvenPressure pressure = evenPressure(points, now.points.direction);
  patch.shrink = static_cast<float>(shrinkOf(pressure, now.spin_rad_s, slideAt(now, pressure.centre).norm()));
  return patch;
}

// Finds out whether a contact slips; returns whether that has changed.
bool findSlip(const IslandStep& step, Engine& engine, std::size_t at) {
  const ContactView manifold = contactOf(engine, at);
  const std::int32_t contact = engine.pairs.contact[at];
  const Friction friction = step.law.friction->of(manifold.upper, manifold.lower);
  const bool two = friction.staticFriction != friction.kineticFriction;
  bool slips = !anySticks(manifold);
  SlipPatch patch;
  if (slips) {
    const ContactNow now = contactNow(step, manifold);
    // Before it pushes it matters for the coefficient alone.
    slips = (now.slip.pushes || two) && now.slip.isGross(step.simulation);
    if (slips) patch = patchOf(manifold, now);
  }
  if (slips) {
    engine.contacts.setSlipping(contact, patch);
  } else if (manifold.slips) {
    engine.contacts.setSticking(contact);
  }
  return slips != manifold.slips;  // and not by the patch, which snapshots do not have
}

}  // namespace

void SlipOfPoints::add(bool pushesThere, bool slipsThere, double speed_m_s) {
  any_m_s = std::min(any_m_s, speed_m_s);
  if (!pushesThere) return;
  pushes = true;
  sticks = sticks || !slipsThere;
  pushing_m_s = std::min(pushing_m_s, speed_m_s);
}

bool SlipOfPoints::isGross(const Simulation& simulation, double least_m_s) const {
  const double most_m_s = std::max(least_m_s, tuning::kGrossSlipSpeed * speedScale_m_s(simulation));
  return !sticks && (pushes ? pushing_m_s : any_m_s) > most_m_s;
}

EvenPressure evenPressure(const PatchPoints& points, const Vec3& normal) {
  EvenPressure result;
  double total = 0.0;
  for (std::size_t i = 0; i < points.count; ++i) {
    result.centre += points.push[i] * points.place[i];
    total += points.push[i];
  }
  if (points.count == 0) return result;
  result.centre /= total;
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Vec3 first = normal.cross(Vec3::Unit(axis)).normalized();
  const Vec3 second = normal.cross(first);
  std::array<Eigen::Vector2d, kMostNearPoints> corner;  // about the centre, counterclockwise
  double ownMean = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const Vec3 arm = points.place[i] - result.centre;
    const Eigen::Vector2d inPlane(arm.dot(first), arm.dot(second));
    ownMean += points.push[i] / total * inPlane.norm();
    squares += inPlane.squaredNorm();
    std::size_t to = i;
    for (; to > 0 && angleOrder(corner[to - 1]) > angleOrder(inPlane); --to) corner[to] = corner[to - 1];
    corner[to] = inPlane;
  }
  double area = 0.0;  // twice that, as of all triangles with the centre
  double moment = 0.0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const Eigen::Vector2d& from = corner[i];
    const Eigen::Vector2d& to = corner[(i + 1) % points.count];
    const double triangle = std::max(0.0, from.x() * to.y() - from.y() * to.x());
    area += triangle;
    moment += triangle * meanLength(from, to);
  }
  result.radius_m = ownMean;
  if (!(ownMean > 0.0)) return result;
  result.shrink = area > tuning::kFlatPatch * squares ? std::min(1.0, 2.0 / 3.0 * moment / (area * ownMean)) : 0.5;
  return result;
}

double shrinkOf(const EvenPressure& pressure, double spin_rad_s, double slide_m_s) {
  const double turning_m_s = std::abs(spin_rad_s) * pressure.radius_m;
  const double least_m_s = kLeastTurning * slide_m_s;
  const double share = least_m_s > 0.0 ? std::clamp(turning_m_s / least_m_s - 1.0, 0.0, 1.0) : 1.0;
  return 1.0 - share * (1.0 - pressure.shrink);
}

double slipNoise_m_s(const IslandStep& step) {
  return tuning::kSlipNoise * step.simulation.scene.gravity.magnitude * step.drift_s;
}

bool findSlippingContacts(IslandStep& step) {
  Engine& engine = step.engine;
  const auto find = [&](std::size_t first, std::size_t last) {
    bool changed = false;
    for (const std::int32_t pair : step.pairs.subspan(first, last - first)) {
      const auto at = static_cast<std::size_t>(pair);
      if (engine.pairs.touches(at)) changed = findSlip(step, engine, at) || changed;
    }
    return changed;
  };
  return mergeRanges(step.pairs.size(), tuning::kPairGrain, isWide(step), false, find, [](bool a, bool b) { return a || b; });
}

}  // namespace springtower
