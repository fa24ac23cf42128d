#include "solver/rigid/list_points.h"

#include "core/tuning.h"
#include "narrowphase/near_points.h"
#include "solver/contact/create.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/rigid/constraints.h"
#include "solver/rigid/packs.h"
#include "solver/rigid/warm_start.h"
#include "solver/world/checkpoint.h"
#include "solver/world/driven_blocks.h"

#include <algorithm>
#include <array>

namespace springtower {

namespace {

// The two blocks of a pair: block numbers (the floor -1) and the indices of their bodies.
struct PairBodies {
  std::int32_t pair;
  std::array<std::int32_t, 2> block;
  std::array<std::int32_t, 2> body;
  double restitution = 0.0;
};

PairBodies bodiesOf(const IslandStep& step, const RigidIsland& island, std::int32_t pair) {
  const BlockPair& key = step.engine.pairs.key[static_cast<std::size_t>(pair)];
  PairBodies of{pair, {key.a, key.b}, {}};
  of.restitution = restitutionOf(step.simulation, key);
  for (std::size_t s = 0; s < 2; ++s) {
    const std::int32_t block = of.block[s];
    const bool moves = !sleeps(step.simulation, block) || isDriven(step, block);
    of.body[s] = moves ? step.engine.scratch.nodeOf[static_cast<std::size_t>(block)] : unmovedBody(island);
  }
  return of;
}

// Of the centre of the first block against that of the second, m/s.
Vec3 relativeVelocity(const RigidIsland& island, const PairBodies& of) {
  Vec3 velocity = Vec3::Zero();
  for (std::size_t s = 0; s < 2; ++s) {
    if (of.body[s] == unmovedBody(island)) continue;
    const RigidBody& body = island.bodies[static_cast<std::size_t>(of.body[s])];
    velocity += s == 0 ? body.velocity : Vec3(-body.velocity);
  }
  return velocity;
}

// How far any point of one block may get against the other in a time, m, as they move now and fall.
double relativeMotion(const IslandStep& step, const RigidIsland& island, const PairBodies& of, double time_s) {
  double turning = 0.0;
  for (const std::int32_t at : of.body) {
    if (at == unmovedBody(island)) continue;
    const RigidBody& body = island.bodies[static_cast<std::size_t>(at)];
    turning += body.spin.norm() * body.radius_m;
  }
  return (relativeVelocity(island, of).norm() + turning + step.simulation.scene.gravity.magnitude * time_s) * time_s;
}

// The point in the axes of its bodies.
void addConstraint(const RigidIsland& island, const PairBodies& of, const NearPoint& near,
                   std::vector<ContactConstraint>& points) {
  points.emplace_back();
  ContactConstraint& p = points.back();
  p.upper = of.body[0];
  p.lower = of.body[1];
  const auto own = [&](std::int32_t body, const Vec3& place, Lanes& lanes) {
    if (body == unmovedBody(island)) return toLanes(place, lanes);
    const RigidBody& moved = island.bodies[static_cast<std::size_t>(body)];
    toLanes(moved.axes.transpose() * (place - moved.place), lanes);
  };
  own(p.upper, near.onA, p.placeUpper);
  own(p.lower, near.onB, p.placeLower);
  const std::int32_t turning = near.normalOf == NormalOf::a ? p.upper : p.lower;
  p.normalOf = near.normalOf;
  p.axis = near.axis;
  p.beside = near.beside;
  if (near.normalOf == NormalOf::world || turning == unmovedBody(island)) {
    p.normalOf = NormalOf::world;
    toLanes(near.normal, p.ownNormal);
  } else {
    toLanes(island.bodies[static_cast<std::size_t>(turning)].axes.transpose() * near.normal, p.ownNormal);
  }
  p.gap = near.normal.dot(near.onA - near.onB);
  p.restitution = of.restitution;
}

// A pair that is farther apart than the points looked for is separated, and is not looked at before its blocks have moved by
// their gap.
void setSeparated(IslandStep& step, std::size_t at, double gap, const Vec3& axis) {
  PairTable& pairs = step.engine.pairs;
  savePair(step.engine, at);
  pairs.phase[at] = PairPhase::separated;
  pairs.clearance[at] = gap;
  pairs.travelAtCheck[at] = travelOf(step.engine, at);
  pairs.setAxis(at, axis);
}

// Finds the points of a pair within `reach` at the present positions. `separates`: one that has none is separated.
void findPoints(IslandStep& step, const RigidIsland& island, const PairBodies& of, double reach, bool separates,
                NearPoints& near) {
  const auto at = static_cast<std::size_t>(of.pair);
  const ParticleArray& x = step.simulation.state.position;
  const CornerView a = cornersOf(x, static_cast<std::size_t>(of.block[0]));
  near.count = 0;
  near.grazes = false;
  if (of.block[1] < 0) {
    findNearFloorPoints(a, reach, near);
    if (near.count == 0 && separates) setSeparated(step, at, *std::min_element(a.z, a.z + kCorners), Vec3::UnitZ());
    return;
  }
  const CornerView b = cornersOf(x, static_cast<std::size_t>(of.block[1]));
  if (!step.engine.pairs.touches(at)) {
    const Vec3 axis = step.engine.pairs.axisOf(at);
    const double gap = gapAlong(axis, a, b);
    if (gap > reach) {
      if (separates) setSeparated(step, at, gap, axis);
      return;
    }
  }
  const Separation apart = findSeparation(a, b);
  if (apart.best() > reach) {
    if (separates) setSeparated(step, at, apart.best(), apart.bestNormal());
    return;
  }
  near.grazes = grazes(apart, grazingLimits(step.simulation), relativeVelocity(island, of));
  findNearPoints(a, b, near.grazes ? alongLevel(apart) : apart, reach,
                 tuning::kMergeRadius * step.simulation.lengths.blockHeight_m, near);
}

// Appends a pair's points to a list.
void addGroup(const RigidIsland& island, const PairBodies& of, const NearPoints& near, double reach, double moved,
              PointList& list) {
  const auto first = static_cast<std::int32_t>(list.points.size());
  for (std::size_t i = 0; i < near.count; ++i) addConstraint(island, of, near.point[i], list.points);
  list.groups.push_back({of.pair, first, static_cast<std::int32_t>(near.count), reach, moved});
}

// The points of the same pair in the step before: among the steady ones or the fast ones.
class KnownPoints {
 public:
  KnownPoints(const PointList& first, const PointList& second) : lists_{&first, &second} {}
  // Pairs in ascending order.
  KnownGroup find(std::int32_t pair) {
    for (std::size_t k = 0; k < lists_.size(); ++k) {
      const std::vector<PointGroup>& groups = lists_[k]->groups;
      std::size_t& at = at_[k];
      while (at < groups.size() && groups[at].pair < pair) ++at;
      if (at < groups.size() && groups[at].pair == pair && groups[at].count > 0) return {lists_[k], &groups[at], k == 0};
    }
    return {};
  }

