#pragma once

#include "core/vector.h"
#include "solver/world/island_step.h"
#include "solver/world/newton_system.h"

#include <span>

namespace springtower {

/// Active set of a pair (position in island.touching) after an evaluation of forces. Until the blocks have moved
/// (island.trialIsAhead), the slipping points are those of the step before; and far from the solution (not
/// island.isNear) a point that touches without force counts as active.
ActiveSetBits activeSetBits(const IslandStep& step, const NewtonSystem& island, std::size_t at);

/// Stiffness of an active point, symmetric part.
struct PointStiffness {
  double normal = 0.0;       ///< N/m
  double tangential = 0.0;   ///< N/m; of a slipping point: perpendicular to its slip
  Vec3 slip = Vec3::Zero();  ///< unit, the slip direction, in which a slipping point has no stiffness; otherwise zero
};

/// Of point `i`, with the active set `mask`. `step_s` is the step times the method's factor.
PointStiffness pointStiffness(const IslandStep& step, const ContactView& manifold, const ContactView& trial, ActiveSetBits mask,
                              std::size_t i, double step_s);

/// Fills island.factorTangents with the contributions to the factors of pairs that slip, with the active set island.mask.
void findFactorTangents(const IslandStep& step, NewtonSystem& island, double step_s);

/// Fills island.tangents with the differences between the present contacts, of active set island.active, and those in the
/// factors: for points that slip now or slipped then, and points that became active or inactive.
void findTangents(const IslandStep& step, NewtonSystem& island, double step_s);

/// Adds the forces (N) of these tangents at displacements (m), both [node][12].
void addTangentForces(std::span<const ContactTangent> tangents, std::span<const double> displacement, std::span<double> force);

}  // namespace springtower
