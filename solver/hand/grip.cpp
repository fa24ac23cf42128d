#include "solver/hand/grip.h"

#include "core/elementary.h"
#include "core/nearest_rotation.h"
#include "core/rotation_vector.h"
#include "core/scene/input_check.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace springtower {
namespace {

// Largest stable follow frequency: explicit steps fixed by the user have little stability left beyond the blocks' own springs.
double stableRate(double rate_rad_s, const Simulation& simulation) {
  const Settings& settings = simulation.scene.settings;
  if (simulation.fixedSubsteps == 0 || isStableForAnyStep(settings.method)) return rate_rad_s;
  return std::min(rate_rad_s, tuning::kMaxFollowAngle * simulation.fixedSubsteps / settings.frame_s);
}

// Support from below a block: its lifting force, N, and its extent along a line from the block's centre, m.
struct SupportAlong {
  double lift_n = 0.0;
  double from_m = 1e300;
  double to_m = -1e300;
};

SupportAlong supportOf(std::span<const ContactForce> contacts, BlockId block, const Vec3& middle, const Vec3& line) {
  SupportAlong support;
  for (const ContactForce& contact : contacts) {
    if (contact.upper != block && contact.lower != block) continue;
    const double sense = contact.upper == block ? 1.0 : -1.0;
    if (!(contact.normalForce > 0.0) || sense * contact.normal.z() < tuning::kUpwardCosine) continue;
    const double along = (contact.point - middle).dot(line);
    support.from_m = std::min(support.from_m, along);
    support.to_m = std::max(support.to_m, along);
    support.lift_n += sense * contact.normalForce * contact.normal.z();
  }
  return support;
}

// Vertical force of all contacts on a block, N.
double liftOf(std::span<const ContactForce> contacts, BlockId block) {
  double lift = 0.0;
  for (const ContactForce& contact : contacts) {
    const double onUpper = contact.normalForce * contact.normal.z() + contact.frictionForce.z();
    if (contact.upper == block) lift += onUpper;
    if (contact.lower == block) lift -= onUpper;
  }
  return lift;
}

// Share of a block's weight that the hand has to support. A drawing hand leaves all of it to what lies under the block, as long
// as that supports half of it; otherwise it would hold the block at the height of its first support, and lift light blocks off
// their other supports.
double unsupportedShare(std::span<const ContactForce> contacts, const SupportAlong& support, const Hand& hand, double weight) {
  if (!(weight > 0.0)) return 0.0;
  const double supported = hand.line.isZero(0.0) ? liftOf(contacts, hand.block) : 2.0 * support.lift_n;
  return std::clamp(1.0 - supported / weight, 0.0, 1.0);
}

// Moves the grip's orientation towards the hand's, critically damped (exact for any time).
void moveOrientation(const Eigen::Quaterniond& target, double time_s, Grip& grip) {
  Eigen::Quaterniond off = grip.turn * target.conjugate();
  if (off.w() < 0.0) off.coeffs() *= -1.0;  // the shorter rotation
  const Vec3 start = rotationVector(off);
  const Vec3 slope = grip.spin + tuning::kFollowFrequency_rad_s * start;
  const double fade = elementary::exp(-tuning::kFollowFrequency_rad_s * time_s);
  const Vec3 left = fade * (start + time_s * slope);
  grip.spin = fade * (slope - tuning::kFollowFrequency_rad_s * (start + time_s * slope));
  grip.turn = (rotation(left) * target).normalized();
}

}  // namespace

double followCourse(double rate_rad_s, double time_s) {
  return (1.0 + rate_rad_s * time_s) * elementary::exp(-rate_rad_s * time_s);
}

Eigen::Quaterniond orientationOf(const ParticleArray& position, std::size_t block) {
  Eigen::Matrix3d edges = meanEdges(position, block);
  const Vec3 length = edges.colwise().norm();
  Eigen::Index shortest = 0;
  length.minCoeff(&shortest);
  edges = (edges * length.asDiagonal()).eval();
  edges.col(shortest).setZero();
  return Eigen::Quaterniond(nearestRotation(edges)).normalized();
}

