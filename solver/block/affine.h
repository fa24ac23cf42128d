#pragma once

#include "core/lanes.h"
#include "core/state.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

// Contacts act on a block through its affine part: centre C and the three mean edges E_x, E_y, E_z, 12 of its 24 degrees of
// freedom. A point with block coordinates xi (each -1/2 .. 1/2) lies at C + sum xi_a E_a, which is the mean of the corners with
// weights 1/8 + sum s_a xi_a / 4. Forces are distributed with the same weights, so momentum is conserved, and contacts never
// excite warps of the faces, on which they have no effect. A corner then has an inverse mass of 10/m instead of 22/m, which
// lengthens the stable step.

/// Affine part of a field on a block's corners: positions (m), velocities (m/s), or, as sums, forces (N): there `centre` is the
/// total force and `side[a]` the sum of forces times xi_a.
struct AffineField {
  std::array<double, 3> centre{};
  std::array<std::array<double, 3>, 3> side{};  ///< [axis a][component]
};

/// Affine part of a block's shape, with the derived vectors that contacts use.
struct BlockFrame {
  AffineField place;
  std::array<std::array<double, 3>, 3> dual{};    ///< 1/m; xi_a = dual[a] . (x - C)
  std::array<std::array<double, 3>, 3> normal{};  ///< unit; of the faces across axis a, towards its positive side
};

/// Axes of each face: the axis it is perpendicular to, its side (-1/2 or 1/2) on that axis, and the axes of the face's own u and
/// v (see kFaceCorners).
struct FaceAxes {
  std::size_t across;
  double side;
  std::size_t u;
  std::size_t v;
};
inline constexpr std::array<FaceAxes, kFaces> kFaceAxes = {
    {{0, -0.5, 2, 1}, {0, 0.5, 1, 2}, {1, -0.5, 0, 2}, {1, 0.5, 2, 0}, {2, -0.5, 1, 0}, {2, 0.5, 0, 1}}};

/// One component of the affine part of a field, from its values at the eight corners.
SPRINGTOWER_INLINE void affineOfComponent(const double* corners, std::size_t component, AffineField& field) {
  Lanes low, high;
  load(corners, low);
  load(corners + 4, high);
  const Lanes both = low + high;
  const Lanes up = high - low;
  const double even = both[0] + both[2];
  const double odd = both[1] + both[3];
  field.centre[component] = 0.125 * (even + odd);
  field.side[0][component] = 0.25 * (odd - even);
  field.side[1][component] = 0.25 * ((both[2] + both[3]) - (both[0] + both[1]));
  field.side[2][component] = 0.25 * sum(up);
}

/// Affine part of a field on one block.
AffineField affineField(const ParticleArray& values, std::size_t block);

/// Frame of one block. Precondition: it is not flat.
BlockFrame blockFrame(const ParticleArray& position, std::size_t block);

/// Velocity of the affine part of a block at a place of the world, m/s.
Vec3 velocityAt(const BlockFrame& frame, const AffineField& motion, const Vec3& place);

/// The frames of many blocks; entries of other blocks are unchanged.
void computeFrames(const ParticleArray& position, std::span<const std::int32_t> blocks, std::vector<BlockFrame>& frames);
void computeMotions(const ParticleArray& velocity, std::span<const std::int32_t> blocks, std::vector<AffineField>& motions);

}  // namespace springtower
