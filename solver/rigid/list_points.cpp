#include "solver/rigid/list_points.h"

#include "core/parallel.h"
#include "core/reserve_closely.h"
#include "core/tuning.h"
#include "narrowphase/near_points.h"
#include "solver/contact/create.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/rigid/constraints.h"
#include "solver/rigid/over_bodies.h"
#include "solver/rigid/packs.h"
#include "solver/rigid/warm_start.h"
#include "solver/world/checkpoint.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <array>
#include <optional>

namespace springtower {

namespace {

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

// The body with which the normal of a point turns in the step. One that turns with both is kept with the one that spins more,
// whichever is named first (of equal spins the second one).
NormalOf turningWith(const RigidIsland& island, const PairBodies& of, const NearPoint& near) {
  if (near.normalOf != NormalOf::both) return near.normalOf;
  const auto spin = [&](std::size_t side) {
    if (of.body[side] == unmovedBody(island)) return -1.0;
    return island.bodies[static_cast<std::size_t>(of.body[side])].spin.squaredNorm();
  };
  return spin(0) > spin(1) ? NormalOf::a : NormalOf::b;
}

// The point in the axes of its bodies.
void addConstraint(const RigidIsland& island, const PairBodies& of, const NearPoint& near, double restitution,
                   std::vector<ContactConstraint>& points) {
  reserveClosely(points.size() + 1, points);
  points.emplace_back();
  ContactConstraint& p = points.back();
  p.upper = of.body[0];
  p.lower = of.body[1];
  const auto own = [&](std::int32_t body, const Vec3& place) {
    if (body == unmovedBody(island)) return place;
    const RigidBody& moved = island.bodies[static_cast<std::size_t>(body)];
    return Vec3(moved.axes.transpose() * (place - moved.place));
  };
  p.placeUpper = own(p.upper, near.onA);
  p.placeLower = own(p.lower, near.onB);
  p.normalOf = turningWith(island, of, near);
  const std::int32_t turning = p.normalOf == NormalOf::a ? p.upper : p.lower;
  p.axis = near.axis;
  p.beside = near.beside;
  if (p.normalOf == NormalOf::world || turning == unmovedBody(island)) {
    p.normalOf = NormalOf::world;
    p.ownNormal = near.normal;
  } else {
    p.ownNormal = island.bodies[static_cast<std::size_t>(turning)].axes.transpose() * near.normal;
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

// The axis along which blocks are apart is the first that is looked at in the substeps to come.
void keepAxis(IslandStep& step, std::int32_t pair, const Vec3& axis) {
  const auto at = static_cast<std::size_t>(pair);
  if (step.engine.pairs.touches(at)) return;
  savePair(step.engine, at);
  step.engine.pairs.setAxis(at, axis);
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

// By how much two blocks are apart, m, and along which axis.
struct Apart {
  double gap;
  Vec3 axis;
};

// Of two blocks that do not touch and are so far apart along the axis known that they do not meet in step.drift_s.
std::optional<Apart> apartAlongKnownAxis(const IslandStep& step, const RigidIsland& island, const PairBodies& of) {
  const auto at = static_cast<std::size_t>(of.pair);
  if (of.block[1] < 0 || step.engine.pairs.touches(at)) return {};
  const ParticleArray& x = step.simulation.state.position;
  const Vec3 axis = step.engine.pairs.axisOf(at);
  const double gap =
      gapAlong(axis, cornersOf(x, static_cast<std::size_t>(of.block[0])), cornersOf(x, static_cast<std::size_t>(of.block[1])));
  const double margin = tuning::kNearPointMargin * step.simulation.lengths.blockHeight_m;
  if (!(gap > margin && gap > margin + closingAlong(step, island, of, axis, step.drift_s))) return {};
  return Apart{gap, axis};
}

// The points of a pair within `reach` at the present positions, where the blocks are not farther apart than that.
std::optional<Apart> findPoints(const IslandStep& step, const RigidIsland& island, const PairBodies& of, double reach,
                                NearPoints& near) {
  const ParticleArray& x = step.simulation.state.position;
  const CornerView a = cornersOf(x, static_cast<std::size_t>(of.block[0]));
  near.count = 0;
  near.grazes = false;
  if (of.block[1] < 0) {
    findNearFloorPoints(a, reach, near);
    if (near.count > 0) return {};
    return Apart{*std::min_element(a.z, a.z + kCorners), Vec3::UnitZ()};
  }
  const CornerView b = cornersOf(x, static_cast<std::size_t>(of.block[1]));
  const Separation apart = findSeparation(a, b);
  if (apart.best() > reach) return Apart{apart.best(), apart.bestNormal()};
  near.grazes = grazes(apart, grazingLimits(step.simulation), relativeVelocity(island, of));
  findNearPoints(a, b, near.grazes ? alongLevel(apart) : apart, step.gravity, reach,
                 tuning::kMergeRadius * step.simulation.lengths.blockHeight_m, near);
  return {};
}

// Appends a pair's points to a list.
void addGroup(const IslandStep& step, const RigidIsland& island, const PairBodies& of, const NearPoints& near, double reach,
              double moved, PointList& list) {
  const auto first = static_cast<std::int32_t>(list.points.size());
  const double restitution = restitutionOf(step.simulation, {of.block[0], of.block[1]});
  for (std::size_t i = 0; i < near.count; ++i) addConstraint(island, of, near.point[i], restitution, list.points);
  list.groups.push_back({of.pair, first, static_cast<std::int32_t>(near.count), reach, moved});
}

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
  reserveClosely(list.points.size() + static_cast<std::size_t>(group.count), list.points);
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
  for (const PairBodies& fast : island.fastPairs) {
    while (group != island.steady.groups.end() && group->pair < fast.pair) ++group;
    if (group == island.steady.groups.end()) return;
    if (group->pair != fast.pair || group->count == 0) continue;
    disablePacked(island.steady.packed, *group);
    group->count = 0;
  }
}

// Marks the bodies whose velocity has changed since the step began by more than its margin allows for; returns whether any has.
bool markOutrunning(const IslandStep& step, RigidIsland& island, double step_s) {
  const double most = 0.5 * tuning::kNearPointMargin * step.simulation.lengths.blockHeight_m / step_s;
  const auto mark = [&](std::size_t first, std::size_t last) {
    bool any = false;
    for (std::size_t i = first; i < last; ++i) {
      const RigidBody& body = island.bodies[i];
      const double change = (body.velocity - body.before.velocity).norm() + (body.spin - body.before.spin).norm() * body.radius_m;
      island.outruns[i] = change > most ? 1 : 0;
      any = any || island.outruns[i] != 0;
    }
    return any;
  };
  island.outruns.assign(island.bodies.size() + 1, 0);  // what does not move is the last
  return mergeRanges(island.bodies.size(), tuning::kBlockGrain, isWide(step), false, mark, [](bool a, bool b) { return a || b; });
}

// Whether a pair touches, or contacts may begin.
bool mayTouch(const IslandStep& step, const PairBodies& of) {
  return step.simulation.scene.settings.continuousTests || step.engine.pairs.touches(static_cast<std::size_t>(of.pair));
}

// Bounds the motion of a pair with such a body again, as if it had had its present speed from the start of the step: what it may
// move more counts for its points in the steps to come. Returns whether it may move farther than they, or that it has none, hold.
bool boundAgain(const IslandStep& step, const RigidIsland& island, double step_s, ListedPair& listed, PointGroup* points) {
  const auto outruns = [&](std::size_t side) { return island.outruns[static_cast<std::size_t>(listed.body[side])] != 0; };
  if (!outruns(0) && !outruns(1)) return false;
  if (!mayTouch(step, listed)) return false;
  const double motion = relativeMotion(step, island, listed, step_s);
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
bool isFarApart(const IslandStep& step, const RigidIsland& island, ListedPair& listed) {
  const auto at = static_cast<std::size_t>(listed.pair);
  if (step.engine.pairs.touches(at)) return false;
  const double speed = fastestPoint(island, listed.body[0]) + fastestPoint(island, listed.body[1]);
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

// Appends what a range of pairs has listed.
void append(const ListedRange& from, PointList& list, std::vector<PairBodies>& fastPairs) {
  const auto first = static_cast<std::int32_t>(list.points.size());
  reserveClosely(list.points.size() + from.list.points.size(), list.points);
  list.points.insert(list.points.end(), from.list.points.begin(), from.list.points.end());
  for (PointGroup group : from.list.groups) {
    group.first += first;
    list.groups.push_back(group);
  }
  fastPairs.insert(fastPairs.end(), from.fastPairs.begin(), from.fastPairs.end());
}

// Runs kernel(first, last, list, fastPairs), which appends to both, over the pairs [0, count): in one call, or on many threads
// into lists of ranges of them, which are appended in order.
template <class Kernel>
void listRanges(const IslandStep& step, std::size_t count, std::vector<ListedRange>& ranges, PointList& list,
                std::vector<PairBodies>& fastPairs, const Kernel& kernel) {
  const std::size_t used = count / tuning::kListGrain;
  if (!isWide(step) || used < 2 || threadsNow() == 1) {
    kernel(std::size_t{0}, count, list, fastPairs);
    return;
  }
  if (ranges.size() < used) ranges.resize(used);
  forEach(used, [&](std::size_t i) {
    ListedRange& range = ranges[i];
    clear(range.list);
    range.fastPairs.clear();
    kernel(i * count / used, (i + 1) * count / used, range.list, range.fastPairs);
  });
  for (std::size_t i = 0; i < used; ++i) append(ranges[i], list, fastPairs);
}

// The pairs that may meet in the step, with their bodies, and an upper bound of the speed of these.
void listPairs(const IslandStep& step, RigidIsland& island) {
  reserveClosely(step.activePairs.size(), island.listedPairs);
  island.listedPairs.resize(step.activePairs.size());
  forRanges(step.activePairs.size(), tuning::kPairGrain, isWide(step), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) island.listedPairs[i] = {bodiesOf(step, island, step.activePairs[i])};
  });
  overBodies(island, [&](std::size_t i) {
    RigidBody& body = island.bodies[i];
    body.fastestPoint_m_s = body.velocity.norm() + body.spin.norm() * body.radius_m;
  });
}

// How the points of a step are listed; see listPoints.
struct Listing {
  double substep_s;
  bool again;
};

// Lists the points of a pair among the steady ones, or the pair among the fast ones.
void listPair(IslandStep& step, const RigidIsland& island, const Listing& how, KnownPoints& known, ListedPair& listed,
              NearPoints& near, PointList& list, std::vector<PairBodies>& fastPairs) {
  Engine& engine = step.engine;
  const double h = step.simulation.lengths.blockHeight_m;
  const auto at = static_cast<std::size_t>(listed.pair);
  if (isFarApart(step, island, listed)) return;
  const KnownGroup before = known.find(listed.pair);
  const double motion = relativeMotion(step, island, listed, step.drift_s);
  double reach = motion + tuning::kNearPointMargin * h;
  listed.motion_m = motion;
  listed.reach_m = reach;
  engine.scratch.covered[at] = 0;
  if (!mayTouch(step, listed)) return;
  const double left = reachLeft(step, before);
  if (!how.again && motion < left) {
    listed.reach_m = left;
    engine.scratch.covered[at] = 1;
    return takeOver(before, motion, list);
  }
  const bool touches = engine.pairs.touches(at);
  if (!touches && gapOf(step, at) > reach) return;
  if (how.again && touches) reach = std::max(reach, pathOf(step, listed));
  if (motion > tuning::kMaxSteadyMotion * h) {
    engine.scratch.covered[at] = 1;
    fastPairs.push_back(listed);
    return;
  }
  std::optional<Apart> apart = apartAlongKnownAxis(step, island, listed);
  if (!apart) apart = findPoints(step, island, listed, reach, near);
  if (apart) {
    listed.reach_m = apart->gap;
    return setSeparated(step, at, apart->gap, apart->axis);
  }
  if (near.count > 0 || near.grazes) engine.scratch.covered[at] = 1;
  if (near.count == 0) return;
  addGroup(step, island, listed, near, reach, motion, list);
  warmStartLast(step, island, before, how.substep_s, list);
}

// Finds the points of a fast pair.
void listFastPair(IslandStep& step, RigidIsland& island, const PairBodies& of, KnownPoints& known, NearPoints& near,
                  PointList& list) {
  if (apartAlongKnownAxis(step, island, of)) return;
  const double motion = relativeMotion(step, island, of, step.drift_s);
  const double reach = motion + tuning::kNearPointMargin * step.simulation.lengths.blockHeight_m;
  if (const std::optional<Apart> apart = findPoints(step, island, of, reach, near)) return keepAxis(step, of.pair, apart->axis);
  if (near.count == 0) return;
  const KnownGroup before = known.find(of.pair);
  if (before.list == &island.steady) unpackGroup(island.steady, *before.group);
  addGroup(step, island, of, near, reach, motion, list);
  warmStartLast(step, island, before, step.drift_s, list);
}

}  // namespace

void listPoints(IslandStep& step, RigidIsland& island, double substep_s, bool again) {
  clear(island.steady);
  clear(island.fast);
  island.fastPairs.clear();
  listPairs(step, island);
  const std::span<ListedPair> pairs(island.listedPairs);
  const auto listRange = [&](std::size_t first, std::size_t last, PointList& list, std::vector<PairBodies>& fastPairs) {
    if (first == last) return;
    KnownPoints known(island.steadyKnown, island.fastKnown, pairs[first].pair);
    NearPoints near;
    for (ListedPair& listed : pairs.subspan(first, last - first))
      listPair(step, island, {substep_s, again}, known, listed, near, list, fastPairs);
  };
  listRanges(step, pairs.size(), island.ranges, island.steady, island.fastPairs, listRange);
  packPoints(step, island, island.steady);
  packPoints(step, island, island.fast);
}

void addOutrun(IslandStep& step, RigidIsland& island, double step_s) {
  if (!markOutrunning(step, island, step_s)) return;
  std::swap(island.fastPairs, island.fastPairsBefore);
  island.fastPairs.clear();
  const std::span<ListedPair> pairs(island.listedPairs);
  const auto addRange = [&](std::size_t first, std::size_t last, PointList&, std::vector<PairBodies>& fastPairs) {
    if (first == last) return;
    auto fast = std::ranges::lower_bound(island.fastPairsBefore, pairs[first].pair, {}, &PairBodies::pair);
    auto group = std::ranges::lower_bound(island.steady.groups, pairs[first].pair, {}, &PointGroup::pair);
    for (ListedPair& listed : pairs.subspan(first, last - first)) {
      const bool isFast = fast != island.fastPairsBefore.end() && fast->pair == listed.pair;
      if (isFast) ++fast;
      while (group != island.steady.groups.end() && group->pair < listed.pair) ++group;
      PointGroup* points = group != island.steady.groups.end() && group->pair == listed.pair ? &*group : nullptr;
      if (!isFast && !boundAgain(step, island, step_s, listed, points)) continue;
      std::uint8_t& covered = step.engine.scratch.covered[static_cast<std::size_t>(listed.pair)];
      covered = std::max<std::uint8_t>(covered, 1);
      fastPairs.push_back(listed);
    }
  };
  listRanges(step, pairs.size(), island.ranges, island.fast, island.fastPairs, addRange);  // no points
}

void listFastPoints(IslandStep& step, RigidIsland& island, bool firstSubstep) {
  unpackPoints(island.fast);
  std::swap(static_cast<PointList&>(island.fast), island.fastBefore);
  clear(island.fast);
  const PointList& steady = firstSubstep ? island.steadyKnown : island.steady;
  const PointList& fast = firstSubstep ? island.fastKnown : island.fastBefore;
  const std::span<const PairBodies> pairs(island.fastPairs);
  const auto listRange = [&](std::size_t first, std::size_t last, PointList& list, std::vector<PairBodies>&) {
    if (first == last) return;
    KnownPoints known(steady, fast, pairs[first].pair);
    NearPoints near;
    for (const PairBodies& of : pairs.subspan(first, last - first)) listFastPair(step, island, of, known, near, list);
  };
  listRanges(step, pairs.size(), island.ranges, island.fast, island.fastPairsBefore, listRange);  // no pairs
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
    createTouching(step, at, step.counters);
  }
  std::swap(static_cast<PointList&>(island.steady), island.steadyKnown);
  std::swap(static_cast<PointList&>(island.fast), island.fastKnown);
  island.knowsManifolds = false;
}

}  // namespace springtower
