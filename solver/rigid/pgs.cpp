#include "core/tuning.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/rigid/added_energy.h"
#include "solver/rigid/common_motion.h"
#include "solver/rigid/constraints.h"
#include "solver/rigid/impact.h"
#include "solver/rigid/methods.h"
#include "solver/rigid/over_bodies.h"
#include "solver/rigid/packs.h"
#include "solver/rigid/passes.h"
#include "solver/rigid/patch_friction.h"
#include "solver/rigid/run.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace springtower {

namespace {

Softness softness(double step_s) {
  const double omega = 2.0 * std::numbers::pi * tuning::kSoftContactRate / step_s;
  const double a = 2.0 * tuning::kSoftDampingRatio + step_s * omega;
  const double b = step_s * omega * a;
  return {omega / a, b / (1.0 + b), 1.0 / (1.0 + b)};
}

// Depth of the deepest overlap beyond what compresses the springs, m.
double deepestOverlap(const RigidIsland& island) {
  Lanes least = {0.0, 0.0, 0.0, 0.0};
  for (const PackedPoints* packed : packsOf(island)) {
    for (const PackedPoint& p : packed->points) {
      Lanes slack;
      slackOf(p, slack);
      smallerOf(slack, least, least);
    }
  }
  return -std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
}

double massOf(const RigidIsland& island) {
  double mass = 0.0;
  for (const RigidBody& body : island.bodies) mass += body.inverseMass > 0.0 ? 1.0 / body.inverseMass : 0.0;
  return mass;
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

// Marks the bodies that meet in an impact.
void markImpacts(RigidIsland& island) {
  island.changed.assign(island.bodies.size() + 1, -1);
  for (PackedPoints* packed : packsOf(island)) {
    listPairsOfBodies(island, *packed);
    packed->due.assign(packed->pairs.size(), -1);
  }
  for (const PackedPoints* packed : packsOf(island)) {
    for (const std::int32_t i : packed->active) {
      const PackedPair& pair = packed->pairs[static_cast<std::size_t>(i)];
      LaneMask meets{};
      for (const PackedPoint& p : pointsOf(*packed, pair)) {
        meets |= (p.push > 0.0) & (p.impact > 0.0);
      }
      for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
        if (meets[static_cast<int>(lane)] == 0) continue;
        for (const std::int32_t body : {pair.upper[lane], pair.lower[lane]}) {
          if (body != unmovedBody(island)) noteChange(body, 0, island);
        }
      }
    }
  }
}

// Passes through the impacts of a substep, the fastest of them at this speed, m/s: what rebounds leaves, so an impact is solved
// at once, through all blocks that it reaches.
void solveImpacts(IslandStep& step, RigidIsland& island, const Pass& pass, double impact) {
  const std::size_t active = island.steady.packed.activePoints + island.fast.packed.activePoints;
  const std::size_t most =
      std::max(static_cast<std::size_t>(tuning::kImpactSweeps) * active, static_cast<std::size_t>(tuning::kMaxImpactEvaluations));
  markImpacts(island);
  std::size_t solved = 0;
  for (int number = 1; number <= tuning::kMaxImpactPasses && solved < most; ++number) {
    const double enough = tuning::kImpactPrecision * impact;
    const std::size_t before = solved;
    for (PackedPoints* packed : packsOf(island)) solved += solveChanged(pass, island, *packed, number, enough);
    if (solved == before) break;
  }
  step.counters.contactEvaluations += solved;
}

// Passes over the active points: so many, and up to as many times more as the island's largest mass is that of its smallest,
// until the last has changed the blocks' way against one another by no more than a share of a height in the substep. A light
// block between heavy ones takes so many passes, be it that they close or that impulses which were too large are taken back: what
// is left of these is energy. Every other pass takes a pair's points in reverse, the last of `passes` does not: always in one
// order, the first point of a face carries more for many passes than the last, and its block turns.
void runPasses(IslandStep& step, RigidIsland& island, Pass pass, int passes) {
  const std::size_t active = std::max<std::size_t>(1, island.steady.packed.activePoints + island.fast.packed.activePoints);
  const int affordable = static_cast<int>(static_cast<std::size_t>(tuning::kConvergingEvaluations) / active);
  const int limit = std::max({passes, tuning::kConvergingPasses, affordable});
  const double more = (island.massRatio - 1.0) * std::max(1, passes);
  const int most = static_cast<int>(std::min(static_cast<double>(limit), passes + more));
  const double heightsLeft = pass.push ? tuning::kMaxApproachLeft : tuning::kMaxRelaxationLeft;
  const double enough = heightsLeft * step.simulation.lengths.blockHeight_m / pass.step_s;
  double left = std::numeric_limits<double>::infinity();
  for (int i = 0; i < passes || (left > enough && i < most); ++i) {
    left = 0.0;
    pass.reversed = (passes - i) % 2 == 0;
    for (PackedPoints* packed : packsOf(island)) {
      left = std::max(left, solveActive(pass, island.motions, *packed));
      step.counters.contactEvaluations += packed->activePoints;
    }
  }
  const double impact = fastestImpact(island);
  if (impact > 0.0) solveImpacts(step, island, pass, impact);
}

// Work of the impulses so far where overlap is pushed out at a rate (1/s): what that lifts, J.
double workOfPushOut(const RigidIsland& island, double rate) {
  Lanes sum4 = {0.0, 0.0, 0.0, 0.0};
  for (const PackedPoints* packed : packsOf(island)) {
    for (const PackedPoint& p : packed->points) {
      Lanes slack;
      slackOf(p, slack);
      const Lanes overlap = slack < 0.0 ? -slack : Lanes{0.0, 0.0, 0.0, 0.0};
      sum4 += p.push * overlap;
    }
  }
  return rate * sum(sum4);
}

// The share of the usual rate at which overlap is pushed out. In rigid mode it is paid by energy that the frame has lost before,
// and by as little beside it as lets a pile at rest come up again; a hand, a force or a driven block does work.
double shareOfPushOut(const IslandStep& step, const RigidIsland& island, double rate) {
  if (isRigid(step.simulation.scene.settings.method) || isWorkedOn(step)) return 1.0;
  const double work_j = workOfPushOut(island, rate);
  return work_j > 0.0 ? std::clamp((freePushOut(step.simulation, massOf(island)) - island.gained_j) / work_j, 0.0, 1.0) : 1.0;
}

// Passes in rigid mode that cost little because few points are active, or that a stack needs which is hit and mostly stands: the
// overlap that fewer leave would shift its load for good. Precondition: `active` > 0.
int affordablePasses(const IslandStep& step, const RigidIsland& island, std::size_t active) {
  const auto within = [&](int passes, int evaluations) {
    return static_cast<int>(std::min(static_cast<std::size_t>(passes), static_cast<std::size_t>(evaluations) / active));
  };
  const bool stands = !isRigid(step.simulation.scene.settings.method) && island.stands;
  return stands ? within(tuning::kStandingPasses, tuning::kStandingEvaluations)
                : within(tuning::kCheapPasses, tuning::kCheapEvaluations);
}

// Passes by which blocks come no nearer than they may, from the bodies' velocities to new ones. The first finds the active
// points.
void stopAtContact(IslandStep& step, RigidIsland& island, int passes) {
  Pass pass = passOf(step, true);
  const double share = shareOfPushOut(step, island, pass.soft.rate);
  if (share < 1.0) pass.soft = Softness{share * pass.soft.rate};
  for (const PackedPoints* packed : packsOf(island)) applyWarmStart(island.motions, *packed);
  for (PackedPoints* packed : packsOf(island)) step.counters.contactEvaluations += solveAll(pass, island.motions, *packed);
  const std::size_t active = std::max<std::size_t>(1, island.steady.packed.activePoints + island.fast.packed.activePoints);
  runPasses(step, island, pass, std::max(passes, affordablePasses(step, island, active)) - 1);
  writeBodies(island);
}

// Passes that remove the push-out from the velocities, and by which what has met rebounds.
// Returns whether any pair has rebounded.
bool relaxAndRebound(IslandStep& step, RigidIsland& island, int passes) {
  readVelocities(island);
  const bool rebounds = fastestImpact(island) > 0.0;
  island.rebounds = island.rebounds || rebounds;
  runPasses(step, island, passOf(step, false), passes);
  if (rebounds && step.driven.empty()) boundRebound(island, island.energyBefore_j);
  writeBodies(island);
  if (rebounds) forgetImpact(step, island);
  return rebounds;
}

// Passes move blocks by more than their velocities where they push overlap out. If the frame has gained energy that nothing lost
// before pays for, takes back the share of that extra motion whose lifting work is the unpaid energy. Between very unlike masses
// a push that is too large is corrected only slowly over the passes. `rebounds`: blocks have met in the substep; what the
// velocity of one that was struck leaves of its motion is no push-out. `kinetic_j`: kinetic energy of all bodies; returns what it
// is then, as their axes turn.
double lowerUnpaid(const IslandStep& step, bool rebounds, double kinetic_j, RigidIsland& island) {
  if (!island.touches || isWorkedOn(step)) return kinetic_j;
  const double unpaid_j =
      kinetic_j - island.energyBefore_j - std::max(0.0, freePushOut(step.simulation, massOf(island)) - island.gained_j);
  if (!(unpaid_j > 0.0)) return kinetic_j;
  const auto excessOf = [&](const RigidBody& body) { return Vec3(body.moved - step.drift_s * body.velocity); };
  const auto isPushedOut = [&](const RigidBody& body) {
    return body.pushed && body.inverseMass > 0.0 && !(rebounds && body.struck);
  };
  double lifted_j = 0.0;
  for (const RigidBody& body : island.bodies) {
    if (isPushedOut(body)) lifted_j -= excessOf(body).dot(step.gravity) / body.inverseMass;
  }
  if (!(lifted_j > 0.0)) return kinetic_j;
  const double share = std::min(1.0, unpaid_j / lifted_j);
  for (RigidBody& body : island.bodies) {
    if (!isPushedOut(body)) continue;
    const Vec3 excess = share * excessOf(body);
    body.place -= excess;
    body.moved -= excess;
    turnAxes(-share * (body.turned - step.drift_s * body.spin), body.axes);
    island.energyBefore_j -= excess.dot(step.gravity) / body.inverseMass;
  }
  return kineticEnergy(island.bodies);
}

// Few passes while an island is fast; more where its blocks overlap, or are coming to rest: then the load of a pile sinks in by
// what a pass leaves, and there is no energy to lift it again.
int rigidModePasses(const IslandStep& step, const RigidIsland& island) {
  const Lengths& lengths = step.simulation.lengths;
  const double entry = tuning::kRigidEntrySpeed * lengths.blockHeight_m / lengths.fallTime_s;
  const bool slow = 2.0 * island.energyBefore_j < massOf(island) * entry * entry;
  // What a hand or a force leaves in place depends on friction.
  if ((slow || island.stands) && (holdsTether(step) || isPushed(step))) return tuning::kCheapPasses;
  if (deepestOverlap(island) > tuning::kDeepOverlap * lengths.blockHeight_m) return tuning::kDeepOverlapPasses;
  return slow ? tuning::kSlowIslandPasses : tuning::kFastIslandPasses;
}

}  // namespace

