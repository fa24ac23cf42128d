#pragma once

#include "core/settings.h"
#include "core/state.h"
#include "narrowphase/manifold.h"

#include <cstddef>
#include <cstdint>

namespace springtower {

/// How forces on the eight corners of a block accelerate them: a_i = (own f_i - shared F) / m with F the sum of the f_i.
/// `lumped`: eight masses m/8, own = 8, shared = 0 (the report's). `cuboid`: the mass matrix of a block whose particles carry a
/// uniform cuboid, own = 24, shared = 2; its mass and moments of inertia are exactly the cuboid's.
struct InverseMass {
  double own;
  double shared;
};

constexpr InverseMass inverseMass(Inertia inertia) {
  return inertia == Inertia::cuboid ? InverseMass{24.0, 2.0} : InverseMass{8.0, 0.0};
}

/// Largest inverse mass, times the block's mass, of a point on which contacts act: a corner of the block's affine part, whose
/// weights on the eight corners have squares that sum to 1/2.
constexpr double affineCornerInverseMass(Inertia inertia) {
  return 0.5 * inverseMass(inertia).own - inverseMass(inertia).shared;
}

/// Reduced mass of two blocks, kg; of one on the floor, numbered -1, or on a fixed block its own. Precondition: `upper` is not
/// the floor, and not both are fixed.
inline double reducedMass(const BlockModel& model, std::int32_t upper, std::int32_t lower) {
  const auto a = static_cast<std::size_t>(upper);
  const auto b = static_cast<std::size_t>(lower);
  if (lower < 0) return model.mass[a];
  if (!model.fixed.empty()) {
    if (model.fixed[b] != 0) return model.mass[a];
    if (model.fixed[a] != 0) return model.mass[b];
  }
  return model.mass[a] * model.mass[b] / (model.mass[a] + model.mass[b]);
}
inline double reducedMass(const BlockModel& model, const ManifoldShape& manifold) {
  return reducedMass(model, manifold.upper, manifold.lower);
}

/// Inner product p^T M q of two fields on a block's corners, in units of its mass: the mean's part has full weight, the deviation
/// of each corner from the mean 1/own.
inline double massProduct(Inertia inertia, const ParticleArray& p, const ParticleArray& q, std::size_t block) {
  const InverseMass inverse = inverseMass(inertia);
  double total = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double* u = p.values(a, block);
    const double* v = q.values(a, block);
    double sumU = 0.0;
    double sumV = 0.0;
    double product = 0.0;
    for (std::size_t c = 0; c < kCorners; ++c) {
      sumU += u[c];
      sumV += v[c];
      product += u[c] * v[c];
    }
    const double mean = sumU * sumV / static_cast<double>(kCorners * kCorners);
    total += mean + (product - static_cast<double>(kCorners) * mean) / inverse.own;
  }
  return total;
}

/// Rigid part of a block's motion: velocity of its centre and angular velocity, from momentum and angular momentum with the
/// corners' own moments (in either inertia the corners' deviations have equal mass, so their common factor drops out).
struct RigidMotion {
  Vec3 centre;
  Vec3 velocity;
  Vec3 spin;           ///< rad/s
  double cornerSpeed;  ///< m/s, of the fastest corner under this motion
};
RigidMotion rigidMotion(const MotionState& state, std::size_t block);

}  // namespace springtower
