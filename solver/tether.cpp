#include "solver/tether.h"

#include "solver/inertia.h"

namespace springtower {

namespace {

// A vector shortened to a length.
Vec3 within(const Vec3& vector, double length) {
  const double norm = vector.norm();
  return norm > length ? Vec3(vector * (length / norm)) : vector;
}

}  // namespace

GripForce tetherForces(const Tether& tether, const BlockModel& model, const MotionState& state, double time_s,
                       std::array<Vec3, kCorners>& corner) {
  const std::size_t b = index(tether.block);
  const Vec3 middle = centre(state.position, b);
  const Vec3 velocity = centre(state.velocity, b);
  const double ahead_s = time_s - tether.time_s;
  GripForce sum;
  const Vec3 missing = tether.place + ahead_s * tether.velocity - middle;
  const Vec3 distance = within(missing, tether.limit_n / tether.stiffness_n_m);
  const Vec3 wanted = tether.stiffness_n_m * distance + tether.damping_n_s_m * (tether.velocity - velocity) + tether.carried_n;
  const Vec3 along = wanted.dot(tether.line) * tether.line;
  const Vec3 across = wanted - along;
  sum.force = within(tether.line.isZero(0.0) ? wanted : Vec3(along + within(across, tether.acrossLimit_n)), tether.limit_n);
  sum.acrossLimited = !tether.line.isZero(0.0) && across.norm() > tether.acrossLimit_n;
  sum.limited = wanted.norm() > tether.limit_n || distance.norm() < missing.norm();

  const Eigen::Matrix3d axes = (rotation(ahead_s * tether.spin) * tether.turn).toRotationMatrix();
  // It holds the mean edges: corners that warp are left to the block's own springs.
  const Eigen::Matrix3d edges = meanEdges(state.position, b);
  const Eigen::Matrix3d edgeRates = meanEdges(state.velocity, b);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 sides = 0.5 * Vec3(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
    const Vec3 arm = axes * sides.cwiseProduct(model.dimensions[b]);
    const Vec3 own = edges * sides;
    corner[c] =
        tether.cornerStiffness_n_m * (arm - own) + tether.cornerDamping_n_s_m * (tether.spin.cross(arm) - edgeRates * sides);
    sum.torque += own.cross(corner[c]);
  }
  const double torque = sum.torque.norm();
  const double share = torque > tether.torqueLimit_n_m ? tether.torqueLimit_n_m / torque : 1.0;
  sum.turnLimited = share < 1.0;
  sum.torque *= share;
  for (Vec3& force : corner) force = share * force + sum.force / static_cast<double>(kCorners);
  return sum;
}

}  // namespace springtower
