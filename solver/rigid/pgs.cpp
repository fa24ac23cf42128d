#include "core/tuning.h"
#include "solver/rigid/constraints.h"
#include "solver/rigid/methods.h"
#include "solver/rigid/run.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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
  double kinetic;   // coefficient of friction
  double most;      // m/s, largest push-out speed
  double rounding;  // m: faces placed flush overlap by less, or not at all
  Softness soft;    // of those that overlap
  bool push;        // true: overlapping blocks are pushed apart; false: the push-out is removed from the velocities
};

// One point: friction first, bounded by the cone of the accumulated normal impulse, then the normal impulse, so that along the
// normal the blocks do not come closer than their gap.
SPRINGTOWER_INLINE void solvePoint(const Pass& pass, std::vector<SolverBody>& bodies, ContactConstraint& p) {
  SolverBody& upper = bodies[static_cast<std::size_t>(p.upper)];
  SolverBody& lower = bodies[static_cast<std::size_t>(p.lower)];
  Lanes turningUpper, turningLower;
  crossLanes(upper.spin, p.armUpper, turningUpper);
  crossLanes(lower.spin, p.armLower, turningLower);
  const Lanes relative = (upper.velocity + turningUpper) - (lower.velocity + turningLower);
  const double opening = sum(p.normal * relative);
  double least = 0.0;
  double share = 1.0;
  double released = 0.0;
  if (p.gap > -pass.rounding) {
    least = -std::max(0.0, p.gap) / pass.step_s;
  } else if (pass.push) {
    least = std::min(-pass.soft.rate * p.gap, pass.most);
    share = pass.soft.mass;
    released = pass.soft.impulse;
  }
  if (p.idle && opening >= least) return;

  const Lanes slip = relative - opening * p.normal;

  Lanes friction = p.friction - p.acrossMass * slip;
  const double squared = sum(friction * friction);
  const double most = p.coefficient * p.push;
  p.sliding = squared > most * most;
  if (p.sliding) friction *= std::min(p.coefficient, pass.kinetic) * p.push / __builtin_sqrt(squared);
  const Lanes change = friction - p.friction;
  p.friction = friction;
  Lanes momentUpper, momentLower;
  crossLanes(p.armUpper, change, momentUpper);
  crossLanes(p.armLower, change, momentLower);

  const double now = opening + sum(p.turnUpper * momentUpper + p.turnLower * momentLower);
  const double push = std::max(0.0, p.push + p.normalMass * share * (least - now) - released * p.push);
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
}

SPRINGTOWER_KERNEL
void solvePoints(const Pass& pass, std::vector<SolverBody>& bodies, std::vector<ContactConstraint>& points) {
  for (ContactConstraint& point : points) solvePoint(pass, bodies, point);
}

// Warm start with the impulses of the step before.
SPRINGTOWER_KERNEL
void applyWarmStart(std::vector<SolverBody>& bodies, const std::vector<ContactConstraint>& points) {
  for (const ContactConstraint& p : points) {
    if (p.idle) continue;
    SolverBody& upper = bodies[static_cast<std::size_t>(p.upper)];
    SolverBody& lower = bodies[static_cast<std::size_t>(p.lower)];
    const Lanes impulse = p.friction + p.push * p.normal;
    Lanes moment, turn;
    crossLanes(p.armUpper, impulse, moment);
    timesLanes(upper.inverseInertia, moment, turn);
    upper.velocity += upper.inverseMass * impulse;
    upper.spin += turn;
    crossLanes(p.armLower, impulse, moment);
    timesLanes(lower.inverseInertia, moment, turn);
    lower.velocity -= lower.inverseMass * impulse;
    lower.spin -= turn;
  }
}

