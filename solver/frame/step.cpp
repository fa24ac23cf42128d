#include "core/error.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/contact/approach.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/query.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/contact/update.h"
#include "solver/explicit/leapfrog.h"
#include "solver/explicit/stable_step.h"
#include "solver/frame/island_modes.h"
#include "solver/frame/pairs.h"
#include "solver/frame/plane.h"
#include "solver/implicit/equilibrium.h"
#include "solver/implicit/run.h"
#include "solver/reference/midpoint.h"
#include "solver/reference/report_frame.h"
#include "solver/reference/report_step.h"
#include "solver/reference/runge_kutta4.h"
#include "solver/rigid/run.h"
#include "solver/sleep/rest.h"
#include "solver/world/checkpoint.h"
#include "solver/world/island_step.h"
#include "solver/world/poison.h"
#include "solver/world/stiffness.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <optional>

namespace springtower {

namespace {

// What may meet in an island during this frame.
struct ApproachEstimate {
  double speed = 0.0;          // m/s, largest at which any two of its near blocks may meet
  double reducedMass = 0.0;    // kg, largest
  double cornerInverse = 0.0;  // 1/kg, largest: the inverse mass of two corners against each other
  bool meeting = false;        // whether blocks that are apart may meet at all
  int together = 0;            // most pairs of any one block that may begin to push: hit at once they add up
};

ApproachEstimate approachOf(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  std::vector<std::int32_t>& newContacts = step.engine.scratch.newContactCount;
  for (const std::int32_t block : step.blocks) newContacts[static_cast<std::size_t>(block)] = 0;
  const ParticleArray& velocity = simulation.state.velocity;
  const double corner = affineCornerInverseMass(simulation.scene.settings.inertia);
  const double frame_s = simulation.scene.settings.frame_s;
  const double fall = simulation.scene.gravity.magnitude * frame_s;
  ApproachEstimate approach;
  const PairTable& pairs = step.engine.pairs;
  for (const std::int32_t position : step.pairs) {
    const auto at = static_cast<std::size_t>(position);
    const BlockPair& pair = pairs.key[at];
    const auto a = static_cast<std::size_t>(pair.a);
    const double massA = simulation.model.mass[a];
    // A block that has been at rest is held; another may be in free fall.
    bool resting = simulation.restTime_s[a] > 0.0;
    double speed = 0.0;
    double reduced = massA;
    double inverse = corner / massA;
    double travel = step.engine.memo.blockHistory[a].travel;
    if (pair.b < 0) {
      speed = fastestCorner(velocity, a, Vec3::Zero());
    } else {
      const auto b = static_cast<std::size_t>(pair.b);
      const Vec3 common = 0.5 * (centre(velocity, a) + centre(velocity, b));
      speed = fastestCorner(velocity, a, common) + fastestCorner(velocity, b, common);
      const double massB = simulation.model.mass[b];
      reduced = massA * massB / (massA + massB);
      inverse += corner / massB;
      travel += step.engine.memo.blockHistory[b].travel;
      resting = resting && simulation.restTime_s[b] > 0.0;
    }
    if (!resting) speed += fall;
    const bool apart = !pairs.touches(at);
    const bool mayMeet = apart && pairs.clearance[at] - (travel - pairs.travelAtCheck[at]) < speed * frame_s;
    if (apart && !mayMeet) continue;
    if (apart || !anyPointTouches(contactOf(step.engine, at))) {
      for (const std::int32_t block : {pair.a, pair.b}) {  // sleepers may be those of other islands as well, and do not move
        if (!sleeps(simulation, block))
          approach.together = std::max(approach.together, ++newContacts[static_cast<std::size_t>(block)]);
      }
    }
    approach.meeting = approach.meeting || mayMeet;
    approach.speed = std::max(approach.speed, speed);
    approach.reducedMass = std::max(approach.reducedMass, reduced);
    approach.cornerInverse = std::max(approach.cornerInverse, inverse);
  }
  return approach;
}

// What the hand's springs and dashpots add to the squared frequencies (1/s2) and damping rates (1/s) of an island.
struct TetherRates {
  double stiffness = 0.0;
  double damping = 0.0;
};

TetherRates tetherRates(const IslandStep& step) {
  if (!holdsTether(step)) return {};
  const Tether& tether = step.simulation.tether;
  const double mass = step.simulation.model.mass[index(tether.block)];
  const double own = inverseMass(step.simulation.scene.settings.inertia).own;
  return {std::max(tether.stiffness_n_m, own * tether.cornerStiffness_n_m) / mass,
          std::max(tether.damping_n_s_m, own * tether.cornerDamping_n_s_m) / mass};
}

// By how much a further damping rate shortens the step that dt^2 K + 2 dt C < 4 allows.
double shortening(double radius, double dampingTime_s, double damping) {
  const auto longest = [&](double rate) { return std::sqrt(rate * rate + 4.0 * radius) - rate; };
  return longest(dampingTime_s * radius + damping) / longest(dampingTime_s * radius);
}

// Chooses the number of steps of an island for this frame, and how stiff contacts born in it may be.
int chooseSubsteps(IslandStep& step) {
  Simulation& simulation = step.simulation;
  const Settings& settings = simulation.scene.settings;
  BlockHistory& record = step.engine.memo.blockHistory[static_cast<std::size_t>(step.blocks.front())];
  const std::uint64_t signature = contactSignature(step.engine, step.pairs) ^ (step.blocks.size() << 1U);
  if (signature != record.contactSignature || record.spectralRadius == 0.0) {
    record.spectralRadius = spectralBound(simulation, step.blocks, step.pairs);
    record.contactSignature = signature;
  }
  const double standing = record.spectralRadius;
  const double stiffness = simulation.contactStiffness_n_m * (1.0 + settings.maxwellRatio);
  const ApproachEstimate approach =
      settings.method == Method::report ? ApproachEstimate{} : approachOf(step);  // its contacts have no stiffness
  const double depth = impactDepth_m(settings, simulation.tolerance_m, simulation.lengths.blockHeight_m);
  const double wanted =
      approach.reducedMass * approach.speed * approach.speed / (depth * depth * simulation.contactStiffness_n_m);
  const double born = 2.0 * stiffness * approach.cornerInverse;  // what one new contact at rest stiffness adds
  // Pairs of a block that are hit at once add up: all of them may be as stiff as at rest, or one as the impact wants it.
  const double together = std::max(1, approach.together);

  double allowed = 0.0;  // largest eigenvalue the step bears
  int substeps = simulation.fixedSubsteps;
  if (substeps > 0) {
    allowed =
        stableSpectralRadius(settings.method, settings.frame_s / substeps, simulation.dampingTime_s, settings.stabilitySafety);
  } else {
    const TetherRates held = tetherRates(step);
    const double begun = standing + (approach.meeting || wanted > 1.0 ? together * born : 0.0);
    const double needed = std::max(begun, standing + (wanted > 1.0 ? wanted * born : 0.0));
    const double margin = settings.stabilitySafety * (settings.method == Method::report ? tuning::kReportStepMargin : 1.0);
    const auto stepsFor = [&](double radius) {
      const double dt = stableStep(settings.method, radius + held.stiffness, simulation.dampingTime_s, margin) *
                        shortening(radius + held.stiffness, simulation.dampingTime_s, held.damping);
      return std::clamp(std::ceil(settings.frame_s / dt), 1.0, static_cast<double>(tuning::kMaxExplicitSubsteps));
    };
    substeps = static_cast<int>(std::min(stepsFor(needed), std::max<double>(tuning::kMaxImpactSubsteps, stepsFor(begun))));
    allowed =
        stableSpectralRadius(settings.method, settings.frame_s / substeps, simulation.dampingTime_s, settings.stabilitySafety);
    if (held.stiffness > 0.0) allowed = std::min(allowed, needed);
  }
  step.maxStiffening = born > 0.0 ? std::clamp((allowed - standing) / (together * born), 1.0, std::max(1.0, wanted)) : 1.0;
  return substeps;
}

void stepIsland(Method method, IslandStep& step) {
  switch (method) {
    case Method::implicit:
    case Method::implicitEuler:
    case Method::implicitEigen:  // what implicit steps do not fit
    case Method::semiImplicitEuler:
      stepSemiImplicitEuler(step);
      return;
    case Method::midpoint:
      stepMidpoint(step);
      return;
    case Method::rungeKutta4:
      stepRungeKutta4(step);
      return;
    case Method::report:
      stepReport(step);
      return;
    case Method::rigidPgs:  // these step through runRigidSteps
    case Method::rigidLcp:
    case Method::xpbd:
    case Method::automatic:  // is another one by now
      return;
  }
}

IslandOutcome runIsland(IslandStep& step) {
  Simulation& simulation = step.simulation;
  const Settings& settings = simulation.scene.settings;
  IslandOutcome outcome;
  step.pointKind = pointKindOf(settings.method);
  if (simulation.frame == 0 && settings.method != Method::report) findTouching(step);
  if (isRigid(settings.method)) return runRigidSteps(step, rigidSubsteps(settings), 0.0);
  if (simulation.frame == 0 && settings.method != Method::report) startInEquilibrium(step);
  double begin_s = 0.0;
  if (isImplicit(settings.method)) {
    const IslandFacts facts = islandFacts(step);
    IslandMode mode = nextMode(ModeChange::frameBegins, facts);
    setMode(step, mode);
    if (mode == IslandMode::implicit) {
      outcome = runImplicitSteps(step, facts.mostlyFallen, begin_s);
      if (!outcome.inside || begin_s >= settings.frame_s) return outcome;
      mode = nextMode(ModeChange::implicitGaveUp, facts);
      if (mode == IslandMode::rigid) setMode(step, mode);
    }
    if (mode == IslandMode::rigid) {
      const int before = outcome.substeps;
      outcome = runFall(step, begin_s);
      outcome.substeps += before;
      return outcome;
    }
  }
  const int implicitSteps = outcome.substeps;
  const double rest_s = settings.frame_s - begin_s;
  outcome.substeps = std::max(1, static_cast<int>(std::ceil(chooseSubsteps(step) * rest_s / settings.frame_s - 1e-9)));
  step.drift_s = rest_s / outcome.substeps;
  BlockHistory& record = step.engine.memo.blockHistory[static_cast<std::size_t>(step.blocks.front())];
  double last = record.lastExplicitStep_s;
  step.usesActiveList = true;
  step.activeListSteps = 0;
  for (int substep = 0; substep < outcome.substeps; ++substep) {
    step.time_s = simulation.time_s + begin_s + substep * step.drift_s;
    step.gravity = simulation.scene.gravity.at(step.time_s);
    step.kick_s = 0.5 * (last + step.drift_s);
    step.advance_s = last;
    stepIsland(settings.method, step);
    last = step.drift_s;
    outcome.inside = settings.method == Method::report ? acceptReportStep(step)
                                                       : updateContacts(step, refreshTravelOfExplicitSteps(simulation));
    if (!outcome.inside) break;
  }
  for (const std::int32_t block : step.blocks) {
    BlockHistory& history = step.engine.memo.blockHistory[static_cast<std::size_t>(block)];
    history.lastExplicitStep_s = last;
    history.explicitLast = true;
    history.lastImplicitStep_s = 0.0;
  }
  outcome.substeps += implicitSteps;
  return outcome;
}

// Block turned inside out or flattened: the mean edges' volume against that of its dimensions.
void checkShapes(const Simulation& simulation, std::span<const std::int32_t> blocks) {
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    const ParticleArray& x = simulation.state.position;
    const double volume =
        meanEdge(x, b, 0).cross(meanEdge(x, b, 1)).dot(meanEdge(x, b, 2)) / simulation.model.dimensions[b].prod();
    if (volume > tuning::kMinVolumeRatio) continue;
    throw DivergenceError(fmt::format("block {} diverged at {:.6f} s: it was turned inside out (volume {:.3g} of its own)", block,
                                      simulation.time_s, volume),
                          block, simulation.time_s);
  }
}

// Runs all islands through the frame; false when one has left its swept boxes.
bool runIslands(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const std::size_t islands = engine.memo.islands.count();
  engine.scratch.islandCounters.assign(islands, Counters{});
  engine.scratch.islandTimes.assign(islands, StageTimes{});
  engine.scratch.islandOutcome.assign(islands, 0);
  const ContactLaw law = contactLaw(simulation);
  prepareFrameStart(simulation);
  if (simulation.scene.settings.method == Method::report) prepareReportFrame(simulation);
  bool wide = false;
  for (std::size_t i = 0; i < islands; ++i) wide = wide || engine.memo.islands.island(i).size() >= tuning::kParallelBlocks;
  engine.contacts.reserve(engine.pairs.size(), wide);
  if (engine.memo.topologyChanged) {
    for (const std::int32_t contact : engine.pairs.contact) {
      if (contact >= 0) engine.contacts.pose(contact) = RelativePose{};
    }
  }
  tbb::parallel_for(std::size_t{0}, islands, [&](std::size_t i) {
    const auto first = static_cast<std::size_t>(engine.memo.pairStart[i]);
    IslandStep step{simulation,
                    engine,
                    engine.memo.islands.island(i),
                    std::span<const std::int32_t>(engine.memo.islandPairs)
                        .subspan(first, static_cast<std::size_t>(engine.memo.pairStart[i + 1]) - first),
                    engine.scratch.islandCounters[i],
                    engine.scratch.islandTimes[i],
                    law};
    saveFrameStart(step);
    const IslandOutcome outcome = runIsland(step);
    engine.scratch.islandOutcome[i] = outcome.inside ? outcome.substeps : -1;
  });
  bool inside = true;
  simulation.substeps = 0;
  for (std::size_t i = 0; i < islands; ++i) {
    inside = inside && engine.scratch.islandOutcome[i] >= 0;
    simulation.substeps = std::max(simulation.substeps, engine.scratch.islandOutcome[i]);
  }
  for (std::size_t i = 0; i < islands; ++i) simulation.stageTimes += engine.scratch.islandTimes[i];
  return inside;
}

}  // namespace

