#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// After an explicit step: takes each block an edge of which differs from that of a rigid block by more than tuning::kMaxStrain
/// of its length back to that strain (Provot 1995), about its centre and its nearest rotation, and ends the motion of its shape.
/// Momentum and angular momentum stay. A block's springs are as stiff as its load at rest needs; a strong force on a corner, or
/// the spin that it gives, would shear a block flat or turn it inside out. A step in which the shape changes by
/// tuning::kMaxDeformationPerStep is left as it is: that is divergence.
void limitStrain(const IslandStep& step);

}  // namespace springtower
