#pragma once

#include "solver/world/island_step.h"

#include <cstdint>

namespace springtower {

/// After an explicit step: takes each block an edge of which differs from that of a rigid block by more than tuning::kMaxStrain
/// of its length back to that strain (Provot 1995), about its centre and its nearest rotation, and ends the motion of its shape.
/// Momentum and angular momentum stay. A block's springs are as stiff as its load at rest needs; a strong force on a corner, or
/// the spin that it gives, would shear a block flat or turn it inside out. A step in which the shape changes by
/// tuning::kMaxDeformationPerStep is left as it is: that is divergence.
void limitStrain(const IslandStep& step);

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
