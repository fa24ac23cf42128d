#include "solver/rigid/warm_start.h"

#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/contact/create.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/world/checkpoint.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <array>

namespace springtower {

namespace {

// Place of a point on its upper body, m, world.
Vec3 placeOf(const RigidIsland& island, const ContactConstraint& point) {
  if (point.upper == unmovedBody(island)) return point.placeUpper;
  const RigidBody& body = island.bodies[static_cast<std::size_t>(point.upper)];
  return body.place + body.axes * point.placeUpper;
}

double takeoverSquared(const IslandStep& step) {
  const double radius = tuning::kPointTakeover * step.simulation.lengths.blockHeight_m;
  return radius * radius;
}

void clearForces(const PointRows& rows, std::int32_t count) {
  for (std::size_t r = 0; r < rowsFor(count); ++r) {
    ImpulseRow& row = rows[r]->impulse;
    row.normalForce = {};
    row.lasting = {};
    row.friction = {};
    row.slipping = {};
    row.restDepth = {};
  }
}

// Adds a point's impulse to that point of a manifold. `swapped`: the manifold's upper block is the point's lower one.
void addForce(const ContactConstraint& p, double rate, bool swapped, std::size_t to, const PointRows& rows) {
  ImpulseRow& row = rows[rowOf(to)]->impulse;
  const std::size_t lane = laneOf(to);
  row.normalForce[lane] += rate * p.push;
  row.lasting[lane] += rate * p.lasting;
  for (std::size_t k = 0; k < 3; ++k) row.friction[k][lane] += (swapped ? -rate : rate) * p.friction[static_cast<int>(k)];
  if (p.sliding) row.slipping[lane] = 1.0;
  row.restDepth[lane] = std::max(row.restDepth[lane], p.rest);
}

// Finds the manifold of a pair at the present positions; returns whether it touches.
bool renewManifold(IslandStep& step, std::size_t at, bool pushes, Counters& counters) {
  PairTable& pairs = step.engine.pairs;
  if (!pairs.touches(at) && !pushes) return false;
  savePair(step.engine, at);
  if (pairs.touches(at)) {
    refreshManifold(step, at, counters);
  } else {
    createTouching(step, at, counters);
  }
  if (!pairs.touches(at)) return false;
  pairs.travelAtCheck[at] = travelOf(step.engine, at);
  return true;
}

void storePair(IslandStep& step, const RigidIsland& island, std::size_t at, std::span<const ContactConstraint> points,
               double rate, Counters& counters) {
  const bool pushes = std::any_of(points.begin(), points.end(), [](const ContactConstraint& p) { return p.push > 0.0; });
  if (!renewManifold(step, at, pushes, counters)) return;
  const ContactView manifold = contactOf(step.engine, at);
  const PointRows rows = step.engine.contacts.points(step.engine.pairs.contact[at]);
  clearForces(rows, manifold.count);
  if (manifold.count == 0) return;
  const PointForces now = pointsNow(step, manifold);
  const bool swapped = manifold.upper != step.engine.pairs.key[at].a;
  for (const ContactConstraint& p : points) {
    if (!(p.push > 0.0) && !(p.lasting > 0.0) && !(p.rest > 0.0)) continue;
    const Vec3 place = placeOf(island, p);
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < static_cast<std::size_t>(manifold.count); ++i) {
      if ((now.place[i] - place).squaredNorm() < (now.place[nearest] - place).squaredNorm()) nearest = i;
    }
    addForce(p, rate, swapped, nearest, rows);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    double& rest = rows[rowOf(i)]->impulse.restDepth[laneOf(i)];
    rest = std::clamp(now.depth[i], 0.0, rest);
  }
}

}  // namespace

std::span<const ContactConstraint> pointsOf(const KnownGroup& known) {
  return std::span(known.list->points)
      .subspan(static_cast<std::size_t>(known.group->first), static_cast<std::size_t>(known.group->count));
}

