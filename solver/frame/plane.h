#pragma once

#include "solver/world/simulation.h"

namespace springtower {

/// Removes motion across the plane y = 0 that is due to rounding: each corner and its mirror image in the plane become mirror
/// images again, in position and velocity. In exact arithmetic a symmetric state stays symmetric; without this correction a
/// falling stack leaves the plane within a second. Precondition: `simulation.scene.plane`, so that every block has an axis along
/// y.
void keepInPlane(Simulation& simulation);

}  // namespace springtower