// Sequential impulses (projected Gauss-Seidel on velocities; Catto 2005) with warm starting. Separated blocks may approach by
// their gap in one step; overlapping ones are pushed apart softly, and a second set of passes removes that push from the
// velocities (soft contacts with relaxation, as in Catto's Solver2D, 2024).
void stepImpulses(IslandStep& step, RigidIsland& island) {
  const Scene& scene = step.simulation.scene;
  const bool rigidMode = !isRigid(scene.settings.method);
  overBodies(island, [&](std::size_t i) {
    RigidBody& body = island.bodies[i];
    updateInertia(body);
    body.velocityBefore = body.velocity;
    body.moved.setZero();
    body.turned.setZero();
  });
  if (island.steady.points.empty() && island.fast.points.empty()) {
    applyForces(step);
    overBodies(island, [&](std::size_t i) {
      island.bodies[i].pushed = false;
      moveInStep(step, island.bodies[i]);
    });
    island.touches = false;
    return;
  }
  island.energyBefore_j = kineticEnergy(island.bodies);
  readBodies(island);
  const Springs springs{step.drift_s, step.simulation.tolerance_m, step.simulation.lengths.contactError_m, !island.stands,
                        step.drift_s / (step.drift_s + scene.settings.frame_s)};
  for (PackedPoints* packed : packsOf(island)) placeConstraints(island, springs, *packed);
  setImpacts(step, island);
  choosePatchFriction(step, island);
  applyForces(step);
  readVelocities(island);
  const bool isolated = isIsolated(island);
  const Vec3 momentum = isolated ? angularMomentum(island) : Vec3(Vec3::Zero());
  int passes = scene.settings.iterations;
  if (rigidMode) passes = std::max(passes, rigidModePasses(step, island));
  stopAtContact(step, island, passes);
  island.touches = markPushedByPoints(step, island);
  overBodies(island, [&](std::size_t i) { moveInStep(step, island.bodies[i]); });
  addWorkOfForces(step, island);
  moveGaps(island);
  const bool rebounds = relaxAndRebound(step, island, scene.settings.iterations);
  if (isolated) restoreAngularMomentum(momentum, island);
  // Not in the rigid methods: there, blocks of a stack move by such slow pushes only, and the clamp would suppress them.
  if (rigidMode) {
    double kinetic_j = kineticEnergy(island.bodies);
    const double added_j = kinetic_j - island.energyBefore_j;
    if (added_j > 0.0 && island.touches && step.driven.empty()) {  // a driven block does work
      isolated ? removeAddedEnergy(added_j, island) : takeGivenEnergy(added_j, step.drift_s, island);
      kinetic_j = kineticEnergy(island.bodies);
    }
    if (!isolated) kinetic_j = lowerUnpaid(step, rebounds, kinetic_j, island);
    island.gained_j += kinetic_j - island.energyBefore_j;
  }
}

}  // namespace springtower
