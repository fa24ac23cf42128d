#include "solver/rigid/added_energy.h"

#include "core/tuning.h"
#include "solver/rigid/impact.h"
#include "solver/rigid/packs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace springtower {

namespace {

// Energy of a point's springs at a gap, J: linear up to the overlap that what lasts of their force makes, of that force beyond
// it.
SPRINGTOWER_INLINE void findStored(const PackedPoint& p, const Lanes& gap, double step_s, Lanes& stored) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  Lanes overlap, linear;
  largerOf(-gap, zero, overlap);
  smallerOf(overlap, p.deepest, linear);
  stored = p.softness > zero ? 0.5 * linear * (2.0 * overlap - linear) / (step_s * p.softness) : zero;
}

// The largest energy that the contacts of four pairs may have given each of their blocks, J.
SPRINGTOWER_INLINE void findGivenBy(const RigidIsland& island, const PackedPoints& packed, const PackedPair& pair, double step_s,
                                    Lanes& given) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  PackMotion motion;
  gather(island.motions.data(), pair, motion);
  given = zero;
  for (const PackedPoint& p : pointsOf(packed, pair)) {
    LaneVector relative;
    relativeAt(motion, p, relative);
    Lanes opening, rebound, parting, sliding;
    dot(p.normal, relative, opening);
    largerOf(p.rebound, zero, rebound);
    largerOf(opening - rebound, zero, parting);
    subtractTimes(opening, p.normal, relative);
    dot(p.friction, relative, sliding);
    largerOf(sliding, zero, sliding);
    Lanes before, after, unexplained;
    findStored(p, p.gap - step_s * parting, step_s, before);
    findStored(p, p.gap, step_s, after);
    largerOf(p.push * parting - (before - after), zero, unexplained);
    given += tuning::kMostGivenEnergy * (unexplained + sliding);
  }
}

bool pushes(const PackedPoints& packed, const PackedPair& pair, int lane) {
  return std::ranges::any_of(pointsOf(packed, pair), [&](const PackedPoint& p) { return p.push[lane] > 0.0; });
}

// The upper and the lower body of a pair; none where impulses do not move it, and in a lane without a pair.
std::array<RigidBody*, 2> movedBodies(RigidIsland& island, const PackedPair& pair, std::size_t lane) {
  const auto at = [&](std::uint8_t moves, std::int32_t body) {
    return (moves >> lane & 1) != 0 ? &island.bodies[static_cast<std::size_t>(body)] : nullptr;
  };
  return {at(pair.movesUpper, pair.upper[lane]), at(pair.movesLower, pair.lower[lane])};
}

SPRINGTOWER_KERNEL
void addGiven(const PackedPoints& packed, double step_s, RigidIsland& island) {
  for (const PackedPair& pair : packed.pairs) {
    Lanes given;
    findGivenBy(island, packed, pair, step_s, given);
    for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
      for (RigidBody* body : movedBodies(island, pair, lane)) {
        if (body != nullptr) body->given_j += given[static_cast<int>(lane)];
      }
    }
  }
}

void findGiven(RigidIsland& island, double step_s) {
  for (RigidBody& body : island.bodies) body.given_j = body.handedOn_j = 0.0;
  for (const PackedPoints* packed : packsOf(island)) addGiven(*packed, step_s, island);
}

// From the lighter to the heavier of two blocks, by what the lighter one has been given and handed on so far.
void handOnWithin(RigidIsland& island, const PackedPoints& packed, const PackedPair& pair, std::size_t lane) {
  const auto [upper, lower] = movedBodies(island, pair, lane);
  if (upper == nullptr || lower == nullptr || upper->inverseMass == lower->inverseMass) return;
  if (!pushes(packed, pair, static_cast<int>(lane))) return;
  const bool up = lower->inverseMass > upper->inverseMass;
  const RigidBody& light = up ? *lower : *upper;
  RigidBody& heavy = up ? *upper : *lower;
  heavy.handedOn_j += light.mostGiven_j * (light.inverseMass - heavy.inverseMass) / (light.inverseMass + heavy.inverseMass);
}

void handOn(RigidIsland& island) {
  for (RigidBody& body : island.bodies) {
    body.mostGiven_j = body.given_j + body.handedOn_j;
    body.handedOn_j = 0.0;
  }
  for (const PackedPoints* packed : packsOf(island)) {
    for (const PackedPair& pair : packed->pairs) {
      for (std::size_t lane = 0; lane < kPackedPairs; ++lane) handOnWithin(island, *packed, pair, lane);
    }
  }
}

}  // namespace

void takeGivenEnergy(double added_j, double step_s, RigidIsland& island) {
  if (!(added_j > 0.0)) return;
  findGiven(island, step_s);
  for (int sweep = 0; sweep < tuning::kHandOnSweeps; ++sweep) handOn(island);
  double given_j = 0.0;
  for (RigidBody& body : island.bodies) {
    if (body.inverseMass > 0.0) given_j += std::min(body.given_j + body.handedOn_j, kineticEnergy(body));
  }
  if (!(given_j > 0.0)) return;
  const double share = std::min(1.0, added_j / given_j);
  for (RigidBody& body : island.bodies) {
    const double most_j = body.given_j + body.handedOn_j;
    if (body.inverseMass == 0.0 || !(most_j > 0.0)) continue;
    const double kinetic_j = kineticEnergy(body);
    if (!(kinetic_j > 0.0)) continue;
    const double left = std::sqrt(std::max(0.0, 1.0 - share * std::min(1.0, most_j / kinetic_j)));
    body.velocity *= left;
    body.spin *= left;
  }
}

}  // namespace springtower
