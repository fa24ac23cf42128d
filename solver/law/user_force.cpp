#include "solver/law/user_force.h"

#include <Eigen/LU>

namespace springtower {

namespace {

// Weight of a corner in the affine part of a block at a point of it: 1/8 + sum s_a xi_a / 4.
double weightOf(std::size_t corner, const Vec3& share) {
  double weight = 0.125;
  for (std::size_t a = 0; a < 3; ++a) weight += 0.25 * cornerSide(corner, a) * share[static_cast<Eigen::Index>(a)];
  return weight;
}

// The point of a user force in the coordinates of its block, -1/2 .. 1/2 along each of its axes.
Vec3 shareOf(const BlockModel& model, const UserForce& user) {
  return user.point->cwiseQuotient(model.dimensions[static_cast<std::size_t>(user.block)]);
}

// Forces on the corners along those velocities that a rigid body has that turns: a couple, as the arms have no sum.
void addTorque(const ParticleArray& position, std::size_t block, const Vec3& torque, ParticleArray& force) {
  const Vec3 middle = centre(position, block);
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = position.at(block, c) - middle;
    moment += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
  }
  const Vec3 turn = moment.inverse() * torque;
  for (std::size_t c = 0; c < kCorners; ++c) force.add(block, c, turn.cross(position.at(block, c) - middle));
}

}  // namespace

Vec3 placeOf(const BlockModel& model, const ParticleArray& position, const UserForce& user) {
  const auto block = static_cast<std::size_t>(user.block);
  if (user.corner >= 0) return position.at(block, static_cast<std::size_t>(user.corner));
  if (!user.point) return centre(position, block);
  return centre(position, block) + meanEdges(position, block) * shareOf(model, user);
}

void addUserForce(const BlockModel& model, const ParticleArray& position, const UserForce& user, const Load& load,
                  ParticleArray& force) {
  const auto block = static_cast<std::size_t>(user.block);
  if (user.corner >= 0) {
    force.add(block, static_cast<std::size_t>(user.corner), load.force);
  } else if (user.point) {
    const Vec3 share = shareOf(model, user);
    for (std::size_t c = 0; c < kCorners; ++c) force.add(block, c, weightOf(c, share) * load.force);
  } else {
    for (std::size_t c = 0; c < kCorners; ++c) force.add(block, c, load.force / static_cast<double>(kCorners));
  }
  if (!load.torque.isZero(0.0)) addTorque(position, block, load.torque, force);
}

}  // namespace springtower
