#pragma once

#include "core/lanes.h"
#include "solver/block/stiffness_matrix.h"

#include <array>

namespace springtower {

namespace block_modes {

// Patterns of the vectors by the bits of x, y, z: 1, x, y, z, xy, xz, yz, xyz.
inline constexpr std::array<std::size_t, kCorners> kPattern = {0, 1, 2, 4, 3, 5, 6, 7};
inline constexpr std::size_t kXY = 4;
inline constexpr std::size_t kXZ = 5;
inline constexpr std::size_t kYZ = 6;
inline constexpr std::size_t kXYZ = 7;

// For each axis a the two other axes b < c and the warps W_ab and W_ac.
struct Others {
  std::size_t b;
  std::size_t c;
  std::size_t withB;
  std::size_t withC;
};
inline constexpr std::array<Others, 3> kOthers = {{{1, 2, kXY, kXZ}, {0, 2, kXY, kYZ}, {0, 1, kXZ, kYZ}}};

constexpr double sign(std::size_t corner, std::size_t pattern) {
  double product = 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (((pattern >> a) & 1U) != 0U) product *= cornerSide(corner, a);
  }
  return product;
}

// Sums and differences of eight numbers by the bits of their index: result[p] = sum_c chi_p(c) v_c, with chi the product of the
// sides of the set bits; a side is -1 where the bit is 0.
SPRINGTOWER_INLINE void transform(const double* v, double (&t)[kCorners]) {
  const double x0 = v[0] + v[1];
  const double x1 = v[2] + v[3];
  const double x2 = v[4] + v[5];
  const double x3 = v[6] + v[7];
  const double d0 = v[1] - v[0];
  const double d1 = v[3] - v[2];
  const double d2 = v[5] - v[4];
  const double d3 = v[7] - v[6];
  const double xx0 = x0 + x1;
  const double xx1 = x2 + x3;
  const double dx0 = d0 + d1;
  const double dx1 = d2 + d3;
  const double xd0 = x1 - x0;
  const double xd1 = x3 - x2;
  const double dd0 = d1 - d0;
  const double dd1 = d3 - d2;
  t[0] = xx0 + xx1;
  t[4] = xx1 - xx0;
  t[1] = dx0 + dx1;
  t[5] = dx1 - dx0;
  t[2] = xd0 + xd1;
  t[6] = xd1 - xd0;
  t[3] = dd0 + dd1;
  t[7] = dd1 - dd0;
}

}  // namespace block_modes

/// Generalised forces of the eight vectors for forces on the corners (N): sums weighted by each corner's pattern.
SPRINGTOWER_INLINE void modeForces(const ParticleArray& force, std::size_t block, ModeVectors& modes) {
  using namespace block_modes;
  for (std::size_t a = 0; a < 3; ++a) {
    double t[kCorners];
    transform(force.values(a, block), t);
    for (std::size_t m = 0; m < kCorners; ++m) modes[m][a] = (m >= 1 && m < kAffine ? 0.5 : 1.0) * t[kPattern[m]];
  }
}

/// Residual of Newton's law at an implicit step's end, N, as generalised forces of the eight vectors: the forces minus mass times
/// rate (1/s2) times the distance of the corners from where they end without forces. Once the lengths of the vectors are divided
/// out, only the mass of the centre differs from the other seven, so one transform is enough.
SPRINGTOWER_INLINE void residualForces(const BlockJacobian& jacobian, double rate, const ParticleArray& force,
                                       const ParticleArray& target, const ParticleArray& position, std::size_t block,
                                       ModeVectors& modes) {
  using namespace block_modes;
  const double corner = rate * jacobian.mass[kXYZ] / static_cast<double>(kCorners);
  const double mean = rate * jacobian.mass[0] / static_cast<double>(kCorners);
  for (std::size_t a = 0; a < 3; ++a) {
    const double* f = force.values(a, block);
    const double* to = target.values(a, block);
    const double* x = position.values(a, block);
    double sum[kCorners];
    double apart = 0.0;
    for (std::size_t c = 0; c < kCorners; ++c) {
      const double d = to[c] - x[c];
      apart += d;
      sum[c] = f[c] + corner * d;
    }
    double t[kCorners];
    transform(sum, t);
    modes[0][a] = t[0] + (mean - corner) * apart;
    for (std::size_t m = 1; m < kCorners; ++m) modes[m][a] = (m < kAffine ? 0.5 : 1.0) * t[kPattern[m]];
  }
}

/// Adds a change of the eight vectors to the corners.
SPRINGTOWER_INLINE void addModes(const ModeVectors& modes, ParticleArray& values, std::size_t block) {
  using namespace block_modes;
  for (std::size_t a = 0; a < 3; ++a) {
    double* v = values.values(a, block);
    const double up[4] = {modes[0][a], 0.5 * modes[1][a], 0.5 * modes[2][a], modes[kXY][a]};
    const double zed[4] = {0.5 * modes[3][a], modes[kXZ][a], modes[kYZ][a], modes[kXYZ][a]};
    for (std::size_t half = 0; half < 2; ++half) {
      const double side = half == 0 ? -1.0 : 1.0;
      const double one = up[0] + side * zed[0];
      const double x = up[1] + side * zed[1];
      const double y = up[2] + side * zed[2];
      const double xy = up[3] + side * zed[3];
      v[4 * half + 0] += one - x - y + xy;
      v[4 * half + 1] += one + x - y - xy;
      v[4 * half + 2] += one - x + y - xy;
      v[4 * half + 3] += one + x + y + xy;
    }
  }
}

/// Eliminates the warps from a residual r (N, in the block's frame): changes the affine part of `residual` to the right-hand side
/// of S dz = r.
SPRINGTOWER_INLINE void eliminateWarps(const BlockJacobian& jacobian, ModeVectors& residual) {
  using namespace block_modes;
  for (std::size_t c = 0; c < 3; ++c) {
    const Others& o = kOthers[c];
    residual[1 + o.b][o.c] -= jacobian.shear[c][0] * residual[kXYZ][c];
    residual[1 + o.c][o.b] -= jacobian.shear[c][1] * residual[kXYZ][c];
  }
}

/// Changes of the warps (m) for a known affine part of `change`; `residual` is the input of eliminateWarps.
SPRINGTOWER_INLINE void recoverWarps(const BlockJacobian& jacobian, const ModeVectors& residual, ModeVectors& change) {
  using namespace block_modes;
  for (std::size_t a = 0; a < 3; ++a) {
    const Others& o = kOthers[a];
    const double first = residual[o.withB][o.b];
    const double second = residual[o.withC][o.c];
    change[o.withB][o.b] = jacobian.pair[a][0] * first + jacobian.pair[a][1] * second;
    change[o.withC][o.c] = jacobian.pair[a][1] * first + jacobian.pair[a][2] * second;
    change[kXYZ][a] = jacobian.single[a] * residual[kXYZ][a] - jacobian.shear[a][0] * change[1 + o.b][o.c] -
                      jacobian.shear[a][1] * change[1 + o.c][o.b];
  }
  const double r[3] = {residual[kYZ][0], residual[kXZ][1], residual[kXY][2]};
  const auto& t = jacobian.triple;
  change[kYZ][0] = t[0] * r[0] + t[1] * r[1] + t[2] * r[2];
  change[kXZ][1] = t[1] * r[0] + t[3] * r[1] + t[4] * r[2];
  change[kXY][2] = t[2] * r[0] + t[4] * r[1] + t[5] * r[2];
}

}  // namespace springtower
