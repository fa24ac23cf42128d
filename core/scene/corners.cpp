#include "core/scene/corners.h"

#include "core/block.h"
#include "core/nearest_rotation.h"

#include <memory>

namespace springtower {

namespace {

// From the centre to a corner of the cuboid, m, along its own axes.
Vec3 armOf(const BlockSpec& block, std::size_t corner) {
  Vec3 arm;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    arm[axis] = 0.5 * cornerSide(corner, a) * block.dimensions[axis];
  }
  return arm;
}

}  // namespace

CornerPlaces cornersOf(const BlockSpec& block) {
  CornerPlaces corners;
  for (std::size_t c = 0; c < kCorners; ++c) {
    Vec3 arm = armOf(block, c);
    if (block.strain) arm += (*block.strain)[c];
    corners[c] = block.centre + block.orientation * arm;
  }
  return corners;
}

void placeByCorners(const CornerPlaces& corners, BlockSpec& block) {
  block.centre.setZero();
  for (const Vec3& corner : corners) block.centre += corner / static_cast<double>(kCorners);
  Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < kCorners; ++c) product += (corners[c] - block.centre) * armOf(block, c).transpose();
  block.orientation = Eigen::Quaterniond(nearestRotation(product)).normalized();
  CornerPlaces strain;
  for (std::size_t c = 0; c < kCorners; ++c)
    strain[c] = block.orientation.conjugate() * (corners[c] - block.centre) - armOf(block, c);
  block.strain = std::make_shared<const CornerPlaces>(strain);
}

}  // namespace springtower
