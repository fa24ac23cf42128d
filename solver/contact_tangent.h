#pragma once

#include "core/lanes.h"
#include "core/vector.h"
#include "narrowphase/manifold.h"

#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

struct IslandStep;
struct ImplicitIsland;

/// Which points of a pair's manifold push (low byte) and which of them slide (high byte).
using ContactMask = std::uint16_t;

/// How a pair (position in island.touching) stands after an evaluation of forces. Until the blocks have `moved` what slides is
/// what slid before; and unless the iteration is `near` what touches is taken to push.
ContactMask contactMask(const IslandStep& step, const ImplicitIsland& island, std::size_t at);

/// How a point that pushes resists displacements, without what is not symmetric.
struct PointStiffness {
  double normal = 0.0;       ///< N/m
  double tangential = 0.0;   ///< N/m; of a point that slides: across its way
  Vec3 slip = Vec3::Zero();  ///< unit, the way on which a point that slides resists no further, else zero
};

/// Of point `i`, which stands as `mask` says. `step_s` is the step times the method's factor.
PointStiffness pointStiffness(const IslandStep& step, const Manifold& manifold, const PointMemory& memory, ContactMask mask,
                              std::size_t i, double step_s);

/// How the forces of up to four points of a pair on upper change with the displacement g of upper against lower at each of them:
/// isotropic g + n alongNormal (n . g) + s (alongSlip (s . g) + coupling (n . g)), n the normal and s the way of sliding.
/// Friction follows the normal force by `coupling`; and what slides pushes at another place of the lower block.
struct alignas(sizeof(Lanes)) ContactTangent {  // its AVX2 kernel counts on that; without AVX2 the compiler aligns by half of it
  std::int32_t upper = -1;                      ///< nodes of the blocks; -1: the floor, or asleep
  std::int32_t lower = -1;
  double normal[3] = {0.0, 0.0, 0.0};
  double dual[3][3] = {};     ///< 1/m, of the lower block
  Lanes upperWeight[3] = {};  ///< of each of the block's sides
  Lanes lowerWeight[3] = {};
  Lanes isotropic = {};  ///< N/m
  Lanes alongNormal = {};
  Lanes alongSlip = {};
  Lanes coupling = {};
  Lanes slip[3] = {};
  Lanes push[3] = {};  ///< N, force on upper of the points that slide
};

/// What the factors know of a pair (position in island.touching) whose points stand as `mask` says: appended to `to`.
void addFactorTangents(const IslandStep& step, const ImplicitIsland& island, std::size_t at, ContactMask mask, double step_s,
                       AlignedVector<ContactTangent>& to);

/// Fills island.tangents with how far the contacts, as they stand now, differ from what the factors know: where points slide or
/// slid then, and where they begin or cease to push.
void findTangents(const IslandStep& step, ImplicitIsland& island, double step_s);

/// Adds the forces (N) of these tangents at displacements (m), both [node][12].
void addTangentForces(std::span<const ContactTangent> tangents, std::span<const double> displacement, std::span<double> force);

}  // namespace springtower
