#pragma once

#include "solver/world/engine.h"

namespace springtower {

/// The contact law of a scene as it stands.
ContactLaw contactLaw(const Simulation& simulation);

/// How a manifold's points push now: its points brought up to date on a copy. Zeros where it is apart.
PointForces forcesNow(const Simulation& simulation, const ContactView& manifold);

/// What a manifold does to a block.
struct ContactWrench {
  Vec3 force = Vec3::Zero();      ///< N
  Vec3 torque = Vec3::Zero();     ///< N m, about the world's origin
  Vec3 direction = Vec3::Zero();  ///< unit normal, towards the block
};

/// Their sum on the upper block. All zero where the manifold is apart.
ContactWrench contactWrenchOnUpper(const Simulation& simulation, const ContactView& manifold);

}  // namespace springtower