void hold(const Hand& hand, std::span<const ContactForce> contacts, Grip& grip, Simulation& simulation) {
  const std::size_t b = index(hand.block);
  const double frame_s = simulation.scene.settings.frame_s;
  const double mass = simulation.model.mass[b];
  const Vec3 gravity = simulation.scene.gravity.at(simulation.time_s);
  const double weight = mass * std::max(-gravity.z(), 0.0);
  const bool draws = !hand.line.isZero(0.0);
  const SupportAlong support = supportOf(contacts, hand.block, centre(simulation.state.position, b), hand.line);
  const double unsupported = unsupportedShare(contacts, support, hand, weight);
  if (grip.block != hand.block) {
    grip = {hand.block, unsupported, orientationOf(simulation.state.position, b), Vec3::Zero()};
  } else {
    grip.carried += (1.0 - elementary::exp(-frame_s / tuning::kWeightTransferTime_s)) * (unsupported - grip.carried);
  }
  const Eigen::Quaterniond before = grip.turn;
  moveOrientation(hand.turn, frame_s, grip);
  Eigen::Quaterniond way = grip.turn * before.conjugate();
  if (way.w() < 0.0) way.coeffs() *= -1.0;

  Tether& tether = simulation.tether;
  tether.block = hand.block;
  tether.place = hand.place;
  tether.velocity = hand.velocity;
  tether.turn = grip.turn;
  tether.spin = rotationVector(way) / frame_s;
  tether.time_s = simulation.time_s + frame_s;
  // Critically damped, both: a free mass on a spring, and the rotation of a block held by its corners.
  const double cornerMass = mass / inverseMass(simulation.scene.settings.inertia).own;
  const double rate = stableRate(hand.rate_rad_s, simulation);
  const double level = stableRate(tuning::kOrientationFrequency_rad_s, simulation);
  tether.stiffness_n_m = mass * rate * rate;
  tether.damping_n_s_m = 2.0 * mass * rate;
  tether.cornerStiffness_n_m = cornerMass * level * level;
  tether.cornerDamping_n_s_m = 2.0 * cornerMass * level;
  const double tilt = draws ? std::min(level, tuning::kDrawTiltFrequency_rad_s) : level;
  tether.tiltStiffness_n_m = cornerMass * tilt * tilt;
  tether.tiltDamping_n_s_m = 2.0 * cornerMass * tilt;
  tether.carried_n = -grip.carried * mass * gravity;
  tether.carriedOnEdges_n.setZero();
  if (draws && support.lift_n > 0.0) {
    const double inside =
        std::min(tuning::kTippingMargin * simulation.model.dimensions[b].minCoeff(), 0.5 * (support.to_m - support.from_m));
    const double over = std::max(0.0, inside - support.to_m);
    tether.carriedOnEdges_n = forcesOnEdges(-over * mass * hand.line.cross(gravity), meanEdges(simulation.state.position, b));
  }
  Vec3 sides = simulation.model.dimensions[b];
  std::sort(sides.data(), sides.data() + 3);
  tether.limit_n = hand.limit_n;
  tether.line = hand.line;
  tether.acrossLimit_n = tuning::kMaxTransverseForce * weight;
  // The torque of two fingers on its sides, and at most the one for a rotation by one radian at the follow frequency.
  const double moment = mass * sides[2] * sides[2] / 12.0;
  tether.torqueLimit_n_m =
      std::min(0.5 * sides[1] * hand.limit_n, moment * tuning::kFollowFrequency_rad_s * tuning::kFollowFrequency_rad_s);
  if (!hand.line.isZero(0.0))
    tether.torqueLimit_n_m = std::min(tether.torqueLimit_n_m, 0.5 * tuning::kMaxTransverseForce * sides[2] * weight);
}

void letGo(Simulation& simulation) {
  simulation.tether.block = kFloor;
}

GripForce gripForce(const Simulation& simulation) {
  if (simulation.tether.block == kFloor) return {};
  std::array<Vec3, kCorners> corner;
  return tetherForces(simulation.tether, simulation.model, simulation.state, simulation.time_s, corner);
}

double reachOf(const Hand& hand, const Simulation& simulation) {
  return hand.limit_n / (simulation.model.mass[index(hand.block)] * hand.rate_rad_s * hand.rate_rad_s);
}

void moveAlongLine(Hand& hand, double speed_m_s, double carried, const Simulation& simulation) {
  const double frame_s = simulation.scene.settings.frame_s;
  hand.velocity = speed_m_s * hand.line;
  hand.place += frame_s * hand.velocity;
  const double give = (1.0 - carried) * (1.0 - elementary::exp(-frame_s / tuning::kHeightFollowTime_s));
  hand.place.z() += give * (centre(simulation.state.position, index(hand.block)).z() - hand.place.z());
}

void advancePull(Draw& draw, std::span<const ContactForce> contacts, Simulation& simulation) {
  Hand& hand = draw.hand;
  const std::size_t b = index(hand.block);
  const double reach = reachOf(hand, simulation);
  const double ahead = (hand.place - centre(simulation.state.position, b)).dot(hand.line);
  const double frame_s = simulation.scene.settings.frame_s;
  const double gained = draw.speed_m_s * draw.speed_m_s / (2.0 * tuning::kDrawRampLength_m) * (draw.drawn_s + 0.5 * frame_s);
  draw.drawn_s += frame_s;
  moveAlongLine(hand, ahead < reach ? std::min(draw.speed_m_s, gained) : 0.0, draw.grip.carried, simulation);
  hold(hand, contacts, draw.grip, simulation);
}

Draw drawingFrom(const Simulation& simulation, BlockId block, const Vec3& direction, double speed_m_s, double limit_n) {
  Draw draw{handOn(simulation, block, limit_n), {}, speed_m_s};
  draw.hand.rate_rad_s = tuning::kDrawFrequency_rad_s;
  draw.hand.line = direction;
  return draw;
}

Hand handOn(const Simulation& simulation, BlockId block, double limit_n) {
  const std::size_t b = index(block);
  requireBlock(b, simulation.model.blockCount(), "hand: block");
  Hand hand;
  hand.block = block;
  hand.place = centre(simulation.state.position, b);
  hand.turn = orientationOf(simulation.state.position, b);
  hand.limit_n = limit_n;
  return hand;
}

Hold holdOf(std::span<const ContactForce> contacts, BlockId block) {
  double all = 0.0;
  double sliding = 0.0;
  for (const ContactForce& contact : contacts) {
    if (contact.upper != block && contact.lower != block) continue;
    all += contact.normalForce;
    if (contact.sliding) sliding += contact.normalForce;
  }
  if (all < tuning::kFreeForce_n) return Hold::free;
  return sliding > 0.5 * all ? Hold::slips : Hold::sticks;
}

}  // namespace springtower
