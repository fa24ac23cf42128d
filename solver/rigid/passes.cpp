#include "solver/rigid/passes.h"

#include "solver/rigid/packs.h"

#include <algorithm>
#include <atomic>

namespace springtower {

namespace {

constexpr Lanes kNone = {0.0, 0.0, 0.0, 0.0};
constexpr LaneMask kAll = {-1, -1, -1, -1};

// What the normal impulses of points aim at: the slowest speed along the normal, m/s, the share of the impulse for it that is
// given, and the share of the impulse so far that is taken back.
struct Aim {
  Lanes least;
  Lanes share;
  Lanes released;
};

SPRINGTOWER_INLINE void aimOf(const Pass& pass, const PackedPoint& p, Aim& aim) {
  Lanes slack, open;
  slackOf(p, slack);
  largerOf(slack, kNone, open);
  const LaneMask apart = slack > -pass.rounding;
  const Lanes approach = -open / pass.step_s;
  // A greater push compresses the springs farther, which takes a part of what it is for.
  const Lanes softness = p.softness * p.push < p.deepest ? p.softness * p.normalMass : kNone;
  const Lanes stiff = 1.0 / (1.0 + softness / pass.step_s);
  if (pass.push) {
    const Lanes most = kNone + pass.most;
    Lanes pushed, turning;
    smallerOf(-pass.soft.rate * slack, most, pushed);
    // As much faster as turning closes the gap: so blocks that roll over one another do not sink in. What turns by a large angle
    // in the substep would close it by more than it can.
    smallerOf(-p.closing / pass.step_s, most, turning);
    aim.least = (apart ? approach : pushed) + turning;
    aim.share = apart ? stiff : pass.soft.mass / (1.0 + pass.soft.rate * softness);
    aim.released = apart ? kNone : kNone + pass.soft.impulse;
    return;
  }
  const Lanes least = apart ? approach : kNone;
  largerOf(least, p.rebound, aim.least);
  aim.share = slack > kNone ? stiff : kNone + 1.0;
  aim.released = kNone;
}

// An impulse of friction, with its moments about both bodies' centres.
struct FrictionImpulse {
  LaneVector impulse;
  LaneVector momentUpper;
  LaneVector momentLower;
};

SPRINGTOWER_INLINE void findMoments(const PackedPair& pair, const PackedPoint& p, FrictionImpulse& friction) {
  cross(p.armUpper, friction.impulse, friction.momentUpper);
  cross(p.armLower, friction.impulse, friction.momentLower);
  if (!pair.slips) return;
  LaneVector moment;
  cross(p.towardsCentre, friction.impulse, moment);
  add(moment, friction.momentUpper);
  add(moment, friction.momentLower);
}

// Friction within the cone of the normal impulse so far: its change.
SPRINGTOWER_INLINE void solveFriction(const PackedPair& pair, const PackMotion& motion, const LaneVector& relative,
                                      const Lanes& opening, const LaneMask& acts, PackedPoint& p, FrictionImpulse& change) {
  LaneVector slip = relative;
  subtractTimes(opening, p.normal, slip);
  if (pair.slips) {
    LaneVector spin = motion.spinUpper;
    subtract(motion.spinLower, spin);
    LaneVector turning;
    cross(spin, p.towardsCentre, turning);
    removeAlong(p.normal, turning);
    add(turning, slip);
  }
  LaneVector friction = p.friction;
  subtractTimes(p.acrossMass, slip, friction);
  Lanes squared, size;
  dot(friction, friction, squared);
  const Lanes most = p.coefficient * p.push;
  const LaneMask sliding = squared > most * most;
  squareRoot(squared, size);
  const Lanes left = sliding ? most / size : kNone + 1.0;
  const LaneVector& old = p.friction;
  change.impulse = {acts ? left * friction.x - old.x : kNone, acts ? left * friction.y - old.y : kNone,
                    acts ? left * friction.z - old.z : kNone};
  add(change.impulse, p.friction);
  p.sliding = acts ? sliding : p.sliding;
  findMoments(pair, p, change);
}

SPRINGTOWER_INLINE void applyImpulses(const PackedPair& pair, const PackedPoint& p, const FrictionImpulse& friction,
                                      const Lanes& more, PackMotion& motion) {
  LaneVector turn;
  times(pair.inertiaUpper, friction.momentUpper, turn);
  addTimes(more, p.turnUpper, turn);
  add(turn, motion.spinUpper);
  times(pair.inertiaLower, friction.momentLower, turn);
  addTimes(more, p.turnLower, turn);
  subtract(turn, motion.spinLower);
  LaneVector impulse = friction.impulse;
  addTimes(more, p.normal, impulse);
  addTimes(pair.inverseMassUpper, impulse, motion.velocityUpper);
  subtractTimes(pair.inverseMassLower, impulse, motion.velocityLower);
}

// One point of each of four pairs: friction first, bounded by the cone of the accumulated normal impulse, then the normal
// impulse, so that along the normal the blocks do not come closer than their gap. `opening`: their speed along it before, m/s;
// `more`: its impulse. Only pairs of `looks` are solved.
SPRINGTOWER_INLINE void solvePoints(const Pass& pass, const PackedPair& pair, const LaneMask& looks, PackMotion& motion,
                                    PackedPoint& p, Lanes& opening, Lanes& more) {
  LaneVector relative;
  relativeAt(motion, p, relative);
  dot(p.normal, relative, opening);
  Aim aim;
  aimOf(pass, p, aim);
  LaneMask rests = p.idle & (opening >= aim.least);
  // What blocks may still approach by is for the next substep, which begins with the speed at which they meet.
  if (!pass.push) rests |= p.idle & (p.gap > kNone);
  const LaneMask acts = looks & ~rests;
  more = kNone;
  if (!any(acts)) return;
  const Lanes mostFriction = p.coefficient * p.push;
  FrictionImpulse friction;
  solveFriction(pair, motion, relative, opening, acts, p, friction);
  Lanes byUpper, byLower;
  dot(p.turnUpper, friction.momentUpper, byUpper);
  dot(p.turnLower, friction.momentLower, byLower);
  const Lanes now = opening + (byUpper + byLower);
  Lanes push;
  largerOf(p.push + p.normalMass * aim.share * (aim.least - now) - aim.released * p.push, kNone, push);
  more = acts ? push - p.push : kNone;
  p.push = acts ? push : p.push;
  const LaneMask idle = (push == kNone) & (mostFriction == kNone);
  p.idle = acts ? idle : p.idle;
  applyImpulses(pair, p, friction, more, motion);
}

SPRINGTOWER_KERNEL
void warmStart(BodyMotion* bodies, const PackedPoints& packed, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    const PackedPair& pair = packed.pairs[i];
    PackMotion motion;
    bool gathered = false;
    for (const PackedPoint& p : pointsOf(packed, pair)) {
      if (!any(~p.idle)) continue;
      if (!gathered) gather(bodies, pair, motion);
      gathered = true;
      FrictionImpulse friction;
      friction.impulse = p.friction;
      findMoments(pair, p, friction);
      applyImpulses(pair, p, friction, p.push, motion);
    }
    if (gathered) scatter(motion, pair, bodies);
  }
}

SPRINGTOWER_KERNEL
void solveFirst(const Pass& pass, BodyMotion* bodies, PackedPoints& packed, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    PackedPair& pair = packed.pairs[i];
    PackMotion motion;
    gather(bodies, pair, motion);
    pair.pushing = 0;
    LaneMask nearby{};
    LaneMask changes{};  // also where an impulse that a point started with is taken back whole
    for (PackedPoint& p : pointsOf(packed, pair)) {
      Lanes opening, more;
      changes |= ~p.idle;
      solvePoints(pass, pair, kAll, motion, p, opening, more);
      changes |= ~p.idle;
      pair.pushing += count(~p.idle);
      nearby += ~p.idle | (p.gap + p.closing + pass.step_s * opening < kNone + pass.near);
    }
    pair.nearby = count(nearby);
    for (std::size_t lane = 0; lane < kPackedPairs; ++lane)
      pair.active[lane] = -static_cast<std::int32_t>(nearby[static_cast<int>(lane)]);
    if (any(changes)) scatter(motion, pair, bodies);
  }
}

