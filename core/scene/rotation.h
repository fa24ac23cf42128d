#pragma once

#include "core/vector.h"

namespace springtower {

/// The orientation that scene files write as `rotation_deg`: axis times angle, degrees. The result is unit to rounding.
Eigen::Quaterniond orientationOfRotation(const Vec3& rotation_deg);

/// What to write as `rotation_deg` for an orientation, degrees, of an angle up to 180: with as few decimals as give the same
/// orientation to the last bit when it is read again. Where no number of twelve decimals does, the one of twelve that is nearest
/// (then the orientation read differs by 1e-14 at most). Precondition: the orientation is unit.
Vec3 rotationOfOrientation(const Eigen::Quaterniond& orientation);

}  // namespace springtower
