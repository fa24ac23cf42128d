#include "solver/grip.h"

#include "solver/inertia.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace springtower {
namespace {

// How fast the hand takes up or hands over the weight; a few frames, so that a sudden loss of support does not jerk.
constexpr double kCarryTime_s = 0.03;
// Below this the block counts as free.
constexpr double kTouch_n = 1e-4;

double poleOf(double rate_hz, double frame_s) {
  return std::exp(-2.0 * std::numbers::pi * rate_hz * frame_s);
}

// A vector shortened to a length.
Vec3 within(const Vec3& vector, double length) {
  const double norm = vector.norm();
  return norm > length ? Vec3(vector * (length / norm)) : vector;
}

// Moments of inertia of a block about the world's axes, kg m2.
Eigen::Matrix3d momentsOf(const Simulation& simulation, std::size_t block, const Eigen::Quaterniond& orientation) {
  const Vec3 squares = simulation.model.dimensions[block].cwiseAbs2();
  const double part = 2.0 / inverseMass(simulation.scene.settings.inertia).own;  // cuboid 1/12, lumped 1/4
  const Vec3 own = part * simulation.model.mass[block] * (Vec3::Constant(squares.sum()) - squares);
  const Eigen::Matrix3d axes = orientation.toRotationMatrix();
  return axes * own.asDiagonal() * axes.transpose();
}

// What all contacts together put on a block: force, N, and torque about its centre, N m.
struct ContactSum {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
};

ContactSum sumOf(std::span<const ContactForce> contacts, BlockId block, const Vec3& middle) {
  ContactSum sum;
  for (const ContactForce& contact : contacts) {
    if (contact.upper != block && contact.lower != block) continue;
    const bool upper = contact.upper == block;
    const Vec3 onUpper = contact.normalForce * contact.normal + contact.frictionForce;
    const Vec3 force = upper ? onUpper : Vec3(-onUpper);
    sum.force += force;
    sum.torque += ((upper ? contact.point : contact.lowerPoint) - middle).cross(force);
  }
  return sum;
}

}  // namespace

FollowGains followGains(double rate_hz, double frame_s) {
  const double p = poleOf(rate_hz, frame_s);
  return {(1.0 - p) * (1.0 - p) / (frame_s * frame_s), (1.0 - p) * (3.0 + p) / (2.0 * frame_s)};
}

double followCourse(double rate_hz, double frame_s, int frames) {
  const double p = poleOf(rate_hz, frame_s);
  return (1.0 + frames * (1.0 - p * p) / (2.0 * p)) * std::pow(p, frames);
}