// Returns by how much the points' approach was changed at most, m/s.
SPRINGTOWER_KERNEL
double solveAgain(const Pass& pass, BodyMotion* bodies, PackedPoints& packed, std::size_t first, std::size_t last) {
  Lanes worst = kNone;
  for (std::size_t i = first; i < last; ++i) {
    const PackedPair& pair = packed.pairs[static_cast<std::size_t>(packed.active[i])];
    PackMotion motion;
    gather(bodies, pair, motion);
    Lanes opening, more;
    const std::span<PackedPoint> points = pointsOf(packed, pair);
    for (std::size_t k = 0; k < points.size(); ++k) {
      PackedPoint& p = points[pass.reversed ? points.size() - 1 - k : k];
      solvePoints(pass, pair, kAll, motion, p, opening, more);
      const Lanes changed = p.normalMass > kNone ? more / p.normalMass : kNone;
      largerOf(changed, worst, worst);
      largerOf(-changed, worst, worst);
    }
    scatter(motion, pair, bodies);
  }
  return std::max(std::max(worst[0], worst[1]), std::max(worst[2], worst[3]));
}

// Makes pairs active whose points have got impulses without having been near; returns whether there are any.
bool activate(const LaneMask& acts, PackedPair& pair) {
  bool any = false;
  for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
    if (acts[static_cast<int>(lane)] == 0 || pair.active[lane] != 0) continue;
    pair.active[lane] = pair.rows;
    pair.nearby += pair.rows;
    any = true;
  }
  return any;
}

