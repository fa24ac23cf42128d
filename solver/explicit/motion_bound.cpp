#include "solver/explicit/motion_bound.h"

#include "core/tuning.h"
#include "solver/block/inertia.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace springtower {

namespace {

// Adds what a block needs that loads of these sizes (N, N m) act on, by its spin now, what they may add to it in the frame, and
// what they do to a corner.
void addBlock(const IslandStep& step, std::int32_t block, double force, double torque, MotionBound& bound) {
  const Simulation& simulation = step.simulation;
  const auto b = static_cast<std::size_t>(block);
  const Vec3& dimensions = simulation.model.dimensions[b];
  const double frame_s = simulation.scene.settings.frame_s;
  const double mass = simulation.model.mass[b];
  const double own = inverseMass(simulation.scene.settings.inertia).own;
  const double arm = 0.5 * dimensions.norm();
  const double side = dimensions.minCoeff();
  const Vec3 squares = dimensions.cwiseAbs2();
  const double moment = 2.0 * mass / own * (squares.sum() - squares.maxCoeff());  // the least principal one
  // A constant force gives no more spin than its work on a corner that it takes from one side of the block to the other.
  const double added =
      std::min(force * arm / moment * frame_s, std::sqrt(4.0 * force * arm / moment)) + torque / moment * frame_s;
  const double spin = rigidMotion(simulation.state, b).spin.norm();
  // A step along the tangents stretches the longest edge by half the square of the turn; compared with the least one.
  const double turn = tuning::kMaxExplicitTurn * std::sqrt(side / dimensions.maxCoeff());
  const double acceleration = own * (force + torque / side) / mass;
  const double pushed = std::sqrt(acceleration / (2.0 * tuning::kMaxExplicitPush * side));
  const double steps = frame_s * std::max((spin + added) / turn, pushed);
  bound.spin = std::max(bound.spin, spin);
  if (!(steps > bound.steps)) return;
  bound.steps = steps;
  bound.block = block;
}

}  // namespace

MotionBound motionBound(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const double begin_s = simulation.time_s;
  const double end_s = begin_s + simulation.scene.settings.frame_s;
  MotionBound bound;
  for (const std::int32_t block : step.blocks) {
    double force = 0.0;
    double torque = 0.0;
    for (const UserForce& user : simulation.scene.forces) {
      if (user.block != block || !user.actsWithin(begin_s, end_s)) continue;
      const Load load = user.at(std::max(begin_s, user.start_s));
      const Load later = user.at(std::min(end_s, user.end_s));
      if (user.corner >= 0 || user.point) force += std::max(load.force.norm(), later.force.norm());
      torque += std::max(load.torque.norm(), later.torque.norm());
    }
    addBlock(step, block, force, torque, bound);
  }
  bound.steps = std::ceil(bound.steps);
  return bound;
}

}  // namespace springtower
