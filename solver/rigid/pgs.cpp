#include "core/tuning.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/slip.h"
#include "solver/rigid/constraints.h"
#include "solver/rigid/impact.h"
#include "solver/rigid/methods.h"
#include "solver/rigid/run.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace springtower {

namespace {

// A soft constraint: `rate` is the share of the gap closed in a second; `mass` scales the impulse of a rigid constraint, and
// `impulse` is the share of the accumulated impulse that is subtracted.
struct Softness {
  double rate = 0.0;
  double mass = 1.0;
  double impulse = 0.0;
};

Softness softness(double step_s) {
  const double omega = 2.0 * std::numbers::pi * tuning::kSoftContactRate / step_s;
  const double a = 2.0 * tuning::kSoftDampingRatio + step_s * omega;
  const double b = step_s * omega * a;
  return {omega / a, b / (1.0 + b), 1.0 / (1.0 + b)};
}

// Parameters common to all points in a pass.
struct Pass {
  double step_s;
  double most;      // m/s, largest push-out speed
  double rounding;  // m: faces placed flush overlap by less, or not at all
  Softness soft;    // of those that overlap
  bool push;        // true: overlapping blocks are pushed apart; false: the push-out is removed from the velocities
  double near;      // m, gap at the end of the step up to which a point is active
};

// Velocity of upper against lower at a point, m/s.
SPRINGTOWER_INLINE void relativeAt(const SolverBody& upper, const SolverBody& lower, const ContactConstraint& p,
                                   Lanes& relative) {
  Lanes turningUpper, turningLower;
  crossLanes(upper.spin, p.armUpper, turningUpper);
  crossLanes(lower.spin, p.armLower, turningLower);
  relative = (upper.velocity + turningUpper) - (lower.velocity + turningLower);
}

// What the normal impulse of a point aims at: the slowest speed along the normal, m/s, the share of the impulse for it that is
// given, and the share of the impulse so far that is taken back.
struct Aim {
  double least = 0.0;
  double share = 1.0;
  double released = 0.0;
};

SPRINGTOWER_INLINE Aim aimOf(const Pass& pass, const ContactConstraint& p) {
  Aim aim;
  if (p.gap > -pass.rounding) {
    aim.least = -std::max(0.0, p.gap) / pass.step_s;
  } else if (pass.push) {
    aim = {std::min(-pass.soft.rate * p.gap, pass.most), pass.soft.mass, pass.soft.impulse};
  }
  if (!pass.push && p.impact > 0.0) aim.least = std::max(aim.least, p.restitution * p.impact);
  return aim;
}

// One point: friction first, bounded by the cone of the accumulated normal impulse, then the normal impulse, so that along the
// normal the blocks do not come closer than their gap. `opening` is their speed along it before, m/s. Returns its change.
SPRINGTOWER_INLINE double solvePoint(const Pass& pass, std::vector<SolverBody>& bodies, ContactConstraint& p, double& opening) {
  // What blocks may still approach by is for the next substep, which begins with the speed at which they meet.
  if (!pass.push && p.idle && p.gap > 0.0) return 0.0;
  SolverBody& upper = bodies[static_cast<std::size_t>(p.upper)];
  SolverBody& lower = bodies[static_cast<std::size_t>(p.lower)];
  Lanes relative;
  relativeAt(upper, lower, p, relative);
  opening = sum(p.normal * relative);
  const Aim aim = aimOf(pass, p);
  if (p.idle && opening >= aim.least) return 0.0;

  Lanes slip = relative - opening * p.normal;
  if (p.slips) {
    Lanes turning;
    crossLanes(upper.spin - lower.spin, p.towardsCentre, turning);
    slip += turning - sum(p.normal * turning) * p.normal;
  }

  Lanes friction = p.friction - p.acrossMass * slip;
  const double squared = sum(friction * friction);
  const double most = p.coefficient * p.push;
  p.sliding = squared > most * most;
  if (p.sliding) friction *= most / __builtin_sqrt(squared);
  const Lanes change = friction - p.friction;
  p.friction = friction;
  Lanes momentUpper, momentLower;
  crossLanes(p.armUpper, change, momentUpper);
  crossLanes(p.armLower, change, momentLower);
  if (p.slips) {
    Lanes moment;
    crossLanes(p.towardsCentre, change, moment);
    momentUpper += moment;
    momentLower += moment;
  }

  const double now = opening + sum(p.turnUpper * momentUpper + p.turnLower * momentLower);
  const double push = std::max(0.0, p.push + p.normalMass * aim.share * (aim.least - now) - aim.released * p.push);
  const double more = push - p.push;
  p.push = push;
  p.idle = push == 0.0 && most == 0.0;

  Lanes turnUpper, turnLower;
  timesLanes(upper.inverseInertia, momentUpper, turnUpper);
  timesLanes(lower.inverseInertia, momentLower, turnLower);
  const Lanes impulse = change + more * p.normal;
  upper.velocity += upper.inverseMass * impulse;
  upper.spin += turnUpper + more * p.turnUpper;
  lower.velocity -= lower.inverseMass * impulse;
  lower.spin -= turnLower + more * p.turnLower;
  return std::abs(more) / p.normalMass;
}

// A pass over all points, which finds those that are active. Returns the number of those that push or have pushed.
SPRINGTOWER_KERNEL
std::size_t solveAll(const Pass& pass, std::vector<SolverBody>& bodies, PointList& list) {
  list.active.resize(list.points.size());
  std::size_t count = 0;
  std::size_t solved = 0;
  for (std::size_t i = 0; i < list.points.size(); ++i) {
    ContactConstraint& p = list.points[i];
    double opening = 0.0;
    solvePoint(pass, bodies, p, opening);
    solved += p.idle ? 0U : 1U;
    list.active[count] = static_cast<std::int32_t>(i);
    count += !p.idle || p.gap + pass.step_s * opening < pass.near ? 1U : 0U;
  }
  list.active.resize(count);
  return solved;
}

// A pass over the active points.
SPRINGTOWER_KERNEL
void solveActive(const Pass& pass, std::vector<SolverBody>& bodies, PointList& list) {
  double opening = 0.0;
  for (const std::int32_t i : list.active) solvePoint(pass, bodies, list.points[static_cast<std::size_t>(i)], opening);
}

// Pass `number` through an impact: over those active points of which a body's velocity has changed since they were solved last.
// Changes of less than `enough` (m/s) count as none. Returns the number of points solved.
SPRINGTOWER_KERNEL
std::size_t solveChanged(const Pass& pass, std::vector<SolverBody>& bodies, PointList& list, int number, double enough) {
  std::size_t count = 0;
  double opening = 0.0;
  for (const std::int32_t i : list.active) {
    ContactConstraint& p = list.points[static_cast<std::size_t>(i)];
    SolverBody& upper = bodies[static_cast<std::size_t>(p.upper)];
    SolverBody& lower = bodies[static_cast<std::size_t>(p.lower)];
    if (std::max(upper.changed, lower.changed) < number - 1) continue;
    ++count;
    if (solvePoint(pass, bodies, p, opening) <= enough) continue;
    if (upper.inverseMass > 0.0) upper.changed = number;
    if (lower.inverseMass > 0.0) lower.changed = number;
  }
  return count;
}

// Warm start with the impulses of the step before.
SPRINGTOWER_KERNEL
void applyWarmStart(std::vector<SolverBody>& bodies, const std::vector<ContactConstraint>& points) {
  for (const ContactConstraint& p : points) {
    if (p.idle) continue;
    SolverBody& upper = bodies[static_cast<std::size_t>(p.upper)];
    SolverBody& lower = bodies[static_cast<std::size_t>(p.lower)];
    const Lanes impulse = p.friction + p.push * p.normal;
    Lanes moment, turn, nearer;
    if (p.slips) crossLanes(p.towardsCentre, p.friction, nearer);
    crossLanes(p.armUpper, impulse, moment);
    if (p.slips) moment += nearer;
    timesLanes(upper.inverseInertia, moment, turn);
    upper.velocity += upper.inverseMass * impulse;
    upper.spin += turn;
    crossLanes(p.armLower, impulse, moment);
    if (p.slips) moment += nearer;
    timesLanes(lower.inverseInertia, moment, turn);
    lower.velocity -= lower.inverseMass * impulse;
    lower.spin -= turn;
  }
}

// Marks the points and the bodies that a contact pushes. Returns whether there is any. Where none pushes, no blocks meet.
bool markPushedByPoints(RigidIsland& island) {
  for (RigidBody& body : island.bodies) body.pushed = false;
  for (PointList* list : {&island.steady, &island.fast}) {
    for (const std::int32_t i : list->active) {
      ContactConstraint& p = list->points[static_cast<std::size_t>(i)];
      if (!(p.push > 0.0)) {
        p.impact = 0.0;
        continue;
      }
      for (const std::int32_t at : {p.upper, p.lower}) {
        if (at != unmovedBody(island)) island.bodies[static_cast<std::size_t>(at)].pushed = true;
      }
    }
  }
  return std::any_of(island.bodies.begin(), island.bodies.end(), [](const RigidBody& body) { return body.pushed; });
}

// Whether any two blocks overlap deeply.
bool isDeep(const IslandStep& step, const RigidIsland& island) {
  const double deep = -tuning::kDeepOverlap * step.simulation.lengths.blockHeight_m;
  const auto any = [&](const PointList& list) {
    return std::any_of(list.points.begin(), list.points.end(), [&](const ContactConstraint& p) { return p.gap < deep; });
  };
  return any(island.steady) || any(island.fast);
}

// Energy clamp: if push-out or unconverged passes raised kinetic energy beyond the work of gravity, scales all velocities down by
// the excess, at most 1 % of the energy a step.
void removeAddedEnergy(std::vector<RigidBody>& bodies, double added) {
  if (added <= 0.0) return;
  const double kinetic = kineticEnergy(bodies);
  const double left = std::sqrt(1.0 - std::min(tuning::kMaxEnergyRemoval, added / kinetic));
  for (RigidBody& body : bodies) {
    body.velocity *= left;
    body.spin *= left;
  }
}

Pass passOf(const IslandStep& step, bool push) {
  const Scene& scene = step.simulation.scene;
  Pass pass;
  pass.step_s = step.drift_s;
  pass.most = tuning::kMaxPushSpeed * step.simulation.lengths.blockHeight_m / step.simulation.lengths.fallTime_s;
  pass.soft = isRigid(scene.settings.method) ? softness(step.drift_s) : Softness{tuning::kRigidModeBaumgarte / step.drift_s};
  pass.push = push;
  pass.rounding = step.simulation.lengths.contactError_m;
  pass.near = tuning::kActiveGap * step.simulation.lengths.blockHeight_m;
  return pass;
}

// Passes through the impacts of a substep, the fastest of them at this speed, m/s: what rebounds leaves, so an impact is solved
// at once, through all blocks that it reaches.
void solveImpacts(IslandStep& step, RigidIsland& island, const Pass& pass, double impact) {
  const std::size_t active = island.steady.active.size() + island.fast.active.size();
  const std::size_t most = std::max(active, static_cast<std::size_t>(tuning::kMaxImpactEvaluations));
  for (SolverBody& body : island.movers) body.changed = -1;
  for (const PointList* list : {&island.steady, &island.fast}) {
    for (const std::int32_t i : list->active) {
      const ContactConstraint& p = list->points[static_cast<std::size_t>(i)];
      if (!(p.push > 0.0) || !(p.impact > 0.0)) continue;
      for (const std::int32_t body : {p.upper, p.lower}) {
        if (body != unmovedBody(island)) island.movers[static_cast<std::size_t>(body)].changed = 0;
      }
    }
  }
  std::size_t solved = 0;
  for (int number = 1; number <= tuning::kMaxImpactPasses && solved < most; ++number) {
    const double enough = tuning::kImpactPrecision * impact;
    const std::size_t before = solved;
    solved += solveChanged(pass, island.movers, island.steady, number, enough);
    solved += solveChanged(pass, island.movers, island.fast, number, enough);
    if (solved == before) break;
  }
  step.counters.contactEvaluations += solved;
}

// Passes over the active points.
void runPasses(IslandStep& step, RigidIsland& island, const Pass& pass, int passes) {
  for (int i = 0; i < passes; ++i) {
    solveActive(pass, island.movers, island.steady);
    solveActive(pass, island.movers, island.fast);
    step.counters.contactEvaluations += island.steady.active.size() + island.fast.active.size();
  }
  const double impact = fastestImpact(island);
  if (impact > 0.0) solveImpacts(step, island, pass, impact);
}

// Whether overlap is pushed out, which lifts blocks. In rigid mode that is only while the frame has lost more energy than it has
// gained; but a hand, a force or a driven block does work.
bool mayPushOut(const IslandStep& step, const RigidIsland& island) {
  if (isRigid(step.simulation.scene.settings.method) || holdsTether(step) || isPushed(step) || !step.driven.empty()) return true;
  return island.gained_j <= 0.0;
}

// Passes in rigid mode that cost little because few points are active, or that a stack needs which is hit and mostly stands: the
// overlap that fewer leave would shift its load for good. Precondition: `active` > 0.
int affordablePasses(const IslandStep& step, std::size_t active) {
  const auto within = [&](int passes, int evaluations) {
    return static_cast<int>(std::min(static_cast<std::size_t>(passes), static_cast<std::size_t>(evaluations) / active));
  };
  const bool stands = !isRigid(step.simulation.scene.settings.method) && !isMostlyFallen(step);
  return stands ? within(tuning::kStandingPasses, tuning::kStandingEvaluations)
                : within(tuning::kCheapPasses, tuning::kCheapEvaluations);
}

// Passes by which blocks come no nearer than they may, from the bodies' velocities to new ones. The first finds the active
// points.
void stopAtContact(IslandStep& step, RigidIsland& island, int passes) {
  Pass pass = passOf(step, true);
  if (!mayPushOut(step, island)) pass.soft = Softness{};
  applyWarmStart(island.movers, island.steady.points);
  applyWarmStart(island.movers, island.fast.points);
  step.counters.contactEvaluations += solveAll(pass, island.movers, island.steady);
  step.counters.contactEvaluations += solveAll(pass, island.movers, island.fast);
  const std::size_t active = std::max<std::size_t>(1, island.steady.active.size() + island.fast.active.size());
  runPasses(step, island, pass, std::max(passes, affordablePasses(step, active)) - 1);
  writeMovers(island);
}

// Passes that remove the push-out from the velocities, and by which what has met rebounds.
void relaxAndRebound(IslandStep& step, RigidIsland& island, int passes) {
  readMovers(island);
  const bool rebounds = fastestImpact(island) > 0.0;
  island.rebounds = island.rebounds || rebounds;
  runPasses(step, island, passOf(step, false), passes);
  if (rebounds && step.driven.empty()) boundRebound(island, island.energyBefore_j);
  writeMovers(island);
  if (rebounds) forgetImpact(step, island);
}

// Few passes while an island is fast; more where its blocks overlap, or are coming to rest: then the load of a pile sinks in by
// what a pass leaves, and there is no energy to lift it again.
int rigidModePasses(const IslandStep& step, const RigidIsland& island) {
  if (holdsTether(step) || isPushed(step)) return tuning::kCheapPasses;  // what a hand leaves in place depends on friction
  if (isDeep(step, island)) return tuning::kDeepOverlapPasses;
  double mass = 0.0;
  for (const RigidBody& body : island.bodies) mass += body.inverseMass > 0.0 ? 1.0 / body.inverseMass : 0.0;
  const Lengths& lengths = step.simulation.lengths;
  const double slow = tuning::kRigidEntrySpeed * lengths.blockHeight_m / lengths.fallTime_s;
  return 2.0 * island.energyBefore_j < mass * slow * slow ? tuning::kSlowIslandPasses : tuning::kFastIslandPasses;
}

// Velocity of upper against lower along the faces at a point, m/s.
void slipOf(const RigidIsland& island, const ContactConstraint& p, Lanes& slip) {
  const SolverBody& upper = island.movers[static_cast<std::size_t>(p.upper)];
  const SolverBody& lower = island.movers[static_cast<std::size_t>(p.lower)];
  Lanes relative;
  relativeAt(upper, lower, p, relative);
  slip = relative - sum(p.normal * relative) * p.normal;
}

// Place of a point, m.
Vec3 meetingPlace(const RigidIsland& island, const ContactConstraint& p) {
  const Vec3 arm(p.armUpper[0], p.armUpper[1], p.armUpper[2]);
  return p.upper == unmovedBody(island) ? arm : arm + island.bodies[static_cast<std::size_t>(p.upper)].place;
}

// Whether all points of a pair slip.
bool isSlipping(const IslandStep& step, const RigidIsland& island, std::span<const ContactConstraint> points) {
  const auto sticks = [](const ContactConstraint& p) { return p.push > 0.0 && !p.sliding; };
  if (std::any_of(points.begin(), points.end(), sticks)) return false;
  SlipOfPoints slip;
  for (const ContactConstraint& p : points) {
    Lanes along;
    slipOf(island, p, along);
    slip.add(p.push > 0.0, p.sliding, std::sqrt(sum(along * along)));
  }
  return slip.isGross(step.simulation, slipNoise_m_s(step));
}

// Where the friction of points acts that all slip.
EvenPressure pressureOn(const RigidIsland& island, std::span<const ContactConstraint> points) {
  PatchPoints patch;
  double push = 0.0;
  Lanes slide = {0.0, 0.0, 0.0, 0.0};
  for (const ContactConstraint& p : points) {
    patch.add(meetingPlace(island, p), p.push);
    Lanes along;
    slipOf(island, p, along);
    slide += p.push * along;
    push += p.push;
  }
  const ContactConstraint& any = points.front();
  EvenPressure pressure = evenPressure(patch, Vec3(any.normal[0], any.normal[1], any.normal[2]));
  if (!(push > 0.0)) return pressure;
  const Lanes spin =
      island.movers[static_cast<std::size_t>(any.upper)].spin - island.movers[static_cast<std::size_t>(any.lower)].spin;
  pressure.shrink = shrinkOf(pressure, sum(any.normal * spin), std::sqrt(sum(slide * slide)) / push);
  return pressure;
}

// Friction is static, or where all points of a pair slip kinetic and that of even pressure (solver/contact/slip.h). Precondition:
// the movers have the velocities at the end of the substep before, and the points are placed.
void chooseFriction(const IslandStep& step, const RigidIsland& island, PointList& list) {
  // Where a fall has too many points for its passes to converge, friction at the points that touch gains no energy.
  const std::size_t all = island.steady.points.size() + island.fast.points.size();
  const bool converges = all * tuning::kCheapPasses <= tuning::kCheapEvaluations;
  const bool evens = converges || isRigid(step.simulation.scene.settings.method);
  for (const PointGroup& group : list.groups) {
    const BlockPair& pair = step.engine.pairs.key[static_cast<std::size_t>(group.pair)];
    const Friction friction = step.simulation.friction.of(pair.a, pair.b);
    const auto points =
        std::span(list.points).subspan(static_cast<std::size_t>(group.first), static_cast<std::size_t>(group.count));
    const bool slips = isSlipping(step, island, points);
    EvenPressure pressure;
    if (slips && evens) pressure = pressureOn(island, points);
    for (ContactConstraint& p : points) {
      p.slips = pressure.shrink < 1.0;
      p.coefficient = slips ? friction.kineticFriction : friction.staticFriction;
      p.towardsCentre = Lanes{0.0, 0.0, 0.0, 0.0};
      if (p.slips) toLanes((1.0 - pressure.shrink) * (pressure.centre - meetingPlace(island, p)), p.towardsCentre);
    }
  }
}

// Moves the bodies by their velocities; adds the work of gravity to island.energyBefore_j.
void moveBodies(IslandStep& step, RigidIsland& island) {
  for (RigidBody& body : island.bodies) {
    moveInStep(step, body);
    if (body.inverseMass == 0.0) continue;  // driven
    island.energyBefore_j += body.moved.dot(step.gravity) / body.inverseMass;
  }
}

}  // namespace

