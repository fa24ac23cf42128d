#include "solver/block/affine.h"

#include "core/lanes.h"

namespace springtower {

namespace {

SPRINGTOWER_INLINE void affine(const ParticleArray& values, std::size_t block, AffineField& field) {
  for (std::size_t a = 0; a < 3; ++a) affineOfComponent(values.values(a, block), a, field);
}

SPRINGTOWER_INLINE void cross(const std::array<double, 3>& p, const std::array<double, 3>& q, std::array<double, 3>& result) {
  result[0] = p[1] * q[2] - p[2] * q[1];
  result[1] = p[2] * q[0] - p[0] * q[2];
  result[2] = p[0] * q[1] - p[1] * q[0];
}

SPRINGTOWER_INLINE void frame(const ParticleArray& position, std::size_t block, BlockFrame& result) {
  affine(position, block, result.place);
  const auto& side = result.place.side;
  cross(side[1], side[2], result.dual[0]);
  cross(side[2], side[0], result.dual[1]);
  cross(side[0], side[1], result.dual[2]);
  const double volume = side[0][0] * result.dual[0][0] + side[0][1] * result.dual[0][1] + side[0][2] * result.dual[0][2];
  const double inverse = 1.0 / volume;
  for (std::size_t a = 0; a < 3; ++a) {
    auto& dual = result.dual[a];
    const double length = __builtin_sqrt(dual[0] * dual[0] + dual[1] * dual[1] + dual[2] * dual[2]);
    const double inverseLength = 1.0 / length;
    for (std::size_t k = 0; k < 3; ++k) {
      result.normal[a][k] = dual[k] * inverseLength;
      dual[k] *= inverse;
    }
  }
}

}  // namespace

AffineField affineField(const ParticleArray& values, std::size_t block) {
  AffineField field;
  affine(values, block, field);
  return field;
}

BlockFrame blockFrame(const ParticleArray& position, std::size_t block) {
  BlockFrame result;
  frame(position, block, result);
  return result;
}

Vec3 velocityAt(const BlockFrame& frame, const AffineField& motion, const Vec3& place) {
  Vec3 velocity(motion.centre[0], motion.centre[1], motion.centre[2]);
  const Vec3 arm = place - Vec3(frame.place.centre[0], frame.place.centre[1], frame.place.centre[2]);
  for (std::size_t a = 0; a < 3; ++a) {
    const double along = Vec3(frame.dual[a][0], frame.dual[a][1], frame.dual[a][2]).dot(arm);
    velocity += along * Vec3(motion.side[a][0], motion.side[a][1], motion.side[a][2]);
  }
  return velocity;
}

SPRINGTOWER_KERNEL
void computeFrames(const ParticleArray& position, std::span<const std::int32_t> blocks, std::vector<BlockFrame>& frames) {
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    frame(position, b, frames[b]);
  }
}

SPRINGTOWER_KERNEL
void computeMotions(const ParticleArray& velocity, std::span<const std::int32_t> blocks, std::vector<AffineField>& motions) {
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    affine(velocity, b, motions[b]);
  }
}

}  // namespace springtower
