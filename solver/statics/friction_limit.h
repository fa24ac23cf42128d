#pragma once

#include "solver/world/simulation.h"

#include <span>

namespace springtower {

/// The largest force, N, along a horizontal unit direction through a block's centre that friction can hold with the present
/// normal forces: the largest load for which friction inside the Coulomb cones balances the horizontal forces and the torques
/// about the vertical of all blocks. With given normal forces friction obeys the limit theorems, so no block moves below this
/// load and some do above it (Drucker 1954). Friction times the sum of a block's normal forces is an upper bound; the limit is
/// lower where a light block rotates with the one that is drawn. `contacts`: from contactForces, between level faces. The cones
/// are polygons of 64 sides, so the result may be up to 0.1 % low. Throws std::runtime_error if the linear program fails.
double frictionLimit_n(const Simulation& simulation, std::span<const ContactForce> contacts, BlockId block,
                       const Vec3& direction);

}  // namespace springtower
