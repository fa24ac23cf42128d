#include "solver/rigid/impact.h"

#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/rigid/constraints.h"
#include "solver/rigid/over_bodies.h"
#include "solver/rigid/packs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace springtower {

namespace {

// A block that flies gains some speed before it meets what does not: the square of it, m2/s2, along a normal.
SPRINGTOWER_KERNEL
void setImpactsOf(const RigidIsland& island, const Vec3& gravity, double least, PackedPoints& packed, std::size_t first,
                  std::size_t last) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  const LaneVector g = {zero + gravity[0], zero + gravity[1], zero + gravity[2]};
  const auto flies = [&](const PackedIndex& at, int lane) {
    return island.places[static_cast<std::size_t>(at[static_cast<std::size_t>(lane)])].flies;
  };
  for (std::size_t i = first; i < last; ++i) {
    const PackedPair& pair = packed.pairs[i];
    PackMotion motion;
    gather(island.motions.data(), pair, motion);
    Lanes flying;
    for (int lane = 0; lane < kPackedPairs; ++lane) flying[lane] = -2.0 * (flies(pair.upper, lane) - flies(pair.lower, lane));
    for (PackedPoint& p : pointsOf(packed, pair)) {
      LaneVector relative;
      relativeAt(motion, p, relative);
      Lanes opening, along, open, size, speed;
      dot(p.normal, relative, opening);
      dot(p.normal, g, along);
      largerOf(p.gap, zero, open);
      sizeOf(opening, size);
      const Lanes squared = flying * along * open - opening * size;
      const LaneMask meets = (p.normalMass > zero) & (squared > zero + least * least);
      squareRoot(meets ? squared : zero, speed);
      p.before = p.push;
      p.impact = speed;
      p.rebound = meets ? pair.restitution * speed : zero + std::numeric_limits<double>::lowest();
    }
  }
}

// Of the points that push.
SPRINGTOWER_KERNEL
double fastestImpactOf(const PackedPoints& packed, std::size_t first, std::size_t last) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  Lanes most = zero;
  for (std::size_t i = first; i < last; ++i) {
    for (const PackedPoint& p : pointsOf(packed, packed.pairs[static_cast<std::size_t>(packed.active[i])])) {
      const Lanes impact = p.push > zero ? p.impact : zero;
      largerOf(impact, most, most);
    }
  }
  return std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
}

// Impulses of impacts are those of points that push. Also where none was active: passes through impacts may reach any point.
SPRINGTOWER_KERNEL
bool markPushedBy(double least_m_s, RigidIsland& island, PackedPoints& packed, std::size_t first, std::size_t last) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  bool any = false;
  const auto mark = [&](std::int32_t at, double push) {
    if (at == unmovedBody(island)) return;
    RigidBody& body = island.bodies[static_cast<std::size_t>(at)];
    if (!(push * body.inverseMass > least_m_s)) return;
    body.pushed = true;
    any = true;
  };
  for (std::size_t i = first; i < last; ++i) {
    const PackedPair& pair = packed.pairs[i];
    Lanes most = zero;
    for (PackedPoint& p : pointsOf(packed, pair)) {
      const LaneMask pushes = p.push > zero;
      p.impact = pushes ? p.impact : zero;
      p.rebound = pushes ? p.rebound : zero + std::numeric_limits<double>::lowest();
      largerOf(p.push, most, most);
    }
    for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
      mark(pair.upper[lane], most[static_cast<int>(lane)]);
      mark(pair.lower[lane], most[static_cast<int>(lane)]);
    }
  }
  return any;
}

double twiceKinetic(const RigidBody& body, const Vec3& velocity, const Vec3& spin, const Vec3& otherVelocity,
                    const Vec3& otherSpin) {
  const Vec3 own = body.axes.transpose() * spin;
  const Vec3 other = body.axes.transpose() * otherSpin;
  return velocity.dot(otherVelocity) / body.inverseMass + own.dot(body.moment * other);
}

}  // namespace

void setImpacts(const IslandStep& step, RigidIsland& island) {
  const double least = leastReboundSpeed(step.simulation);
  for (PackedPoints* packed : packsOf(island)) {
    overPacks(*packed,
              [&](std::size_t first, std::size_t last) { setImpactsOf(island, step.gravity, least, *packed, first, last); });
  }
}

double fastestImpact(const RigidIsland& island) {
  double fastest = 0.0;
  for (const PackedPoints* packed : packsOf(island)) {
    const auto fastestOf = [&](std::size_t first, std::size_t last) { return fastestImpactOf(*packed, first, last); };
    const std::size_t count = packed->active.size();
    const double found = mergeRanges(count, tuning::kPairGrain, count >= 2 * tuning::kPairGrain, 0.0, fastestOf,
                                     [](double x, double y) { return std::max(x, y); });
    fastest = std::max(fastest, found);
  }
  return fastest;
}

bool markPushedByPoints(const IslandStep& step, RigidIsland& island) {
  const double least_m_s = tuning::kRoundingPush * step.simulation.scene.gravity.magnitude * step.drift_s;
  overBodies(island, [&](std::size_t i) { island.bodies[i].pushed = false; });
  std::atomic<bool> any = false;
  for (PackedPoints* packed : packsOf(island)) {
    overColours(packed->colourStart, [&](std::size_t first, std::size_t last) {
      if (markPushedBy(least_m_s, island, *packed, first, last)) any.store(true, std::memory_order_relaxed);
    });
  }
  return any;
}

double kineticEnergy(const RigidBody& body) {
  return 0.5 * twiceKinetic(body, body.velocity, body.spin, body.velocity, body.spin);
}

