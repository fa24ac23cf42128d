#pragma once

#include "solver/world/island_step.h"

#include <cstdint>

namespace springtower {

/// What the motion of an island's blocks needs of the explicit steps of a frame.
struct MotionBound {
  double spin = 0.0;   ///< rad/s, the fastest of a block
  double steps = 1.0;  ///< a frame, so many that blocks turn by at most tuning::kMaxExplicitTurn in one (less where sides are
                       ///< unlike), and that corners which user forces push move by at most tuning::kMaxExplicitPush of the
                       ///< least side in their first one
  std::int32_t block = -1;  ///< that needs them
};
MotionBound motionBound(const IslandStep& step);

}  // namespace springtower