KnownPoints::KnownPoints(const PointList& steady, const PointList& fast, std::int32_t firstPair) : lists_{&steady, &fast} {
  for (std::size_t k = 0; k < lists_.size(); ++k) {
    const std::vector<PointGroup>& groups = lists_[k]->groups;
    at_[k] = static_cast<std::size_t>(std::ranges::lower_bound(groups, firstPair, {}, &PointGroup::pair) - groups.begin());
  }
}

KnownGroup KnownPoints::find(std::int32_t pair) {
  for (std::size_t k = 0; k < lists_.size(); ++k) {
    const std::vector<PointGroup>& groups = lists_[k]->groups;
    std::size_t& at = at_[k];
    while (at < groups.size() && groups[at].pair < pair) ++at;
    if (at < groups.size() && groups[at].pair == pair && groups[at].count > 0) return {lists_[k], &groups[at], k == 0};
  }
  return {};
}

void warmStartFromKnown(const IslandStep& step, const KnownGroup& known, std::span<ContactConstraint> points) {
  const std::span<const ContactConstraint> old = pointsOf(known);
  std::uint32_t taken = 0;
  for (ContactConstraint& p : points) {
    double nearest = takeoverSquared(step);
    std::size_t from = old.size();
    for (std::size_t i = 0; i < old.size(); ++i) {
      const double squared = (old[i].placeUpper - p.placeUpper).squaredNorm();
      if ((taken >> i & 1U) != 0 || !(squared < nearest)) continue;
      nearest = squared;
      from = i;
    }
    if (from == old.size()) continue;
    taken |= 1U << from;
    const ContactConstraint& q = old[from];
    p.push = q.push;
    p.idle = !(p.push > 0.0);
    if (!p.idle) p.friction = q.friction;
    p.rest = q.rest;
    p.lasting = q.lasting;
    p.before = q.before;
    p.sliding = q.sliding;
  }
}

void warmStartFromManifold(const IslandStep& step, const RigidIsland& island, std::size_t at, double substep_s,
                           std::span<ContactConstraint> points) {
  const ContactView manifold = contactOf(step.engine, at);
  const PointForces now = pointsNow(step, manifold);
  const double sign = manifold.upper == step.engine.pairs.key[at].a ? substep_s : -substep_s;
  std::uint32_t taken = 0;
  for (ContactConstraint& p : points) {
    const Vec3 place = placeOf(island, p);
    double nearest = takeoverSquared(step);
    std::size_t from = kManifoldPoints;
    for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
      const double squared = (now.place[i] - place).squaredNorm();
      if ((taken >> i & 1U) != 0 || !(squared < nearest)) continue;
      nearest = squared;
      from = i;
    }
    if (from == kManifoldPoints) continue;
    taken |= 1U << from;
    const ImpulseRow& row = manifold.impulse(from);
    const std::size_t lane = laneOf(from);
    p.push = substep_s * row.normalForce[lane];
    p.idle = !(p.push > 0.0);
    if (!p.idle) p.friction = sign * Vec3(row.friction[0][lane], row.friction[1][lane], row.friction[2][lane]);
    p.rest = row.restDepth[lane];
    p.lasting = p.before = substep_s * row.lasting[lane];
    p.sliding = slipsAt(manifold, from);
  }
}

void storeInManifolds(IslandStep& step, RigidIsland& island, double substep_s) {
  const auto storeRange = [&](std::size_t first, std::size_t last) {
    Counters counters;
    if (first == last) return counters;
    KnownPoints known(island.steadyKnown, island.fastKnown, step.pairs[first]);
    for (const std::int32_t pair : step.pairs.subspan(first, last - first)) {
      const auto at = static_cast<std::size_t>(pair);
      step.engine.scratch.covered[at] = 0;
      const KnownGroup group = known.find(pair);
      storePair(step, island, at, group.group != nullptr ? pointsOf(group) : std::span<const ContactConstraint>(),
                1.0 / substep_s, counters);
    }
    return counters;
  };
  step.counters += mergeRanges(step.pairs.size(), tuning::kPairGrain, isWide(step), Counters{}, storeRange,
                               [](Counters a, const Counters& b) { return a += b; });
}

}  // namespace springtower
