#pragma once

#include "core/scene/scene.h"
#include "scenarios/loose.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <cmath>
#include <numbers>

namespace springtower {

/// Makes a scene step with steps of exactly `step_s`, `steps` of them a frame, whether that is stable or not.
inline void setSteps(Settings& settings, Method method, double step_s, int steps) {
  settings.method = method;
  settings.frame_s = step_s * steps;
  settings.substeps = steps;
  settings.tolerance_m = kBlockTolerance_m;
  settings.allowUnstable = true;
}

/// One block without gravity, floor or dashpots, whose stiffest mode has the angular frequency `omega` (rad/s).
Simulation ringingBlock(Inertia inertia, Method method, double step_s, int steps, double omega);

using Vector24 = Eigen::Matrix<double, 24, 1>;
using Matrix24 = Eigen::Matrix<double, 24, 24>;

/// The numbers of one block's corners as a vector: component a of corner c at 3 c + a.
Vector24 cornerVector(const ParticleArray& values, std::size_t block);

void addCornerVector(const Vector24& change, ParticleArray& values, std::size_t block);

/// Mass matrix of a block's corners, kg: the mean moves with the whole mass, what differs from it with m / own each.
Matrix24 massMatrix(Inertia inertia, double mass);

/// A block's stiffest mode, from the spring forces themselves by central differences; unit largest component.
Vector24 stiffestMode(const Simulation& simulation, std::size_t block);

/// The three breathing modes of a block (sides stretch, angles stay), from theory: squares of the angular frequencies (1/s2,
/// ascending) and the relative stretches of the sides as columns. Strains e have the energy 1/2 e^T A e with A_ij the sum over
/// the springs of k L^2 n_i^2 n_j^2, and the kinetic energy 1/2 sum J_i (de_i/dt)^2 with J_i the second moment of the mass:
/// m side^2 / 12 for a cuboid, m side^2 / 4 for eight lumps at the corners.
struct BreathingModes {
  Vec3 squares;
  Eigen::Matrix3d stretches;
};
BreathingModes breathingModes(const BlockModel& model, Inertia inertia, std::size_t block);

/// Stretches the sides of an undeformed block along the world's axes by these shares.
inline void stretch(ParticleArray& position, std::size_t block, const Vec3& shares) {
  const Vec3 middle = centre(position, block);
  for (std::size_t c = 0; c < kCorners; ++c) position.add(block, c, shares.cwiseProduct(position.at(block, c) - middle));
}

/// A constant force on a block (N, world axes) over a time (s), at a corner or, for -1, at the centre.
UserForce constantForce(int block, int corner, const Vec3& force_n, double start_s, double end_s);

/// Momentum (kg m/s) and angular momentum about the origin (kg m2/s) of all blocks, with the inertia in force.
struct Momentum {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();
};
Momentum momentum(const Simulation& simulation);

/// Steps a scene for a time, which is rounded to whole frames.
inline void stepFor(Simulation& simulation, double seconds) {
  const long frames = std::lround(seconds / simulation.scene.settings.frame_s);
  for (long frame = 0; frame < frames; ++frame) prepareAndStep(simulation);
}

constexpr double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

}  // namespace springtower
