#pragma once

#include "core/block.h"
#include "core/ids.h"
#include "core/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// One vector per corner of every block, structure of arrays: component a of corner c of block b is component[a][8 b + c], so the
/// eight values of a block fill one cache line per component.
struct ParticleArray {
  std::array<AlignedVector<double>, 3> component;

  void resize(std::size_t blocks) {
    for (auto& values : component) values.assign(kCorners * blocks, 0.0);
  }
  [[nodiscard]] std::size_t blockCount() const { return component[0].size() / kCorners; }
  [[nodiscard]] double* values(std::size_t axis, std::size_t block) { return component[axis].data() + kCorners * block; }
  [[nodiscard]] const double* values(std::size_t axis, std::size_t block) const {
    return component[axis].data() + kCorners * block;
  }
  [[nodiscard]] Vec3 at(std::size_t block, std::size_t corner) const {
    const std::size_t i = kCorners * block + corner;
    return {component[0][i], component[1][i], component[2][i]};
  }
  void set(std::size_t block, std::size_t corner, const Vec3& value) {
    for (std::size_t a = 0; a < 3; ++a) component[a][kCorners * block + corner] = value[static_cast<Eigen::Index>(a)];
  }
  void add(std::size_t block, std::size_t corner, const Vec3& value) {
    for (std::size_t a = 0; a < 3; ++a) component[a][kCorners * block + corner] += value[static_cast<Eigen::Index>(a)];
  }
};

/// What moves: positions (m) and velocities (m/s) of all corners, [blocks][8].
struct MotionState {
  ParticleArray position;
  ParticleArray velocity;

  void resize(std::size_t blocks) {
    position.resize(blocks);
    velocity.resize(blocks);
  }
};

/// What does not move: the blocks' constants. The springs are [7][blocks], group-major (see core/block.h); one value serves the
/// four springs of a group.
struct BlockModel {
  std::vector<Vec3> dimensions;  ///< length along x, y, z when unrotated, m, [blocks]
  AlignedVector<double> mass;    ///< kg, [blocks]
  /// Square root of the coefficient of restitution: that of a pair is the product, their geometric mean. [blocks];
  /// empty where all have the scene's
  AlignedVector<double> rootRestitution;
  std::vector<std::uint8_t> fixed;                                   ///< 1 where a block is fixed, [blocks]; empty if none is
  std::array<AlignedVector<double>, kSpringGroups> restLength;       ///< m
  std::array<AlignedVector<double>, kSpringGroups> springStiffness;  ///< N/m
  std::array<AlignedVector<double>, kSpringGroups> springDamping;    ///< N s/m
  /// N/m, resistance of a block to warps beyond that of its springs (solver/block/springs.h), [blocks]; empty where none has any
  AlignedVector<double> warpStiffness;

  [[nodiscard]] std::size_t blockCount() const { return mass.size(); }
  [[nodiscard]] bool isFixed(std::size_t block) const { return !fixed.empty() && fixed[block] != 0; }
  [[nodiscard]] double warpStiffnessOf(std::size_t block) const { return warpStiffness.empty() ? 0.0 : warpStiffness[block]; }
};

/// Mean of a block's eight corners: its centre of mass in either inertia (m, or m/s for velocities).
inline Vec3 centre(const ParticleArray& values, std::size_t block) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t c = 0; c < kCorners; ++c) sum += values.at(block, c);
  return sum / static_cast<double>(kCorners);
}

/// Mean of a block's four edges along an axis (0 x, 1 y, 2 z), from the negative to the positive side, m; not normalised.
inline Vec3 meanEdge(const ParticleArray& position, std::size_t block, std::size_t axis) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t c = 0; c < kCorners; ++c) sum += cornerSide(c, axis) * position.at(block, c);
  return sum / 4.0;
}

/// The three mean edges of a block as columns, in the order of its axes: m from positions, m/s from velocities.
inline Eigen::Matrix3d meanEdges(const ParticleArray& values, std::size_t block) {
  Eigen::Matrix3d edges;
  for (std::size_t a = 0; a < 3; ++a) edges.col(static_cast<Eigen::Index>(a)) = meanEdge(values, block, a);
  return edges;
}

/// The cuboid that fits a (slightly deformed) block best: centre, unit axes and half lengths from the mean edges.
struct FittedBox {
  Vec3 centre;
  std::array<Vec3, 3> axis;
  Vec3 half;
};

/// Fits a cuboid to the eight corners of a block. Precondition: no mean edge has length zero.
inline FittedBox fittedBox(const ParticleArray& position, std::size_t block) {
  FittedBox box;
  box.centre = centre(position, block);
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 edge = meanEdge(position, block, a);
    const double length = edge.norm();
    box.axis[a] = edge / length;
    box.half[static_cast<Eigen::Index>(a)] = 0.5 * length;
  }
  return box;
}

}  // namespace springtower