// Sequential impulses (projected Gauss-Seidel on velocities; Catto 2005) with warm starting. Separated blocks may approach by
// their gap in one step; overlapping ones are pushed apart softly, and a second set of passes removes that push from the
// velocities (soft contacts with relaxation, as in Catto's Solver2D, 2024).
void stepImpulses(IslandStep& step, RigidIsland& island) {
  const Scene& scene = step.simulation.scene;
  const bool rigidMode = !isRigid(scene.settings.method);
  for (RigidBody& body : island.bodies) {
    updateInertia(body);
    body.velocityBefore = body.velocity;
    body.moved.setZero();
    body.turned.setZero();
  }
  island.energyBefore_j = kineticEnergy(island.bodies);
  readMovers(island);
  placeConstraints(island);
  setImpacts(step, island);
  chooseFriction(step, island, island.steady);
  chooseFriction(step, island, island.fast);
  applyForces(step);
  readVelocities(island);
  int passes = scene.settings.iterations;
  if (rigidMode) passes = std::max(passes, rigidModePasses(step, island));
  stopAtContact(step, island, passes);
  island.touches = markPushedByPoints(island);
  moveBodies(step, island);
  moveGaps(island);
  relaxAndRebound(step, island, scene.settings.iterations);
  // Not in the rigid methods: there, blocks of a stack move by such slow pushes only, and the clamp would suppress them.
  // Nor with a driven block, which does work.
  if (rigidMode && island.touches && step.driven.empty())
    removeAddedEnergy(island.bodies, kineticEnergy(island.bodies) - island.energyBefore_j);
  if (rigidMode) island.gained_j += kineticEnergy(island.bodies) - island.energyBefore_j;
}

}  // namespace springtower
