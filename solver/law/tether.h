#pragma once

#include "core/state.h"

#include <array>

namespace springtower {

/// A hand's hold on one block: springs and dashpots between the block's corners and a rigid copy of the block that the hand
/// moves. The centre and the corners about it have constants of their own, as a hand may draw gently and still hold a block
/// level. Methods solve it implicitly with the step like any other spring, so it may be stiff; a force computed once a frame
/// would lag behind friction.
struct Tether {
  BlockId block = kFloor;                                    ///< kFloor: no block is held
  Vec3 place = Vec3::Zero();                                 ///< m, of the copy's centre at `time_s`
  Vec3 velocity = Vec3::Zero();                              ///< m/s
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from the copy's axes to the world's at `time_s`; unit
  Vec3 spin = Vec3::Zero();                                  ///< rad/s
  double time_s = 0.0;
  double stiffness_n_m = 0.0;        ///< of the centre
  double damping_n_s_m = 0.0;        ///< of the centre
  double cornerStiffness_n_m = 0.0;  ///< of one corner about the centre, horizontal
  double cornerDamping_n_s_m = 0.0;  ///< likewise
  double tiltStiffness_n_m = 0.0;    ///< of one corner about the centre, vertical
  double tiltDamping_n_s_m = 0.0;    ///< likewise
  Vec3 carried_n = Vec3::Zero();     ///< share of the block's weight that the hand supports, whatever its position
  Eigen::Matrix3d carriedOnEdges_n =
      Eigen::Matrix3d::Zero();   ///< torque of its weight where it overhangs, as forces on the mean edges
  double limit_n = 0.0;          ///< largest force
  Vec3 line = Vec3::Zero();      ///< unit, if the hand draws along a line; otherwise zero
  double acrossLimit_n = 0.0;    ///< largest force across that line
  double torqueLimit_n_m = 0.0;  ///< largest torque
};

/// Force of a hand on its block.
struct GripForce {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about the centre
  bool limited = false;        ///< whether the force is at its limit, or was reduced to avoid overshoot
  bool acrossLimited = false;  ///< the same of its part across the line
  bool turnLimited = false;    ///< the same of the torque
};

/// A torque (N m) as forces on a block's mean edges (m, one column each), N: the set of forces that rotates all edges alike.
Eigen::Matrix3d forcesOnEdges(const Vec3& torque_n_m, const Eigen::Matrix3d& edges);

using TetherMatrix = Eigen::Matrix<double, 12, 12>;

/// The tether's forces on the block's corners (N) with the copy in its position at `time_s`, and their sum. The springs'
/// extension is limited to that at which they alone reach the force limit, so a distant hand draws at full force up to the speed
/// from which it can still stop. Precondition: the tether holds a block.
GripForce tetherForces(const Tether& tether, const BlockModel& model, const MotionState& state, double time_s,
                       std::array<Vec3, kCorners>& corner);

/// Resistance of the tether to motion of its block, N/m: minus the derivative of its forces on [C, E_0, E_1, E_2]
/// (solver/block/affine.h, each three components), where a displacement changes velocities by 1 / `step_s` of it. A force at its
/// limit has constant magnitude, and its direction follows the unlimited force. Precondition: the tether holds a block.
TetherMatrix tetherResistance(const Tether& tether, const BlockModel& model, const MotionState& state, double time_s,
                              double step_s);

}  // namespace springtower
