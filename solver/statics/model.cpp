#include "solver/statics/model.h"

#include "core/error.h"

#include <algorithm>

namespace springtower {
namespace {

// The normal and two tangents; for level contacts the tangents are the world's x and y.
Eigen::Matrix3d frameOf(const Vec3& normal) {
  const Vec3 hint = std::abs(normal.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  Eigen::Matrix3d frame;
  frame.col(0) = normal;
  frame.col(1) = (hint - normal * normal.dot(hint)).normalized();
  frame.col(2) = normal.cross(frame.col(1));
  return frame;
}

}  // namespace

Eigen::Matrix<double, 6, 3> StaticsModel::wrench(const ForcePoint& point, bool onUpper) const {
  const std::int32_t block = onUpper ? point.upper : point.lower;
  const Vec3 arm = (point.place - centre[static_cast<std::size_t>(block)]) / lengthUnit_m;
  Eigen::Matrix<double, 6, 3> result;
  for (Eigen::Index a = 0; a < 3; ++a) {
    result.block<3, 1>(0, a) = point.frame.col(a);
    result.block<3, 1>(3, a) = arm.cross(point.frame.col(a));
  }
  if (!onUpper) result = -result;
  return result;
}

Eigen::VectorXd StaticsModel::gravityLoad(const Vec3& gravity) const {
  Eigen::VectorXd load = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * blockCount()));
  for (std::size_t b = 0; b < blockCount(); ++b) load.segment<3>(static_cast<Eigen::Index>(6 * b)) = weight[b] * gravity;
  return load;
}

StaticsModel staticsModel(const Scene& scene, std::span<const FacePair> facings) {
  if (scene.blocks.empty()) throw InputError("statics: expected at least one block, got none");
  if (scene.gravity.magnitude <= 0.0) throw InputError("statics: expected gravity above 0, got none");
  StaticsModel model;
  double mass = 0.0;
  double height = 0.0;
  double count = 0.0;  // of blocks that are not fixed
  for (const BlockSpec& block : scene.blocks) {
    if (block.fixed) continue;
    mass += block.mass;
    height += block.dimensions.minCoeff();
    count += 1.0;
  }
  if (count == 0.0) throw InputError("statics: expected at least one block that is not fixed, got fixed blocks only");
  model.forceUnit_n = mass / count * scene.gravity.magnitude;
  model.lengthUnit_m = height / count;
  for (const BlockSpec& block : scene.blocks) {
    model.centre.push_back(block.centre);
    model.weight.push_back(block.fixed ? 0.0 : block.mass * count / mass);
  }
  const FrictionTable friction(scene);
  for (std::size_t f = 0; f < facings.size(); ++f) {
    const auto isGround = [&](BlockId block) { return block == kFloor || scene.blocks[index(block)].fixed; };
    const bool upsideDown = isGround(facings[f].upper);
    if (upsideDown && isGround(facings[f].lower)) continue;
    const auto upper = static_cast<std::int32_t>(upsideDown ? facings[f].lower : facings[f].upper);
    const auto lower = upsideDown || isGround(facings[f].lower) ? -1 : static_cast<std::int32_t>(facings[f].lower);
    const Eigen::Matrix3d frame = frameOf(upsideDown ? Vec3(-facings[f].normal) : facings[f].normal);
    const double coefficient =
        friction.of(static_cast<std::int32_t>(facings[f].upper), static_cast<std::int32_t>(facings[f].lower)).staticFriction;
    model.friction = model.points.empty() ? coefficient : std::max(model.friction, coefficient);
    for (const FacingPoint& point : facings[f].points) {
      model.points.push_back({upper, lower, point.place, frame, point.gap_m, coefficient, f});
    }
  }
  if (model.points.empty()) model.friction = scene.staticFriction;
  return model;
}

}  // namespace springtower
