#pragma once

#include "solver/world/simulation.h"

#include <span>

namespace springtower {

/// The largest force, N, along a horizontal unit direction through a block's centre that friction bears while all normal forces
/// stay as they are: the greatest load for which friction inside the Coulomb cones balances the horizontal forces and the torques
/// about the vertical of all blocks. With normal forces given friction obeys the limit theorems, so no block moves below this
/// load and some do above it (Drucker 1954). Friction times the sum of a block's normal forces is an upper bound: it is less
/// where a light block turns with the one that is drawn. `contacts`: from contactForces, between level faces. The cones are
/// polygons of 64 sides, so it may come out 0.1 % low. Throws std::runtime_error where the linear programme fails.
double frictionLimit_n(const Simulation& simulation, std::span<const ContactForce> contacts, BlockId block,
                       const Vec3& direction);

}  // namespace springtower
