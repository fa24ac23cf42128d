#include "core/rotation_vector.h"

#include "core/elementary.h"

#include <cmath>

namespace springtower {

Eigen::Quaterniond rotationAbout(const Vec3& axis, double angle) {
  const double sine = elementary::sin(0.5 * angle);
  return {elementary::cos(0.5 * angle), sine * axis.x(), sine * axis.y(), sine * axis.z()};
}

Eigen::Quaterniond rotation(const Vec3& angle) {
  const double size = angle.norm();
  if (size == 0.0) return Eigen::Quaterniond::Identity();
  return rotationAbout(angle / size, size);
}

Vec3 rotationVector(const Eigen::Quaterniond& turn) {
  const double sine = turn.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  const double angle = 2.0 * elementary::atan2(sine, std::abs(turn.w()));
  return ((turn.w() < 0.0 ? -angle : angle) / sine) * turn.vec();
}

double angleBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
  const Eigen::Quaterniond way = from * to.conjugate();
  return 2.0 * elementary::atan2(way.vec().norm(), std::abs(way.w()));
}

Eigen::Quaterniond orientationBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to, double share) {
  Eigen::Quaterniond way = to * from.conjugate();
  if (way.w() < 0.0) way.coeffs() *= -1.0;
  return (rotation(share * rotationVector(way)) * from).normalized();
}

}  // namespace springtower
