#pragma once

#include "solver/statics/model.h"

#include <optional>
#include <span>
#include <vector>

namespace springtower {

/// Of all forces at the points `usable` that balance `load` inside the friction cones (the round ones) the one with the least sum
/// of squares: unique, and what springs of one stiffness at every point, normal and tangential, would take of a load that comes
/// at once. Forces on the upper block in each point's frame, in the model's units, one for each usable point.
///
/// Its dual is the maximum of a smooth concave function of the blocks' displacements, found by Newton's method with the
/// generalised derivative of the projection onto a cone and a line search (Qi & Sun 1993). Nothing when that does not balance
/// the load to a part in 1e9 of a mean block weight: where equilibrium hangs by a hair there may be no such displacements.
std::optional<std::vector<Vec3>> leastSquaresForces(const StaticsModel& model, std::span<const std::size_t> usable,
                                                    const Eigen::VectorXd& load);

}  // namespace springtower
