#pragma once

#include "core/vector.h"

namespace springtower {

/// The rotation R for which the sum of |y_i - R x_i|^2 is least, mirror images excluded (Kabsch 1976). `product`: the sum of
/// y_i x_i^T; precondition: at most one of its singular values is zero.
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& product);

}  // namespace springtower