// The pairs of which a body's velocity has changed since a pass; returns the number of their active points.
SPRINGTOWER_INLINE std::size_t findChanged(const std::vector<int>& changed, const PackedPair& pair, int since, LaneMask& looks) {
  std::int32_t points = 0;
  for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
    const int last =
        std::max(changed[static_cast<std::size_t>(pair.upper[lane])], changed[static_cast<std::size_t>(pair.lower[lane])]);
    looks[static_cast<int>(lane)] = last >= since ? -1 : 0;
    points += last >= since ? pair.active[lane] : 0;
  }
  return static_cast<std::size_t>(points);
}

void noteChanges(const LaneMask& changes, const PackedPair& pair, int number, RigidIsland& island) {
  for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
    if (changes[static_cast<int>(lane)] == 0) continue;
    if ((pair.movesUpper >> lane & 1) != 0) noteChange(pair.upper[lane], number, island);
    if ((pair.movesLower >> lane & 1) != 0) noteChange(pair.lower[lane], number, island);
  }
}

// Lists the pairs at whose points further passes look.
void listActive(PackedPoints& packed) {
  packed.active.clear();
  packed.activeStart.clear();
  packed.activePoints = 0;
  for (std::size_t colour = 0; colour + 1 < packed.colourStart.size(); ++colour) {
    packed.activeStart.push_back(static_cast<std::int32_t>(packed.active.size()));
    for (std::int32_t i = packed.colourStart[colour]; i < packed.colourStart[colour + 1]; ++i) {
      const PackedPair& pair = packed.pairs[static_cast<std::size_t>(i)];
      if (pair.nearby == 0) continue;
      packed.active.push_back(i);
      packed.activePoints += static_cast<std::size_t>(pair.nearby);
    }
  }
  packed.activeStart.push_back(static_cast<std::int32_t>(packed.active.size()));
}

}  // namespace

void applyWarmStart(std::vector<BodyMotion>& bodies, const PackedPoints& packed) {
  overColours(packed.colourStart, [&](std::size_t first, std::size_t last) { warmStart(bodies.data(), packed, first, last); });
}

std::size_t solveAll(const Pass& pass, std::vector<BodyMotion>& bodies, PackedPoints& packed) {
  overColours(packed.colourStart,
              [&](std::size_t first, std::size_t last) { solveFirst(pass, bodies.data(), packed, first, last); });
  listActive(packed);
  std::size_t pushing = 0;
  for (const PackedPair& pair : packed.pairs) pushing += static_cast<std::size_t>(pair.pushing);
  return pushing;
}

double solveActive(const Pass& pass, std::vector<BodyMotion>& bodies, PackedPoints& packed) {
  std::atomic<double> worst = 0.0;
  overColours(packed.activeStart, [&](std::size_t first, std::size_t last) {
    const double found = solveAgain(pass, bodies.data(), packed, first, last);
    double known = worst;
    while (found > known && !worst.compare_exchange_weak(known, found)) {
    }
  });
  return worst;
}

void noteChange(std::int32_t body, int number, RigidIsland& island) {
  const auto b = static_cast<std::size_t>(body);
  if (island.changed[b] == number) return;
  island.changed[b] = number;
  for (PackedPoints* packed : packsOf(island)) {
    for (std::int32_t k = packed->bodyStart[b]; k < packed->bodyStart[b + 1]; ++k)
      packed->due[static_cast<std::size_t>(packed->bodyPairs[static_cast<std::size_t>(k)])] = number + 1;
  }
}

SPRINGTOWER_KERNEL
std::size_t solveChanged(const Pass& pass, RigidIsland& island, PackedPoints& packed, int number, double enough) {
  std::size_t solved = 0;
  bool joined = false;
  for (std::size_t at = 0; at < packed.pairs.size(); ++at) {
    if (packed.due[at] < number) continue;
    PackedPair& pair = packed.pairs[at];
    LaneMask looks;
    solved += findChanged(island.changed, pair, number - 1, looks);
    if (!any(looks)) continue;
    PackMotion motion;
    gather(island.motions.data(), pair, motion);
    LaneMask changes{};
    LaneMask acts{};
    for (PackedPoint& p : pointsOf(packed, pair)) {
      Lanes opening, more, size;
      solvePoints(pass, pair, looks, motion, p, opening, more);
      sizeOf(more, size);
      changes |= size > enough * p.normalMass;
      acts |= ~p.idle;
    }
    scatter(motion, pair, island.motions.data());
    noteChanges(changes, pair, number, island);
    joined |= activate(acts, pair);
  }
  if (joined) listActive(packed);
  return solved;
}

}  // namespace springtower
