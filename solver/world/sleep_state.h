#pragma once

#include "core/vector.h"
#include "solver/world/wake_reason.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// Rigid motion of a block at the start of its current sleep window.
struct SleepWindow {
  Vec3 centre = Vec3::Zero();    ///< m
  Vec3 velocity = Vec3::Zero();  ///< m/s
  Vec3 spin = Vec3::Zero();      ///< rad/s
  double age_s = 0.0;            ///< s, since the window began
};

/// Load change of a sleeping block when the support check last found that all sleeping blocks stay.
struct CheckedLoad {
  std::int32_t block = -1;
  Vec3 force = Vec3::Zero();   ///< N, change
  Vec3 torque = Vec3::Zero();  ///< N m, about the block's centre
};

/// A sleeping block that is to wake.
struct WakeRequest {
  std::int32_t block = -1;
  WakeReason reason = WakeReason::loadChange;
};

/// State of sleep between frames, beside which blocks sleep and how long each has been at rest. In snapshots.
struct SleepState {
  std::size_t awakeCount = 0;
  std::size_t movableCount = 0;           ///< blocks that are not fixed
  std::vector<SleepWindow> windows;       ///< [blocks]
  Vec3 gravity = Vec3::Zero();            ///< m/s2, when the first of the sleeping blocks fell asleep
  std::vector<CheckedLoad> checkedLoads;  ///< of all pushed blocks when the support check last passed; empty where it failed
};

}  // namespace springtower
