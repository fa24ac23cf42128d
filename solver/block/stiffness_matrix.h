#pragma once

#include "core/settings.h"
#include "core/state.h"

#include <array>

namespace springtower {

// A block's 24 degrees of freedom in the order in which implicit steps solve for them: eight vectors, the transform of the eight
// corners by the patterns 1, x, y, z, xy, xz, yz, xyz of their sides (Walsh-Hadamard). The first four are the affine part on
// which contacts act: centre C and mean edges E_x, E_y, E_z; the other four are warps of the faces, which only the block's own
// springs resist. Corner c lies at C + sum s_a/2 E_a + sum chi_p(c) W_p.

inline constexpr std::size_t kAffine = 4;
inline constexpr std::size_t kAffineFreedoms = 12;

/// The eight vectors of a block, [vector][component].
using ModeVectors = std::array<std::array<double, 3>, kCorners>;

/// A block's inertia over step^2 plus the stiffness of its springs at rest, N/m, in its own frame, with the warps eliminated: the
/// matrix S of the affine part (Schur complement), and what the elimination needs. A cuboid is symmetric under reflection, so the
/// warps fall into small groups: W_xyz couples to shear, all others only among themselves.
struct BlockJacobian {
  using Affine = std::array<std::array<double, kAffineFreedoms>, kAffineFreedoms>;
  Affine affine{};                              ///< S, index 3 vector + component
  std::array<double, kCorners> mass{};          ///< kg, of each of the eight vectors
  std::array<std::array<double, 3>, 3> pair{};  ///< [a]: inverse (11, 12, 22) for the components along b and c of W_ab, W_ac
  std::array<double, 6> triple{};               ///< inverse (11, 12, 13, 22, 23, 33) for W_yz along x, W_xz along y, W_xy along z
  std::array<double, 3> single{};               ///< [c]: inverse for W_xyz along c
  std::array<std::array<double, 2>, 3> shear{};  ///< [c]: W_xyz along c per E_a along b and per E_b along a (a < b, not c)
};

/// Computes this matrix. `massFactor` (1/s2) multiplies the mass matrix, `springFactor` the springs' stiffness (1 + damping time
/// over step).
BlockJacobian blockJacobian(const BlockModel& model, Inertia inertia, std::size_t block, double massFactor, double springFactor);

}  // namespace springtower
