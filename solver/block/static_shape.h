#pragma once

#include "core/settings.h"
#include "core/state.h"

#include <array>

namespace springtower {

// The shape that a block's springs give it under lasting forces. What counts of forces on the affine part is their first moment,
// M_ab = sum x_a f_b (J, own axes, x from the centre); the part of it that turns the block is balanced by the block's inertia.

/// How a block's shape follows such forces.
struct StaticResponse {
  std::array<double, 6> stretch{};  ///< 1/J, of the edges along x, y, z by M_xx, M_yy, M_zz: xx, xy, xz, yy, yz, zz
  std::array<double, 3> shear{};    ///< 1/J, [c]: of the angle between the edges along a and b by the part of M_ab that shears
  std::array<double, 3> warp{};     ///< m, [c]: of the corners along c, alternating over x y z, for that angle
  std::array<double, 3> inertia{};  ///< kg m2, second moment of mass along each axis
};

/// That of a block with the springs' stiffness at rest.
StaticResponse staticResponse(const BlockModel& model, Inertia inertia, std::size_t block);

/// Corners relative to the centre, m, along orthonormal axes: the first edge lies along x, the second in the plane of x and y.
using OwnCorners = std::array<std::array<double, kCorners>, 3>;

/// The shape under forces of the moment `load`, to first order in the strain.
void staticShape(const StaticResponse& response, const Vec3& dimensions, const Eigen::Matrix3d& load, OwnCorners& corner);

}  // namespace springtower
