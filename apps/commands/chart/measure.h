#pragma once

#include "apps/commands/chart/chart.h"

#include <functional>
#include <vector>

namespace springtower {

/// Called after each of the steps of the work, 1 + samples for each case, with the case; by one thread at a time.
using ChartProgress = std::function<void(const ChartCase& done)>;

/// Measures the cases of one scene: first how accurate they are, side by side on all processors, each case on one thread; then
/// their speed, alone and by turns. At rest one frame costs what another does, so a slow method is timed over fewer of them;
/// where blocks move (isInMotion) every case is timed over the same frames, and those for which they take longer than a sample
/// may once only, while they are looked at. Cases whose samples are short have more of them. Throws Interrupted with the frame
/// after a signal has come (apps/common/interruption.h).
std::vector<ChartResult> measureChart(const std::vector<ChartCase>& cases, const ChartLimits& limits,
                                      const ChartProgress& progress);

}  // namespace springtower
