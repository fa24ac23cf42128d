#include "solver/sleep/support_solver.h"

#include "core/tuning.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace springtower {

namespace {

using Wrench6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// Stiffness of a point's springs.
Eigen::Matrix3d stiffnessOf(const SupportPoint& point, double tangentialRatio) {
  if (point.state == SupportState::open) return Eigen::Matrix3d::Zero();
  const double across = point.state == SupportState::slip ? 0.0 : tangentialRatio;
  return (1.0 - across) * point.normal * point.normal.transpose() + across * Eigen::Matrix3d::Identity();
}

// The matrix of the displacement of a point by a rotation: rotation x arm.
Eigen::Matrix3d turning(const Vec3& arm) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
  return matrix;
}

// Released force, independent of the motion of the body: the whole force of an open point, and the excess friction of a slipping
// one.
Vec3 releasedForce(const SupportPoint& point) {
  if (point.state == SupportState::open) return -point.force;
  if (point.state == SupportState::stick) return Vec3::Zero();
  return point.slide - (point.force - point.normal.dot(point.force) * point.normal);
}

// Whether a point's state agrees with its force; otherwise sets the state for the next iteration.
bool updateContactState(SupportPoint& point, double slip_n) {
  if (point.state == SupportState::open) return true;
  const Vec3 force = point.force + point.added;
  const double push = point.normal.dot(force);
  if (push < 0.0) {
    point.state = SupportState::open;
    return false;
  }
  const Vec3 shear = force - push * point.normal;
  const bool slides = point.state == SupportState::slip;
  const double off_n = shear.norm() - point.friction * push;
  if (slides ? std::abs(off_n) <= slip_n : off_n <= slip_n) return true;
  point.slide = point.friction * push * shear.normalized();
  point.state = SupportState::slip;
  return false;
}

}  // namespace

bool redistribute(std::span<SupportPoint> points, const Vec3& force, const Vec3& torque, double length_m,
                  double tangentialRatio) {
  if (points.empty()) return false;
  constexpr double kRounding = 1e-6;  // of forces and of faces that are level: without friction nothing else is held
  double slip_n = 0.0;
  for (const SupportPoint& point : points)
    slip_n += (tuning::kSupportConeTolerance * point.friction + kRounding) * point.normal.dot(point.force);
  slip_n /= static_cast<double>(points.size());
  for (int round = 0; round < tuning::kMaxSupportRounds; ++round) {
    Mat6 stiffness = Mat6::Zero();
    Wrench6 load;
    load << -force, -torque / length_m;
    for (const SupportPoint& point : points) {
      const Eigen::Matrix3d turn = turning(point.arm / length_m);
      const Eigen::Matrix3d spring = stiffnessOf(point, tangentialRatio);
      const Eigen::Matrix3d coupled = spring * turn;
      stiffness.topLeftCorner<3, 3>() += spring;
      stiffness.bottomLeftCorner<3, 3>() += coupled.transpose();
      stiffness.bottomRightCorner<3, 3>() += turn.transpose() * coupled;
      const Vec3 given = releasedForce(point);
      load.head<3>() -= given;
      load.tail<3>() -= turn.transpose() * given;
    }
    const Eigen::LDLT<Mat6> factors(stiffness);
    if (!(factors.vectorD().minCoeff() > tuning::kMinSupportStiffness * factors.vectorD().maxCoeff())) return false;
    const Wrench6 moved = factors.solve(load);
    bool kept = true;
    for (SupportPoint& point : points) {
      const Vec3 motion = moved.head<3>() + turning(point.arm / length_m) * moved.tail<3>();
      point.added = releasedForce(point) + stiffnessOf(point, tangentialRatio) * motion;
      kept = updateContactState(point, slip_n) && kept;
    }
    if (kept) return true;
  }
  return false;
}

}  // namespace springtower
