#pragma once

#include "solver/block/inertia.h"
#include "solver/world/simulation.h"

#include <cstddef>

namespace springtower {

/// Momentum (kg m/s) and angular momentum (kg m2/s) of a scene, and the sums of their sizes over all blocks and corners, to which
/// a loss is compared.
struct Momenta {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();
  double linearSum = 0.0;
  double angularSum = 0.0;
};

/// The angular momentum is that about a place, m. With the mass matrix in force: the mean of a block's corners moves with the
/// whole mass, what differs from it with m / own each.
inline Momenta momentaOf(const Simulation& simulation, const Vec3& about) {
  Momenta sum;
  const double own = inverseMass(simulation.scene.settings.inertia).own;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    const double mass = simulation.model.mass[b];
    const Vec3 mean = centre(simulation.state.velocity, b);
    sum.linear += mass * mean;
    sum.linearSum += mass * mean.norm();
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 part = mass / kCorners * mean + mass / own * (simulation.state.velocity.at(b, c) - mean);
      const Vec3 arm = simulation.state.position.at(b, c) - about;
      sum.angular += arm.cross(part);
      sum.angularSum += arm.norm() * part.norm();
    }
  }
  return sum;
}

}  // namespace springtower
