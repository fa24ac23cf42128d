#pragma once

#include "core/vector.h"
#include "solver/world/island_step.h"
#include "solver/world/newton_system.h"

#include <span>

namespace springtower {

/// How a pair (position in island.touching) stands after an evaluation of forces. Until the blocks have `moved` what slides is
/// what slid before; and unless the iteration is `near` what touches is taken to push.
ActiveSetBits activeSetBits(const IslandStep& step, const NewtonSystem& island, std::size_t at);

/// How a point that pushes resists displacements, without what is not symmetric.
struct PointStiffness {
  double normal = 0.0;       ///< N/m
  double tangential = 0.0;   ///< N/m; of a point that slides: across its way
  Vec3 slip = Vec3::Zero();  ///< unit, the way on which a point that slides resists no further, else zero
};

/// Of point `i`, which stands as `mask` says. `step_s` is the step times the method's factor.
PointStiffness pointStiffness(const IslandStep& step, const ContactView& manifold, const ContactView& trial, ActiveSetBits mask,
                              std::size_t i, double step_s);

/// What the factors know of a pair (position in island.touching) whose points stand as `mask` says: appended to `to`.
void addFactorTangents(const IslandStep& step, const NewtonSystem& island, std::size_t at, ActiveSetBits mask, double step_s,
                       AlignedVector<ContactTangent>& to);

/// Fills island.tangents with how far the contacts, as they stand now, differ from what the factors know: where points slide or
/// slid then, and where they begin or cease to push.
void findTangents(const IslandStep& step, NewtonSystem& island, double step_s);

/// Adds the forces (N) of these tangents at displacements (m), both [node][12].
void addTangentForces(std::span<const ContactTangent> tangents, std::span<const double> displacement, std::span<double> force);

}  // namespace springtower