double kineticEnergy(const std::vector<RigidBody>& bodies) {
  const auto sum = [&](std::size_t first, std::size_t last) {
    double twice = 0.0;
    for (const RigidBody& body : std::span(bodies).subspan(first, last - first)) {
      if (body.inverseMass > 0.0) twice += twiceKinetic(body, body.velocity, body.spin, body.velocity, body.spin);
    }
    return twice;
  };
  return 0.5 * sumRanges(bodies.size(), tuning::kBlockGrain, bodies.size() >= tuning::kParallelBlocks, sum);
}

// The energy is a square polynomial of the share of the change.
void boundRebound(RigidIsland& island, double most_j) {
  double start = 0.0;
  double linear = 0.0;
  double square = 0.0;
  const auto changeOf = [&](std::size_t i, Vec3& velocity, Vec3& spin) {
    fromLanes(island.motions[i].linear, velocity);
    fromLanes(island.motions[i].angular, spin);
    velocity -= island.bodies[i].velocity;
    spin -= island.bodies[i].spin;
  };
  Vec3 velocity;
  Vec3 spin;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const RigidBody& body = island.bodies[i];
    if (body.inverseMass == 0.0) continue;
    changeOf(i, velocity, spin);
    start += 0.5 * twiceKinetic(body, body.velocity, body.spin, body.velocity, body.spin);
    linear += twiceKinetic(body, body.velocity, body.spin, velocity, spin);
    square += 0.5 * twiceKinetic(body, velocity, spin, velocity, spin);
  }
  const double left = most_j - start;
  if (linear + square <= left || !(square > 0.0)) return;
  const double share = left > 0.0 ? (std::sqrt(linear * linear + 4.0 * square * left) - linear) / (2.0 * square) : 0.0;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    if (island.bodies[i].inverseMass == 0.0) continue;
    changeOf(i, velocity, spin);
    toLanes(island.bodies[i].velocity + share * velocity, island.motions[i].linear);
    toLanes(island.bodies[i].spin + share * spin, island.motions[i].angular);
  }
}

namespace {

// By how much the push between the blocks of a pair has grown in the substep, N s.
double growthOf(const PackedPoints& packed, const PackedPair& pair, int lane) {
  double growth = 0.0;
  for (const PackedPoint& p : pointsOf(packed, pair)) growth += std::max(0.0, p.push[lane] - p.before[lane]);
  return growth;
}

// Marks the blocks next to those that an impact has struck as struck too, where the push that is removed between them would
// change their velocity as much; returns whether any is new. So is a light block between a heavy one and the floor, which keeps
// its velocity while both push it.
bool spreadImpact(RigidIsland& island, double least) {
  overBodies(island, [&](std::size_t i) { island.bodies[i].removed = 0.0; });
  const auto bodyAt = [&](std::int32_t at) {
    return at == unmovedBody(island) ? nullptr : &island.bodies[static_cast<std::size_t>(at)];
  };
  for (const PackedPoints* packed : packsOf(island)) {
    overColours(packed->colourStart, [&](std::size_t first, std::size_t last) {
      for (const PackedPair& pair : std::span(packed->pairs).subspan(first, last - first)) {
        for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
          RigidBody* upper = bodyAt(pair.upper[lane]);
          RigidBody* lower = bodyAt(pair.lower[lane]);
          if (pair.group[lane] < 0 || upper == nullptr || lower == nullptr || upper->struck == lower->struck) continue;
          RigidBody& other = upper->struck ? *lower : *upper;
          if (other.inverseMass > 0.0) other.removed += growthOf(*packed, pair, static_cast<int>(lane));
        }
      }
    });
  }
  bool any = false;
  for (RigidBody& body : island.bodies) {
    if (body.struck || !(body.removed * body.inverseMass > least)) continue;
    body.struck = true;
    any = true;
  }
  return any;
}

// The impulses of one pair's points.
void forgetPair(PackedPoints& packed, const PackedPair& pair, int lane, bool& met) {
  for (PackedPoint& p : pointsOf(packed, pair)) {
    if (!(p.push[lane] > p.before[lane])) continue;
    met = true;
    const double left = p.before[lane] / p.push[lane];
    p.friction.x[lane] *= left;
    p.friction.y[lane] *= left;
    p.friction.z[lane] *= left;
    p.push[lane] = p.before[lane];
    p.idle[lane] = p.push[lane] == 0.0 ? -1 : 0;
  }
}

}  // namespace

void forgetImpact(IslandStep& step, RigidIsland& island) {
  const double least = leastReboundSpeed(step.simulation);
  for (RigidBody& body : island.bodies) body.struck = (body.velocity - body.velocityBefore).squaredNorm() > least * least;
  while (spreadImpact(island, least)) {
  }
  const auto isStruck = [&](std::int32_t at) {
    return at != unmovedBody(island) && island.bodies[static_cast<std::size_t>(at)].struck;
  };
  for (ActingPoints* list : {&island.steady, &island.fast}) {
    overPacks(list->packed, [&](std::size_t first, std::size_t last) {
      for (const PackedPair& pair : std::span(list->packed.pairs).subspan(first, last - first)) {
        for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
          if (pair.group[lane] < 0 || (!isStruck(pair.upper[lane]) && !isStruck(pair.lower[lane]))) continue;
          bool met = false;
          forgetPair(list->packed, pair, static_cast<int>(lane), met);
          const PointGroup& group = list->groups[static_cast<std::size_t>(pair.group[lane])];
          if (met) step.engine.scratch.covered[static_cast<std::size_t>(group.pair)] = kCoveredAndMet;
        }
      }
    });
  }
}

}  // namespace springtower
