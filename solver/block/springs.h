#pragma once

#include "core/state.h"
#include "solver/block/affine.h"
#include "solver/block/static_shape.h"

#include <cstdint>
#include <span>

namespace springtower {

/// Forces of the 28 springs of each listed block on its corners (report Eq. 4.1 to 4.3: linear in the change of length, and a
/// dashpot along the spring), and of its warps, plus the contact forces on the blocks' affine parts, N; `force` of these blocks
/// is overwritten. Springs are evaluated group by group, four at a time.
void springForces(const BlockModel& model, const MotionState& state, std::span<const std::int32_t> blocks,
                  std::span<const AffineField> contactForce, ParticleArray& force);

/// Energy stored in the springs and warps of one block, J.
double springEnergy(const BlockModel& model, const ParticleArray& position, std::size_t block);

/// The same with its corners at these places in any axes, m.
double springEnergy(const BlockModel& model, const OwnCorners& corner, std::size_t block);

/// Largest relative change of length of any spring of one block.
double springStrain(const BlockModel& model, const ParticleArray& position, std::size_t block);

/// Sets a block's springs: rest lengths from its dimensions, stiffness so that an upright edge of length `referenceLength_m` has
/// `stiffness_n_m` and every other spring in inverse proportion to its length (equal Young's modulus and section), and dashpots
/// that are `dampingTime_s` times the stiffness.
void setSprings(BlockModel& model, std::size_t block, double stiffness_n_m, double referenceLength_m, double dampingTime_s);

/// Sets a block's resistance to warps. Contacts act on its affine part, so a load (`load_n`, N) does work on it where its
/// ends turn about its length against one another by an angle t: its mean edges get shorter, by t^2 / 8 of a side. Springs of a
/// slender block resist that, relative to its load, as the cube of its thickness over its length. What they lack for
/// tuning::kTwistSafety times the load is a stiffness of all warps: the energy is half of it times the squares of the four
/// patterns by which the corners differ from an affine field (hourglass stiffness, Flanagan & Belytschko 1981). None in blocks
/// that are not slender. Precondition: its springs are set.
void setWarpStiffness(BlockModel& model, std::size_t block, double load_n);

/// Stiffness of a block's springs and of its warps at rest, in its own frame, N/m: 24 x 24, by corner and component.
Eigen::Matrix<double, 24, 24> springStiffnessMatrix(const BlockModel& model, std::size_t block);

}  // namespace springtower
