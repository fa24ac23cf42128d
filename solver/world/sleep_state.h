#pragma once

#include "core/vector.h"
#include "solver/world/wake_reason.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// What is known of a block's rest: its rigid motion when the window that is running began.
struct SleepWindow {
  Vec3 centre = Vec3::Zero();    ///< m
  Vec3 velocity = Vec3::Zero();  ///< m/s
  Vec3 spin = Vec3::Zero();      ///< rad/s
  double age_s = 0.0;            ///< s since
};

/// How a sleeping block was pushed when all sleepers stayed.
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

/// What sleep knows from frame to frame, beside which blocks sleep and for how long each has been at rest. In snapshots.
struct SleepState {
  std::size_t awakeCount = 0;
  std::vector<SleepWindow> windows;       ///< [blocks]
  Vec3 gravity = Vec3::Zero();            ///< m/s2, when the last block fell asleep
  std::vector<CheckedLoad> checkedLoads;  ///< of all pushed blocks when their supports held last; none where some failed
};

}  // namespace springtower
