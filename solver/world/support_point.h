#pragma once

#include "core/vector.h"

#include <cstdint>

namespace springtower {

/// What a point does on which a body rests.
enum class SupportState : std::uint8_t { stick, slip, open };

/// A point on which a rigid body rests, and what it takes up of a change.
struct SupportPoint {
  Vec3 arm = Vec3::Zero();     ///< m, from where the change's torque is taken about
  Vec3 normal = Vec3::Zero();  ///< unit, towards the body
  Vec3 force = Vec3::Zero();   ///< N, on the body before the change
  Vec3 added = Vec3::Zero();   ///< N, by the change
  Vec3 slide = Vec3::Zero();   ///< N, its friction where it slides
  double friction = 0.0;       ///< Coulomb's coefficient
  SupportState state = SupportState::stick;
};

}  // namespace springtower