Eigen::Quaterniond orientationOf(const CornerArray& position, std::size_t block) {
  Eigen::Matrix3d edges;
  for (std::size_t a = 0; a < 3; ++a) edges.col(static_cast<Eigen::Index>(a)) = meanEdge(position, block, a).normalized();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(edges, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Eigen::Quaterniond(Eigen::Matrix3d(svd.matrixU() * svd.matrixV().transpose())).normalized();
}

GripForce gripForce(const Simulation& simulation, std::span<const ContactForce> contacts, const Hand& hand, Grip& grip) {
  const std::size_t b = index(hand.block);
  const double frame_s = simulation.scene.settings.frame_s;
  const double mass = simulation.model.mass[b];
  const Vec3 gravity = simulation.scene.gravity.at(simulation.time_s);
  const double weight = mass * std::max(-gravity.z(), 0.0);
  const RigidMotion motion = rigidMotion(simulation.state, b);
  const ContactSum onBlock = sumOf(contacts, hand.block, motion.centre);
  const double missing = weight > 0.0 ? std::clamp(1.0 - onBlock.force.z() / weight, 0.0, 1.0) : 0.0;
  if (grip.block != hand.block) {
    grip = {hand.block, missing, Vec3::Zero()};
  } else {
    const double share = 1.0 - std::exp(-frame_s / kCarryTime_s);
    grip.carried += share * (missing - grip.carried);
    grip.levelling += share * (-onBlock.torque - grip.levelling);
  }

  const FollowGains gains = followGains(kFollowRate_hz, frame_s);
  GripForce result;
  // The distance is cut where the pull alone would reach the limit: a far hand draws at full force up to the speed from which
  // it can still stop without overshoot.
  const Vec3 distance = within(hand.place - motion.centre, hand.limit_n / (gains.place * mass));
  const Vec3 wanted = mass * (gains.place * distance - gains.speed * motion.velocity - grip.carried * gravity);
  result.force = within(wanted, hand.limit_n);
  result.limited = wanted.norm() > hand.limit_n || distance.norm() < (hand.place - motion.centre).norm();

  const Eigen::Quaterniond now = orientationOf(simulation.state.position, b);
  const Eigen::Matrix3d moments = momentsOf(simulation, b, now);
  Eigen::Quaterniond missingTurn = hand.turn * now.conjugate();
  if (missingTurn.w() < 0.0) missingTurn.coeffs() *= -1.0;  // the shorter way round
  const Eigen::AngleAxisd turn(missingTurn);
  Vec3 sides = simulation.model.dimensions[b];
  std::sort(sides.data(), sides.data() + 3);
  const double limit = 0.5 * sides[1] * hand.limit_n;
  // As much as the block's weight at its end would need: the hand holds a block level, it does not force it against its
  // neighbours.
  grip.levelling = within(grip.levelling, std::min(limit, 0.5 * sides[2] * weight));
  const Vec3 pull = within(gains.place * (moments * (turn.angle() * turn.axis())), limit);
  result.torque = within(pull - gains.speed * (moments * motion.spin) + grip.levelling, limit);
  return result;
}

void applyGrip(Simulation& simulation, BlockId block, const GripForce& grip) {
  const std::size_t b = index(block);
  const Vec3 middle = centre(simulation.state.position, b);
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = simulation.state.position.at(b, c) - middle;
    spread += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
  }
  // The forces that begin a rigid turn: crossed with the arms they sum to the torque, and to no force.
  const Vec3 turning = spread.inverse() * grip.torque;
  for (std::size_t c = 0; c < kCorners; ++c) {
    UserForce force;
    force.block = static_cast<int>(b);
    force.corner = static_cast<int>(c);
    force.force = grip.force / static_cast<double>(kCorners) + turning.cross(simulation.state.position.at(b, c) - middle);
    force.start_s = simulation.time_s;
    force.end_s = simulation.time_s + simulation.scene.settings.frame_s;
    simulation.scene.forces.push_back(force);
  }
}

double drawOn(Draw& draw, std::span<const ContactForce> contacts, Simulation& simulation) {
  constexpr double kGain = 0.5;  // share of the missing speed that the block is given in a frame
  const std::size_t b = index(draw.hand.block);
  const double frame_s = simulation.scene.settings.frame_s;
  const double mass = simulation.model.mass[b];
  const Vec3 middle = centre(simulation.state.position, b);
  const double speed = centre(simulation.state.velocity, b).dot(draw.direction);
  // What held the block back in the last frame, and a push. A block that sticks answers a push with as much friction, so the
  // force grows until it slips; one that comes free is not thrown.
  const double held_n = -sumOf(contacts, draw.hand.block, middle).force.dot(draw.direction);
  const double push_n = kGain * mass / frame_s * (draw.speed_m_s - speed);
  const double force_n = std::clamp(std::max(held_n, 0.0) + push_n, 0.0, draw.hand.limit_n);
  // The hand is where its follow gives that force.
  const FollowGains gains = followGains(kFollowRate_hz, frame_s);
  const double ahead = (force_n / mass + gains.speed * speed) / gains.place;
  draw.hand.place += (ahead - (draw.hand.place - middle).dot(draw.direction)) * draw.direction;
  const GripForce force = gripForce(simulation, contacts, draw.hand, draw.grip);
  applyGrip(simulation, draw.hand.block, force);
  return force.force.dot(draw.direction);
}

Hand handOn(const Simulation& simulation, BlockId block, double limit_n) {
  const std::size_t b = index(block);
  return {block, centre(simulation.state.position, b), orientationOf(simulation.state.position, b), limit_n};
}

Hold holdOf(std::span<const ContactForce> contacts, BlockId block) {
  double all = 0.0;
  double sliding = 0.0;
  for (const ContactForce& contact : contacts) {
    if (contact.upper != block && contact.lower != block) continue;
    all += contact.normalForce;
    if (contact.sliding) sliding += contact.normalForce;
  }
  if (all < kTouch_n) return Hold::free;
  return sliding > 0.5 * all ? Hold::slips : Hold::sticks;
}

}  // namespace springtower
