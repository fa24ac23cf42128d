#include "solver/block/inertia.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace springtower {

RigidMotion rigidMotion(const MotionState& state, std::size_t block) {
  RigidMotion motion;
  motion.centre = centre(state.position, block);
  motion.velocity = centre(state.velocity, block);
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  Vec3 angular = Vec3::Zero();
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = state.position.at(block, c) - motion.centre;
    moment += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
    angular += arm.cross(state.velocity.at(block, c) - motion.velocity);
  }
  motion.spin = moment.llt().solve(angular);
  motion.cornerSpeed = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = state.position.at(block, c) - motion.centre;
    motion.cornerSpeed = std::max(motion.cornerSpeed, (motion.velocity + motion.spin.cross(arm)).norm());
  }
  return motion;
}

}  // namespace springtower
