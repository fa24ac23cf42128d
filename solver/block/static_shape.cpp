#include "solver/block/static_shape.h"

#include "solver/block/modes.h"
#include "solver/block/stiffness_matrix.h"

#include <Eigen/LU>

namespace springtower {

namespace {

using namespace block_modes;

// Index of an edge's component in the stiffness matrix of the affine part.
std::size_t edgeAt(std::size_t edge, std::size_t component) {
  return 3 * (1 + edge) + component;
}

}  // namespace

StaticResponse staticResponse(const BlockModel& model, Inertia inertia, std::size_t block) {
  const BlockJacobian springs = blockJacobian(model, inertia, block, 0.0, 1.0);
  const Vec3& size = model.dimensions[block];
  StaticResponse response;
  Eigen::Matrix3d stiffness;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    response.inertia[a] = springs.mass[1 + a] * size[i] * size[i];
    for (std::size_t b = 0; b < 3; ++b) {
      const auto j = static_cast<Eigen::Index>(b);
      stiffness(i, j) = size[i] * size[j] * springs.affine[edgeAt(a, a)][edgeAt(b, b)];
    }
  }
  const Eigen::Matrix3d stretch = stiffness.inverse();
  response.stretch = {stretch(0, 0), stretch(0, 1), stretch(0, 2), stretch(1, 1), stretch(1, 2), stretch(2, 2)};
  for (std::size_t c = 0; c < 3; ++c) {
    const Others& o = kOthers[c];
    const double edge = size[static_cast<Eigen::Index>(o.c)];
    response.shear[c] = 1.0 / (edge * edge * springs.affine[edgeAt(o.c, o.b)][edgeAt(o.c, o.b)]);
    response.warp[c] = -springs.shear[c][1] * edge;
  }
  return response;
}

void staticShape(const StaticResponse& response, const Vec3& dimensions, const Eigen::Matrix3d& load, OwnCorners& corner) {
  const std::array<double, 6>& s = response.stretch;
  const double long0 = s[0] * load(0, 0) + s[1] * load(1, 1) + s[2] * load(2, 2);
  const double long1 = s[1] * load(0, 0) + s[3] * load(1, 1) + s[4] * load(2, 2);
  const double long2 = s[2] * load(0, 0) + s[4] * load(1, 1) + s[5] * load(2, 2);
  // The part of M_ab and M_ba that turns the block accelerates its corners, and leaves the same in both.
  const auto angle = [&](std::size_t c) {
    const Others& o = kOthers[c];
    const auto a = static_cast<Eigen::Index>(o.b);
    const auto b = static_cast<Eigen::Index>(o.c);
    const double first = response.inertia[o.b];
    const double second = response.inertia[o.c];
    return response.shear[c] * (second * load(a, b) + first * load(b, a)) / (first + second);
  };
  const std::array<double, 3> turned = {angle(0), angle(1), angle(2)};
  const Vec3 half = 0.5 * dimensions;
  for (std::size_t k = 0; k < kCorners; ++k) {
    const double x = half[0] * cornerSide(k, 0);
    const double y = half[1] * cornerSide(k, 1);
    const double z = half[2] * cornerSide(k, 2);
    const double alternating = sign(k, kXYZ);
    corner[0][k] = (1.0 + long0) * x + turned[2] * y + turned[1] * z + alternating * response.warp[0] * turned[0];
    corner[1][k] = (1.0 + long1) * y + turned[0] * z + alternating * response.warp[1] * turned[1];
    corner[2][k] = (1.0 + long2) * z + alternating * response.warp[2] * turned[2];
  }
}

}  // namespace springtower
