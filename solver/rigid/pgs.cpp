#include "core/tuning.h"
#include "solver/contact/rigid_contacts.h"
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
  double kinetic;  // coefficient of friction
  double most;     // m/s, largest push-out speed
  Softness soft;   // of those that overlap
  bool push;       // true: overlapping blocks are pushed apart; false: the push-out is removed from the velocities
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
  if (p.gap > 0.0) {
    least = -p.gap / pass.step_s;
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

// Updates the gaps to the step's end, to first order in the rotations.
SPRINGTOWER_KERNEL
void moveGaps(const std::vector<RigidBody>& bodies, std::vector<ContactConstraint>& points) {
  const auto read = [&](std::int32_t at, Lanes& moved, Lanes& turned) {
    moved = turned = Lanes{0.0, 0.0, 0.0, 0.0};
    if (static_cast<std::size_t>(at) == bodies.size()) return;
    const RigidBody& body = bodies[static_cast<std::size_t>(at)];
    moved = Lanes{body.moved[0], body.moved[1], body.moved[2], 0.0};
    turned = Lanes{body.turned[0], body.turned[1], body.turned[2], 0.0};
  };
  for (ContactConstraint& p : points) {
    Lanes movedUpper, turnedUpper, movedLower, turnedLower;
    read(p.upper, movedUpper, turnedUpper);
    read(p.lower, movedLower, turnedLower);
    p.gap += sum(p.normal * (movedUpper - movedLower) + (p.leverUpper * turnedUpper - p.leverLower * turnedLower));
  }
}

// Marks the bodies with a contact that pushes. Returns whether there is any.
bool markPushed(RigidIsland& island) {
  for (RigidBody& body : island.bodies) body.pushed = false;
  for (const ContactConstraint& p : island.points) {
    for (const std::int32_t at : {p.upper, p.lower}) {
      if (p.push > 0.0 && static_cast<std::size_t>(at) < island.bodies.size())
        island.bodies[static_cast<std::size_t>(at)].pushed = true;
    }
  }
  return std::any_of(island.bodies.begin(), island.bodies.end(), [](const RigidBody& body) { return body.pushed; });
}

// Whether any two blocks overlap deeply.
bool isDeep(const IslandStep& step, const RigidIsland& island) {
  const double deep = -tuning::kDeepOverlap * step.simulation.lengths.blockHeight_m;
  return std::any_of(island.points.begin(), island.points.end(), [&](const ContactConstraint& p) { return p.gap < deep; });
}

double kineticEnergy(const std::vector<RigidBody>& bodies) {
  double energy = 0.0;
  for (const RigidBody& body : bodies) {
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
  if (push) applyWarmStart(island.movers, island.points);
  for (int i = 0; i < passes; ++i) solvePoints(pass, island.movers, island.points);
  step.counters.contactEvaluations += static_cast<std::uint64_t>(passes) * island.points.size();
  writeMovers(island);
}

}  // namespace

// Sequential impulses (projected Gauss-Seidel on velocities; Catto 2005) with warm starting. Separated blocks may approach by
// their gap in one step; overlapping ones are pushed apart softly, and a second set of passes removes that push from the
// velocities (soft contacts with relaxation, as in Catto's Solver2D, 2024).
void solveAndIntegratePgs(IslandStep& step, RigidIsland& island, bool again) {
  const bool rigidMode = !isRigid(step.simulation.scene.settings.method);
  island.energyBefore_j = kineticEnergy(island.bodies);
  applyForces(step);
  gatherPoints(step, island, again);
  int passes = step.simulation.scene.settings.iterations;
  if (rigidMode && isDeep(step, island)) passes = std::max(passes, tuning::kDeepOverlapPasses);
  runPasses(step, island, passes, true);
  island.touches = markPushed(island);
  for (RigidBody& body : island.bodies) {
    moveFreely(body, step.drift_s);
    if (rigidMode && !body.pushed) {  // in free flight: moves by its mean velocity, not by that of the step's end
      const Vec3 lag = 0.5 * step.drift_s * step.drift_s * step.gravity;
      body.place -= lag;
      body.moved -= lag;
    }
    island.energyBefore_j += body.moved.dot(step.gravity) / body.inverseMass;
  }
}

void relaxPgs(IslandStep& step, RigidIsland& island) {
  moveGaps(island.bodies, island.points);
  readMovers(island);
  runPasses(step, island, step.simulation.scene.settings.iterations, false);
  // Not in the rigid methods: there, blocks of a stack move by such slow pushes only, and the clamp would suppress them.
  if (!isRigid(step.simulation.scene.settings.method) && island.touches)
    removeAddedEnergy(island.bodies, kineticEnergy(island.bodies) - island.energyBefore_j);
  keepPoints(step, island);
}

}  // namespace springtower
