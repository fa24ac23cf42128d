#pragma once

#include "core/state.h"

#include <array>

namespace springtower {

/// A hand's hold on one block: springs and dashpots between the block's corners and a rigid copy of the block that the hand
/// leads. The centre and the corners about it have constants of their own, as a hand may draw gently and still hold a block
/// level. Methods solve it with the step like any spring, so it may be stiff; a force that is found once a frame lags behind
/// friction.
struct Tether {
  BlockId block = kFloor;                                    ///< kFloor: nobody holds anything
  Vec3 place = Vec3::Zero();                                 ///< m, of the copy's centre at `time_s`
  Vec3 velocity = Vec3::Zero();                              ///< m/s
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from the copy's axes to the world's at `time_s`; unit
  Vec3 spin = Vec3::Zero();                                  ///< rad/s
  double time_s = 0.0;
  double stiffness_n_m = 0.0;                                  ///< of the centre
  double damping_n_s_m = 0.0;                                  ///< of the centre
  double cornerStiffness_n_m = 0.0;                            ///< of one corner about the centre, level
  double cornerDamping_n_s_m = 0.0;                            ///< likewise
  double tiltStiffness_n_m = 0.0;                              ///< of one corner about the centre, up and down
  double tiltDamping_n_s_m = 0.0;                              ///< likewise
  Vec3 carried_n = Vec3::Zero();                               ///< what the hand carries of the block's weight whatever its place
  Eigen::Matrix3d carriedOnEdges_n = Eigen::Matrix3d::Zero();  ///< and of its weight's torque about what it hangs over, a column
                                                               ///< an edge: a corner is pushed by the sum of half of each
  double limit_n = 0.0;                                        ///< most force
  Vec3 line = Vec3::Zero();                                    ///< unit where the hand draws along a line, else zero
  double acrossLimit_n = 0.0;                                  ///< most force across that line
  double torqueLimit_n_m = 0.0;                                ///< most torque
};

/// What a hand does to its block.
struct GripForce {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about the centre
  bool limited = false;        ///< whether the force is at its limit, or was cut to keep the follow free of overshoot
  bool acrossLimited = false;  ///< the same of its part across the line
  bool turnLimited = false;    ///< the same of the torque
};

/// A torque (N m) as forces on a block's mean edges (m, a column each), N: those that turn all of them alike.
Eigen::Matrix3d forcesOnEdges(const Vec3& torque_n_m, const Eigen::Matrix3d& edges);

using TetherMatrix = Eigen::Matrix<double, 12, 12>;

/// The tether's forces on the block's corners (N) with the copy where it is at `time_s`, and their sum. Springs reach no further
/// than where they alone give the limit: a far hand draws at full force up to the speed from which it can still stop.
/// Precondition: the tether holds a block.
GripForce tetherForces(const Tether& tether, const BlockModel& model, const MotionState& state, double time_s,
                       std::array<Vec3, kCorners>& corner);

/// How the tether resists that its block moves, N/m: minus the derivative of its forces on [C, E_0, E_1, E_2]
/// (solver/block/affine.h, each three components), where a displacement changes velocities by 1 / `step_s` of it. A force at its
/// limit grows no more, and turns with what it is the limit of. Precondition: the tether holds a block.
TetherMatrix tetherResistance(const Tether& tether, const BlockModel& model, const MotionState& state, double time_s,
                              double step_s);

}  // namespace springtower
