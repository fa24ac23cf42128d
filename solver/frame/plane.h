#pragma once

#include "solver/world/simulation.h"

namespace springtower {

/// Takes out of the motion what rounding has put into it across the plane y = 0: each corner and its mirror image in the plane
/// become mirror images again, in position and velocity. What is symmetric stays so in exact arithmetic; without this a stack
/// that falls loses the plane within a second. Precondition: `simulation.scene.plane`, so that every block has an axis along y.
void keepInPlane(Simulation& simulation);

}  // namespace springtower