// Marks the bodies with a contact that pushes. Returns whether there is any.
bool markPushed(RigidIsland& island) {
  for (RigidBody& body : island.bodies) body.pushed = false;
  for (const PointList* list : {&island.steady, &island.fast}) {
    for (const ContactConstraint& p : list->points) {
      if (!(p.push > 0.0)) continue;
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

double kineticEnergy(const std::vector<RigidBody>& bodies) {
  double energy = 0.0;
  for (const RigidBody& body : bodies) {
    if (body.inverseMass == 0.0) continue;  // driven
    const Vec3 spin = body.axes.transpose() * body.spin;
    energy += 0.5 * (body.velocity.squaredNorm() / body.inverseMass + spin.dot(body.moment * spin));
  }
  return energy;
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

// Passes over all points, from the bodies' velocities to their new velocities.
void runPasses(IslandStep& step, RigidIsland& island, int passes, bool push) {
  const Scene& scene = step.simulation.scene;
  Pass pass;
  pass.step_s = step.drift_s;
  pass.kinetic = scene.kineticFriction;
  pass.most = tuning::kMaxPushSpeed * step.simulation.lengths.blockHeight_m / step.simulation.lengths.fallTime_s;
  pass.soft = isRigid(scene.settings.method) ? softness(step.drift_s) : Softness{tuning::kRigidModeBaumgarte / step.drift_s};
  pass.push = push;
  pass.rounding = step.simulation.lengths.contactError_m;
  if (push) {
    applyWarmStart(island.movers, island.steady.points);
    applyWarmStart(island.movers, island.fast.points);
  }
  for (int i = 0; i < passes; ++i) {
    solvePoints(pass, island.movers, island.steady.points);
    solvePoints(pass, island.movers, island.fast.points);
  }
  step.counters.contactEvaluations +=
      static_cast<std::uint64_t>(passes) * (island.steady.points.size() + island.fast.points.size());
  writeMovers(island);
}

// One pass while an island is fast; more where its blocks overlap, or are coming to rest: then the load of a pile sinks in by
// what a pass leaves, and there is no energy to lift it again.
int rigidModePasses(const IslandStep& step, const RigidIsland& island) {
  if (isDeep(step, island)) return tuning::kDeepOverlapPasses;
  double mass = 0.0;
  for (const RigidBody& body : island.bodies) mass += body.inverseMass > 0.0 ? 1.0 / body.inverseMass : 0.0;
  const Lengths& lengths = step.simulation.lengths;
  const double slow = tuning::kRigidEntrySpeed * lengths.blockHeight_m / lengths.fallTime_s;
  return 2.0 * island.energyBefore_j < mass * slow * slow ? tuning::kSlowIslandPasses : 1;
}

// Friction is static where a point stuck in the substep before, otherwise kinetic.
void chooseFriction(const Scene& scene, PointList& list) {
  for (ContactConstraint& p : list.points) p.coefficient = p.sliding ? scene.kineticFriction : scene.staticFriction;
}

// Moves the bodies by their velocities; adds the work of gravity to island.energyBefore_j.
void moveBodies(IslandStep& step, RigidIsland& island) {
  for (RigidBody& body : island.bodies) {
    moveFreely(body, step.drift_s);
    if (body.inverseMass == 0.0) continue;  // driven
    if (!isRigid(step.simulation.scene.settings.method) && !body.pushed) {
      // In free flight: moves by its mean velocity, not by that of the step's end.
      const Vec3 lag = 0.5 * step.drift_s * step.drift_s * step.gravity;
      body.place -= lag;
      body.moved -= lag;
    }
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
    body.moved.setZero();
    body.turned.setZero();
  }
  island.energyBefore_j = kineticEnergy(island.bodies);
  applyForces(step);
  readMovers(island);
  placeConstraints(island);
  chooseFriction(scene, island.steady);
  chooseFriction(scene, island.fast);
  int passes = scene.settings.iterations;
  if (rigidMode) passes = std::max(passes, rigidModePasses(step, island));
  runPasses(step, island, passes, true);
  island.touches = markPushed(island);
  moveBodies(step, island);
  moveGaps(island);
  readMovers(island);
  runPasses(step, island, scene.settings.iterations, false);
  // Not in the rigid methods: there, blocks of a stack move by such slow pushes only, and the clamp would suppress them.
  // Nor with a driven block, which does work.
  if (rigidMode && island.touches && step.driven.empty())
    removeAddedEnergy(island.bodies, kineticEnergy(island.bodies) - island.energyBefore_j);
}

}  // namespace springtower
