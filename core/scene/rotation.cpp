#include "core/scene/rotation.h"

#include "core/elementary.h"
#include "core/rotation_vector.h"

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace springtower {

Eigen::Quaterniond orientationOfRotation(const Vec3& rotation_deg) {
  return rotation(rotation_deg * (std::numbers::pi / 180.0));
}

Vec3 rotationOfOrientation(const Eigen::Quaterniond& orientation) {
  const double sign = orientation.w() < 0.0 ? -1.0 : 1.0;  // q and -q are one orientation; this one turns by less
  const Vec3 part = sign * orientation.vec();
  const double sine = part.norm();
  const double angle_deg = 2.0 * elementary::atan2(sine, sign * orientation.w()) * (180.0 / std::numbers::pi);
  const Vec3 exact = sine > 0.0 ? Vec3(part * (angle_deg / sine)) : Vec3(Vec3::Zero());
  Vec3 rounded = exact;
  for (const double scale : {1.0, 1e3, 1e6, 1e9, 1e12}) {
    rounded = (exact * scale).array().round().matrix() / scale;
    if (orientationOfRotation(rounded).coeffs() == orientation.coeffs()) return rounded;
  }
  return rounded;
}

}  // namespace springtower
