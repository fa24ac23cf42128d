#pragma once

#include "core/tuning.h"

namespace springtower {

/// Whether a block is loose, for the loads of statics and for the viewer's hints alike: another block lies over it, and nothing
/// presses on it from above, so that it can be pulled out freely. `above_n`: the largest normal force of the blocks on it, N;
/// `forceUnit_n`: the mean weight of a block, N.
inline bool isLoose(bool covered, double above_n, double forceUnit_n) {
  return covered && above_n <= tuning::kMinStaticLoad * forceUnit_n;
}

}  // namespace springtower
