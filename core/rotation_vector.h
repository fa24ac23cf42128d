#pragma once

#include "core/vector.h"

namespace springtower {

// Rotations by an axis and an angle, as Eigen's AngleAxis and slerp compute them, but with elementary functions that are the same
// on every machine (core/elementary.h).

/// The rotation about an axis (unit) by an angle, rad.
Eigen::Quaterniond rotationAbout(const Vec3& axis, double angle);

/// The rotation by a rotation vector, axis times angle, rad.
Eigen::Quaterniond rotation(const Vec3& angle);

/// The rotation vector of a rotation, rad, no longer than pi. Precondition: `turn` is unit.
Vec3 rotationVector(const Eigen::Quaterniond& turn);

/// The angle of the rotation from one orientation to another, rad, 0 to pi. Precondition: both are unit.
double angleBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to);

/// The orientation on the shorter way from one to another, at a share of the way, 0 to 1 (spherical linear interpolation;
/// Shoemake 1985). Precondition: both are unit.
Eigen::Quaterniond orientationBetween(const Eigen::Quaterniond& from, const Eigen::Quaterniond& to, double share);

}  // namespace springtower