 private:
  std::array<const PointList*, 2> lists_;
  std::array<std::size_t, 2> at_{};
};

// Whether points listed before still are all that may touch: neither have the blocks moved far since, nor will they now.
bool isStillListed(const KnownGroup& known, double motion, double most) {
  return known.isSteady && known.group->moved_m + motion < std::min(most, known.group->reach_m);
}

void takeOver(const KnownGroup& known, double motion, PointList& list) {
  PointGroup group = *known.group;
  const auto from = known.list->points.begin() + group.first;
  group.first = static_cast<std::int32_t>(list.points.size());
  group.moved_m += motion;
  list.points.insert(list.points.end(), from, from + group.count);
  list.groups.push_back(group);
}

// Starts the last group of a list with what is known of its pair.
void warmStartLast(const IslandStep& step, const RigidIsland& island, const KnownGroup& known, double substep_s,
                   PointList& list) {
  const PointGroup& group = list.groups.back();
  const std::span<ContactConstraint> points =
      std::span(list.points).subspan(static_cast<std::size_t>(group.first), static_cast<std::size_t>(group.count));
  if (known.group != nullptr) {
    warmStartFromKnown(step, known, points);
  } else if (island.knowsManifolds && step.engine.pairs.touches(static_cast<std::size_t>(group.pair))) {
    warmStartFromManifold(step, island, static_cast<std::size_t>(group.pair), substep_s, points);
  }
}

// Pairs that have become fast in the step are listed there alone: their points no longer act among the steady ones.
void removeFastFromSteady(RigidIsland& island) {
  auto group = island.steady.groups.begin();
  for (const std::int32_t pair : island.fastPairs) {
    while (group != island.steady.groups.end() && group->pair < pair) ++group;
    if (group == island.steady.groups.end()) return;
    if (group->pair != pair || group->count == 0) continue;
    disablePacked(island.steady.packed, *group);
    group->count = 0;
  }
}

// The path of both blocks in the attempt just rejected, m.
double pathOf(const IslandStep& step, const PairBodies& of) {
  double path = 0.0;
  for (const std::int32_t block : of.block) {
    if (!sleeps(step.simulation, block) || isDriven(step, block))
      path += step.engine.scratch.path[static_cast<std::size_t>(block)];
  }
  return path;
}

}  // namespace

void listPoints(IslandStep& step, RigidIsland& island, double substep_s, bool again) {
  Engine& engine = step.engine;
  const double h = step.simulation.lengths.blockHeight_m;
  clear(island.steady);
  clear(island.fast);
  island.fastPairs.clear();
  island.listedPairs.assign(step.activePairs.begin(), step.activePairs.end());
  KnownPoints known(island.steadyKnown, island.fastKnown);
  NearPoints near;
  for (const std::int32_t pair : island.listedPairs) {
    const auto at = static_cast<std::size_t>(pair);
    const PairBodies of = bodiesOf(step, island, pair);
    const KnownGroup before = known.find(pair);
    const double motion = relativeMotion(step, island, of, step.drift_s);
    engine.scratch.covered[at] = 1;
    if (!again && isStillListed(before, motion, tuning::kMaxListedMotion * h)) {
      takeOver(before, motion, island.steady);
      continue;
    }
    double reach = motion + tuning::kNearPointMargin * h;
    engine.scratch.covered[at] = 0;
    const bool touches = engine.pairs.touches(at);
    if (!touches && !step.simulation.scene.settings.continuousTests) continue;  // no contact begins
    if (!touches && engine.pairs.clearance[at] - (travelOf(engine, at) - engine.pairs.travelAtCheck[at]) > reach) continue;
    if (again && touches) reach = std::max(reach, pathOf(step, of));
    if (motion > tuning::kMaxSteadyMotion * h) {
      engine.scratch.covered[at] = 1;
      island.fastPairs.push_back(pair);
      continue;
    }
    findPoints(step, island, of, reach, true, near);
    if (near.count > 0 || near.grazes) engine.scratch.covered[at] = 1;
    if (near.count == 0) continue;
    addGroup(island, of, near, reach, motion, island.steady);
    warmStartLast(step, island, before, substep_s, island.steady);
  }
  packPoints(step, island, island.steady);
  packPoints(step, island, island.fast);
}

void addOutrun(IslandStep& step, RigidIsland& island, double step_s) {
  const double most = 0.5 * tuning::kNearPointMargin * step.simulation.lengths.blockHeight_m / step_s;
  bool any = false;
  for (RigidBody& body : island.bodies) {
    const double change = (body.velocity - body.before.velocity).norm() + (body.spin - body.before.spin).norm() * body.radius_m;
    body.outruns = change > most;
    any = any || body.outruns;
  }
  if (!any) return;
  const auto outruns = [&](std::int32_t body) {
    return body != unmovedBody(island) && island.bodies[static_cast<std::size_t>(body)].outruns;
  };
  std::swap(island.fastPairs, island.fastPairsBefore);
  island.fastPairs.clear();
  auto fast = island.fastPairsBefore.begin();
  for (const std::int32_t pair : island.listedPairs) {
    const bool isFast = fast != island.fastPairsBefore.end() && *fast == pair;
    if (isFast) ++fast;
    const PairBodies of = bodiesOf(step, island, pair);
    if (!isFast && !outruns(of.body[0]) && !outruns(of.body[1])) continue;
    std::uint8_t& covered = step.engine.scratch.covered[static_cast<std::size_t>(pair)];
    covered = std::max<std::uint8_t>(covered, 1);
    island.fastPairs.push_back(pair);
  }
}

void listFastPoints(IslandStep& step, RigidIsland& island, bool firstSubstep) {
  const double h = step.simulation.lengths.blockHeight_m;
  unpackPoints(island.fast);
  std::swap(static_cast<PointList&>(island.fast), island.fastBefore);
  clear(island.fast);
  KnownPoints known =
      firstSubstep ? KnownPoints(island.steadyKnown, island.fastKnown) : KnownPoints(island.steady, island.fastBefore);
  NearPoints near;
  for (const std::int32_t pair : island.fastPairs) {
    const PairBodies of = bodiesOf(step, island, pair);
    const KnownGroup before = known.find(pair);
    if (before.list == &island.steady) unpackGroup(island.steady, *before.group);
    const double motion = relativeMotion(step, island, of, step.drift_s);
    const double reach = motion + tuning::kNearPointMargin * h;
    findPoints(step, island, of, reach, false, near);
    if (near.count == 0) continue;
    addGroup(island, of, near, reach, motion, island.fast);
    warmStartLast(step, island, before, step.drift_s, island.fast);
  }
  removeFastFromSteady(island);
  packPoints(step, island, island.fast);
}

bool hasUncoveredContact(const IslandStep& step) {
  return std::any_of(step.activePairs.begin(), step.activePairs.end(), [&](std::int32_t pair) {
    const auto at = static_cast<std::size_t>(pair);
    return step.engine.scratch.covered[at] == 0 && step.engine.pairs.touches(at);
  });
}

void forgetPoints(RigidIsland& island) {
  clear(island.steadyKnown);
  clear(island.fastKnown);
  island.knowsManifolds = true;
}

void equaliseMemory(RigidIsland& island) {
  const auto equalise = [](auto&... lists) {
    const std::size_t points = std::max({lists.points.capacity()...});
    const std::size_t groups = std::max({lists.groups.capacity()...});
    (lists.points.reserve(points), ...);
    (lists.groups.reserve(groups), ...);
  };
  equalise(static_cast<PointList&>(island.steady), island.steadyKnown);
  equalise(static_cast<PointList&>(island.fast), island.fastKnown, island.fastBefore);
  const std::size_t pairs = std::max(island.fastPairs.capacity(), island.fastPairsBefore.capacity());
  island.fastPairs.reserve(pairs);
  island.fastPairsBefore.reserve(pairs);
}

void keepPoints(IslandStep& step, RigidIsland& island) {
  unpackPoints(island.steady);
  unpackPoints(island.fast);
  for (const PointList* list : {&island.steady, &island.fast}) {
    for (const PointGroup& group : list->groups) {
      const auto first = list->points.begin() + group.first;
      const bool pushes = std::any_of(first, first + group.count, [](const ContactConstraint& p) { return p.push > 0.0; });
      if (pushes) step.engine.scratch.covered[static_cast<std::size_t>(group.pair)] = kCoveredAndMet;
    }
  }
  for (const std::int32_t pair : island.listedPairs) {
    const auto at = static_cast<std::size_t>(pair);
    if (step.engine.scratch.covered[at] != kCoveredAndMet || step.engine.pairs.touches(at)) continue;
    savePair(step.engine, at);
    createTouching(step, at);
  }
  std::swap(static_cast<PointList&>(island.steady), island.steadyKnown);
  std::swap(static_cast<PointList&>(island.fast), island.fastKnown);
  island.knowsManifolds = false;
}

}  // namespace springtower
