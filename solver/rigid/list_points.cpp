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
};

PairBodies bodiesOf(const IslandStep& step, const RigidIsland& island, std::int32_t pair) {
  const BlockPair& key = step.engine.pairs.key[static_cast<std::size_t>(pair)];
  PairBodies of{pair, {key.a, key.b}, {}};
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

// How far any point of one block may get against the other in a time, m, as they move now and fall: along straight paths, or
// against a block that turns, in whose axes blocks that move as one are at rest. Points and normals are kept in these axes.
double relativeMotion(const IslandStep& step, const RigidIsland& island, const PairBodies& of, double time_s) {
  const Vec3 velocity = relativeVelocity(island, of);
  double straight = velocity.norm();
  std::array<const RigidBody*, 2> body{};
  for (std::size_t s = 0; s < 2; ++s) {
    if (of.body[s] == unmovedBody(island)) continue;
    body[s] = &island.bodies[static_cast<std::size_t>(of.body[s])];
    straight += body[s]->spin.norm() * body[s]->radius_m;
  }
  double least = straight;
  if (body[0] != nullptr && body[1] != nullptr) {
    const Vec3 apart = body[0]->place - body[1]->place;
    const double turning = (body[0]->spin - body[1]->spin).norm();
    for (std::size_t s = 0; s < 2; ++s) {
      const Vec3& spin = body[s]->spin;
      // A centre that moves on straight leaves the circle about the other: half of spin^2 times their distance in a time squared.
      const double leaving = 0.5 * spin.squaredNorm() * apart.norm() * time_s;
      least = std::min(least, (velocity - spin.cross(apart)).norm() + turning * body[1 - s]->radius_m + leaving);
    }
  }
  return (least + step.simulation.scene.gravity.magnitude * time_s) * time_s;
}

// The point in the axes of its bodies.
void addConstraint(const RigidIsland& island, const PairBodies& of, const NearPoint& near, double restitution,
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
  p.restitution = restitution;
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

// How far two blocks may come nearer along a direction (unit, towards the first) in a time, m, as they move now and fall.
double closingAlong(const IslandStep& step, const RigidIsland& island, const PairBodies& of, const Vec3& direction,
                    double time_s) {
  double speed = std::max(0.0, -relativeVelocity(island, of).dot(direction));
  for (const std::int32_t at : of.body) {
    if (at == unmovedBody(island)) continue;
    const RigidBody& body = island.bodies[static_cast<std::size_t>(at)];
    speed += body.spin.norm() * body.radius_m;
  }
  return (speed + step.simulation.scene.gravity.magnitude * time_s) * time_s;
}

// Finds the points of a pair within `reach` at the present positions, and returns up to which relative motion they hold: where
// there are none, the blocks' gap. `separates`: such a pair is separated.
double findPoints(IslandStep& step, const RigidIsland& island, const PairBodies& of, double reach, bool separates,
                  NearPoints& near) {
  const auto at = static_cast<std::size_t>(of.pair);
  const ParticleArray& x = step.simulation.state.position;
  const CornerView a = cornersOf(x, static_cast<std::size_t>(of.block[0]));
  near.count = 0;
  near.grazes = false;
  const auto none = [&](double gap, const Vec3& axis) {
    if (separates) setSeparated(step, at, gap, axis);
    return gap;
  };
  if (of.block[1] < 0) {
    findNearFloorPoints(a, reach, near);
    return near.count > 0 ? reach : none(*std::min_element(a.z, a.z + kCorners), Vec3::UnitZ());
  }
  const CornerView b = cornersOf(x, static_cast<std::size_t>(of.block[1]));
  if (!step.engine.pairs.touches(at)) {
    const Vec3 axis = step.engine.pairs.axisOf(at);
    const double gap = gapAlong(axis, a, b);
    const double margin = tuning::kNearPointMargin * step.simulation.lengths.blockHeight_m;
    if (gap > margin && gap > margin + closingAlong(step, island, of, axis, step.drift_s)) return none(gap, axis);
  }
  const Separation apart = findSeparation(a, b);
  if (apart.best() > reach) return none(apart.best(), apart.bestNormal());
  near.grazes = grazes(apart, grazingLimits(step.simulation), relativeVelocity(island, of));
  findNearPoints(a, b, near.grazes ? alongLevel(apart) : apart, reach,
                 tuning::kMergeRadius * step.simulation.lengths.blockHeight_m, near);
  return reach;
}

// Appends a pair's points to a list.
void addGroup(const IslandStep& step, const RigidIsland& island, const PairBodies& of, const NearPoints& near, double reach,
              double moved, PointList& list) {
  const auto first = static_cast<std::int32_t>(list.points.size());
  const double restitution = restitutionOf(step.simulation, {of.block[0], of.block[1]});
  for (std::size_t i = 0; i < near.count; ++i) addConstraint(island, of, near.point[i], restitution, list.points);
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

// By how much blocks may still move against one another before points listed before are no longer all that may touch, m; none
// where they were fast.
double reachLeft(const IslandStep& step, const KnownGroup& known) {
  if (!known.isSteady) return 0.0;
  const double most = tuning::kMaxListedMotion * step.simulation.lengths.blockHeight_m;
  return std::min(most, known.group->reach_m) - known.group->moved_m;
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

// Marks the bodies whose velocity has changed since the step began by more than its margin allows for; returns whether any has.
bool markOutrunning(const IslandStep& step, RigidIsland& island, double step_s) {
  const double most = 0.5 * tuning::kNearPointMargin * step.simulation.lengths.blockHeight_m / step_s;
  bool any = false;
  for (RigidBody& body : island.bodies) {
    const double change = (body.velocity - body.before.velocity).norm() + (body.spin - body.before.spin).norm() * body.radius_m;
    body.outruns = change > most;
    any = any || body.outruns;
  }
  return any;
}

// Bounds the motion of a pair with such a body again, as if it had had its present speed from the start of the step: what it may
// move more counts for its points in the steps to come. Returns whether it may move farther than they, or that it has none, hold.
bool boundAgain(const IslandStep& step, const RigidIsland& island, double step_s, ListedPair& listed, PointGroup* points) {
  const PairBodies of = bodiesOf(step, island, listed.pair);
  const bool changed = std::any_of(of.body.begin(), of.body.end(), [&](std::int32_t body) {
    return body != unmovedBody(island) && island.bodies[static_cast<std::size_t>(body)].outruns;
  });
  if (!changed) return false;
  const double motion = relativeMotion(step, island, of, step_s);
  if (motion > listed.reach_m) return true;
  const double more = std::max(0.0, motion - listed.motion_m);
  listed.motion_m += more;
  if (points != nullptr) points->moved_m += more;
  return false;
}

// How far two blocks that do not touch are apart at least, m.
double gapOf(const IslandStep& step, std::size_t pair) {
  const PairTable& pairs = step.engine.pairs;
  return pairs.clearance[pair] - (travelOf(step.engine, pair) - pairs.travelAtCheck[pair]);
}

// An upper bound of the speed of a body's points, m/s.
double fastestPoint(const RigidIsland& island, std::int32_t body) {
  return body == unmovedBody(island) ? 0.0 : island.bodies[static_cast<std::size_t>(body)].fastestPoint_m_s;
}

// Whether two blocks do not touch, and cannot in the step, as they move now and fall: most near pairs of a heap that flies.
bool isFarApart(const IslandStep& step, const RigidIsland& island, const PairBodies& of, ListedPair& listed) {
  const auto at = static_cast<std::size_t>(of.pair);
  if (step.engine.pairs.touches(at)) return false;
  const double speed = fastestPoint(island, of.body[0]) + fastestPoint(island, of.body[1]);
  const double motion = (speed + step.simulation.scene.gravity.magnitude * step.drift_s) * step.drift_s;
  const double gap = gapOf(step, at);
  if (gap <= motion + tuning::kNearPointMargin * step.simulation.lengths.blockHeight_m) return false;
  step.engine.scratch.covered[at] = 0;
  listed.motion_m = motion;
  listed.reach_m = gap;
  return true;
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
  island.listedPairs.clear();
  for (const std::int32_t pair : step.activePairs) island.listedPairs.push_back({pair});
  for (RigidBody& body : island.bodies) body.fastestPoint_m_s = body.velocity.norm() + body.spin.norm() * body.radius_m;
  KnownPoints known(island.steadyKnown, island.fastKnown);
  NearPoints near;
  for (ListedPair& listed : island.listedPairs) {
    const std::int32_t pair = listed.pair;
    const auto at = static_cast<std::size_t>(pair);
    const PairBodies of = bodiesOf(step, island, pair);
    if (isFarApart(step, island, of, listed)) continue;
    const KnownGroup before = known.find(pair);
    const double motion = relativeMotion(step, island, of, step.drift_s);
    listed.motion_m = motion;
    engine.scratch.covered[at] = 1;
    listed.reach_m = reachLeft(step, before);
    if (!again && motion < listed.reach_m) {
      takeOver(before, motion, island.steady);
      continue;
    }
    double reach = motion + tuning::kNearPointMargin * h;
    listed.reach_m = reach;
    engine.scratch.covered[at] = 0;
    const bool touches = engine.pairs.touches(at);
    if (!touches && !step.simulation.scene.settings.continuousTests) continue;  // no contact begins
    if (!touches && gapOf(step, at) > reach) continue;
    if (again && touches) reach = std::max(reach, pathOf(step, of));
    if (motion > tuning::kMaxSteadyMotion * h) {
      engine.scratch.covered[at] = 1;
      island.fastPairs.push_back(pair);
      continue;
    }
    listed.reach_m = findPoints(step, island, of, reach, true, near);
    if (near.count > 0 || near.grazes) engine.scratch.covered[at] = 1;
    if (near.count == 0) continue;
    addGroup(step, island, of, near, reach, motion, island.steady);
    warmStartLast(step, island, before, substep_s, island.steady);
  }
  packPoints(step, island, island.steady);
  packPoints(step, island, island.fast);
}

void addOutrun(IslandStep& step, RigidIsland& island, double step_s) {
  if (!markOutrunning(step, island, step_s)) return;
  std::swap(island.fastPairs, island.fastPairsBefore);
  island.fastPairs.clear();
  auto fast = island.fastPairsBefore.begin();
  auto group = island.steady.groups.begin();
  for (ListedPair& listed : island.listedPairs) {
    const bool isFast = fast != island.fastPairsBefore.end() && *fast == listed.pair;
    if (isFast) ++fast;
    while (group != island.steady.groups.end() && group->pair < listed.pair) ++group;
    PointGroup* points = group != island.steady.groups.end() && group->pair == listed.pair ? &*group : nullptr;
    if (!isFast && !boundAgain(step, island, step_s, listed, points)) continue;
    std::uint8_t& covered = step.engine.scratch.covered[static_cast<std::size_t>(listed.pair)];
    covered = std::max<std::uint8_t>(covered, 1);
    island.fastPairs.push_back(listed.pair);
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
    addGroup(step, island, of, near, reach, motion, island.fast);
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
  for (const ListedPair& listed : island.listedPairs) {
    const auto at = static_cast<std::size_t>(listed.pair);
    if (step.engine.scratch.covered[at] != kCoveredAndMet || step.engine.pairs.touches(at)) continue;
    savePair(step.engine, at);
    createTouching(step, at);
  }
  std::swap(static_cast<PointList&>(island.steady), island.steadyKnown);
  std::swap(static_cast<PointList&>(island.fast), island.fastKnown);
  island.knowsManifolds = false;
}

}  // namespace springtower
