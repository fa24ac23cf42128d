#pragma once

#include "solver/world/engine.h"
#include "solver/world/island_step.h"

namespace springtower {

/// The contact law with a scene's present settings.
ContactLaw contactLaw(const Simulation& simulation);

/// Forces of a manifold's points at the present state, with a copy of the points advanced to it. Zeros where it is separated.
PointForces forcesNow(const Simulation& simulation, const ContactView& manifold);

/// Force and torque of a manifold on a block.
struct ContactWrench {
  Vec3 force = Vec3::Zero();      ///< N
  Vec3 torque = Vec3::Zero();     ///< N m, about the world's origin
  Vec3 direction = Vec3::Zero();  ///< unit normal, towards the block
};

/// The wrench on the upper block. All zero where the manifold is separated.
ContactWrench contactWrenchOnUpper(const Simulation& simulation, const ContactView& manifold);

/// Energy of one island, with gravity as at the frame's start, and of its contacts with each other, the floor and sleeping
/// blocks.
struct IslandEnergy {
  double kinetic_j = 0.0;
  double total_j = 0.0;  ///< with gravity's, and what blocks and contacts store
};
IslandEnergy islandEnergy(const IslandStep& step);

}  // namespace springtower
