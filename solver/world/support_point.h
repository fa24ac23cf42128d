#pragma once

#include "core/vector.h"

#include <cstdint>

namespace springtower {

/// State of a point that supports a body.
enum class SupportState : std::uint8_t { stick, slip, open };

/// A point that supports a rigid body, and its share of a load change.
struct SupportPoint {
  Vec3 arm = Vec3::Zero();     ///< m, from the reference point of the change's torque
  Vec3 normal = Vec3::Zero();  ///< unit, towards the body
  Vec3 force = Vec3::Zero();   ///< N, on the body before the change
  Vec3 added = Vec3::Zero();   ///< N, share of the change
  Vec3 slide = Vec3::Zero();   ///< N, its friction while it slips
  double friction = 0.0;       ///< Coulomb's coefficient
  SupportState state = SupportState::stick;
};

}  // namespace springtower
