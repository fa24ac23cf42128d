#include "solver/rigid/added_energy.h"

#include "core/tuning.h"
#include "solver/rigid/impact.h"
#include "solver/rigid/packs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace springtower {

namespace {

// Energy of a point's springs at a gap, J: as far as what lasts of its force compresses them they are linear, beyond that the
// force is that.
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

// A body that impulses move, or none.
RigidBody* movedBody(RigidIsland& island, std::int32_t at) {
  if (at == unmovedBody(island)) return nullptr;
  RigidBody& body = island.bodies[static_cast<std::size_t>(at)];
  return body.inverseMass > 0.0 ? &body : nullptr;
}

// Runs visit(packed, pair, lane, upper, lower) for each pair that has points.
template <class Visit>
void overPairsOf(RigidIsland& island, const Visit& visit) {
  for (const PackedPoints* packed : packsOf(island)) {
    for (const PackedPair& pair : packed->pairs) {
      for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
        if (pair.group[lane] < 0) continue;
        visit(*packed, pair, static_cast<int>(lane), movedBody(island, pair.upper[lane]), movedBody(island, pair.lower[lane]));
      }
    }
  }
}

void findGiven(RigidIsland& island, double step_s) {
  for (RigidBody& body : island.bodies) body.given_j = body.handedOn_j = 0.0;
  const PackedPair* last = nullptr;
  Lanes given{};
  overPairsOf(island, [&](const PackedPoints& packed, const PackedPair& pair, int lane, RigidBody* upper, RigidBody* lower) {
    if (&pair != last) findGivenBy(island, packed, pair, step_s, given);
    last = &pair;
    if (upper != nullptr) upper->given_j += given[lane];
    if (lower != nullptr) lower->given_j += given[lane];
  });
}

// Energy that lighter blocks hand on, by what these have been given and handed on themselves so far.
void handOn(RigidIsland& island) {
  for (RigidBody& body : island.bodies) {
    body.mostGiven_j = body.given_j + body.handedOn_j;
    body.handedOn_j = 0.0;
  }
  overPairsOf(island, [&](const PackedPoints& packed, const PackedPair& pair, int lane, RigidBody* upper, RigidBody* lower) {
    if (upper == nullptr || lower == nullptr || upper->inverseMass == lower->inverseMass || !pushes(packed, pair, lane)) return;
    RigidBody& light = upper->inverseMass > lower->inverseMass ? *upper : *lower;
    RigidBody& heavy = &light == upper ? *lower : *upper;
    heavy.handedOn_j += light.mostGiven_j * (light.inverseMass - heavy.inverseMass) / (light.inverseMass + heavy.inverseMass);
  });
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