void stepFrame(Simulation& simulation) {
  Engine& engine = *simulation.engine;
#ifndef NDEBUG
  poisonScratch(engine);
#endif
  wakeForInputs(simulation);
  engine.scratch.lostPartners.clear();
  if (engine.sleep.awakeCount > 0) {
    double margin = tuning::kSweepMargin * simulation.lengths.blockHeight_m;
    findNearPairs(simulation, margin);
    while (true) {
      // The frame is run again where something was hit and left its swept box, with a wider one, so that no meeting is missed;
      // and where supports of sleepers failed, with these awake.
      if (wakeOnImpact(simulation)) findNearPairs(simulation, margin);
      const bool inside = runIslands(simulation);
      const bool failed = inside && wakeFailedSupports(simulation);
      if (inside && !failed) break;
      ++simulation.counters.replayedFrames;
      if (!inside) margin *= tuning::kReplayMarginGrowth;
      restoreFrame(simulation);
      if (simulation.scene.settings.method == Method::report) rewindReportFrame(simulation);
      findNearPairs(simulation, margin);
    }
    for (const Counters& island : engine.scratch.islandCounters) simulation.counters += island;
    simulation.counters.steps += static_cast<std::uint64_t>(simulation.substeps);
  } else {
    simulation.substeps = 0;
  }
  ++simulation.frame;
  ++simulation.counters.frames;
  simulation.time_s = static_cast<double>(simulation.frame) * simulation.scene.settings.frame_s;
  if (engine.sleep.awakeCount > 0) {
    checkShapes(simulation, engine.scratch.awakeBlocks);
    if (simulation.scene.plane) keepInPlane(simulation);
    const StageTimer timer(simulation.stageTimes, Stage::islandsAndSleep);
    updateRest(simulation);
  }
}

}  // namespace springtower
