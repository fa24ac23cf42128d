#pragma once

#include "apps/commands/profile/profile.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

namespace springtower {

/// One timed frame, for the trace.
struct TracedFrame {
  double start_us = 0.0;  ///< wall time since the profile began (`begun` of measureProfile)
  double duration_us = 0.0;
  std::array<double, kStages> stage_us{};
  int substeps = 0;
  std::uint64_t contactEvaluations = 0;
  std::size_t awakeBlocks = 0;
};

/// The frames of the last sample of a case.
struct TracedCase {
  ProfileCase what;
  std::vector<TracedFrame> frames;
};

/// Where the work stands: called before every preparation and every sample with how many are done, how many there are, and what
/// comes next.
using ProfileProgress = std::function<void(int done, int all, const ProfileCase& next)>;

/// Times the cases of one scene: they are prepared, then sampled by turns. Cases that differ in the number of threads alone share
/// their preparation. `begun` is when the profile began; their frames are appended to `traced`, which may be null. Throws
/// InputError for a case that is not allowed, and Interrupted with the frame after a signal has come.
std::vector<ProfileResult> measureProfile(const std::vector<ProfileCase>& cases, const ProfileLimits& limits,
                                          std::chrono::steady_clock::time_point begun, std::vector<TracedCase>* traced,
                                          const ProfileProgress& progress);

}  // namespace springtower
