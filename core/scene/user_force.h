#pragma once

#include "core/vector.h"

#include <optional>

namespace springtower {

/// A force and a torque on a block, along the world's axes.
struct Load {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, a couple: it has no net force
};

/// A force, a torque or both on one block over a time, constant or changing linearly from its start to its end. The force acts at
/// the centre (spread over the corners), at one corner, or at a point that is fixed in the block.
struct UserForce {
  int block = 0;                         ///< counted from 0
  int corner = -1;                       ///< 0..7, or -1 for the centre or `point`
  Vec3 force = Vec3::Zero();             ///< N, world axes, at the start
  double start_s = 0.0;                  ///< s
  double end_s = 0.0;                    ///< s
  Vec3 torque = Vec3::Zero();            ///< N m, world axes, at the start
  std::optional<Vec3> point = {};        ///< m, from the block's centre along its own axes; only without `corner`
  std::optional<Vec3> forceAtEnd = {};   ///< N, that the force has changed to at the end; without it, it is constant
  std::optional<Vec3> torqueAtEnd = {};  ///< N m, the same of the torque

  /// Whether it acts in some part of the time from `begin_s` to `until_s`, s.
  [[nodiscard]] bool actsWithin(double begin_s, double until_s) const { return start_s < until_s && end_s > begin_s; }

  /// Force and torque at a time (s), which is taken into the time in which it acts.
  [[nodiscard]] Load at(double time_s) const;

  /// Mean over the time from `begin_s` to `until_s`: times its length the impulse that it gives in it, exactly. Precondition:
  /// begin_s < until_s.
  [[nodiscard]] Load meanOver(double begin_s, double until_s) const;
};

}  // namespace springtower
