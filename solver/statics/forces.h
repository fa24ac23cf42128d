#pragma once

#include "solver/statics/model.h"

#include <optional>
#include <span>
#include <vector>

namespace springtower {

/// Among all forces at the points `usable` that balance `load` inside the (round) friction cones, the one with the least sum of
/// squares: it is unique, and equals the forces of equal springs at every point, normal and tangential, under a load applied at
/// once. Forces on the upper block in each point's frame, in the model's units, one for each usable point.
///
/// Its dual is the maximum of a smooth concave function of the blocks' displacements, found by Newton's method with the
/// generalised derivative of the projection onto a cone and a line search (Qi & Sun 1993). Empty if that does not balance the
/// load to 1e-9 of a mean block weight: at the limit of equilibrium there may be no such displacements.
std::optional<std::vector<Vec3>> leastSquaresForces(const StaticsModel& model, std::span<const std::size_t> usable,
                                                    const Eigen::VectorXd& load);

}  // namespace springtower
