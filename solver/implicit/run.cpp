#include "solver/implicit/run.h"

#include "core/tuning.h"
#include "solver/contact/approach.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/pushes.h"
#include "solver/contact/update.h"
#include "solver/implicit/equilibrium.h"
#include "solver/implicit/step_count.h"
#include "solver/world/checkpoint.h"
#include "solver/world/over_island.h"
#include "solver/world/scales.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace springtower {

namespace {

// Steps of a frame for which no corner exceeds kMaxDisplacementPerStep.
int stepsForDisplacement(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const ParticleArray& velocity = simulation.state.velocity;
  const bool alone = step.blocks.size() == 1;
  const Vec3 glide = alone ? centre(velocity, static_cast<std::size_t>(step.blocks.front())) : Vec3::Zero();
  double fastest = largestOfBlocks(step, [&](std::size_t b) { return fastestCorner(velocity, b, glide); });
  if (alone) fastest *= 2.0;
  const double steps = std::ceil(fastest * simulation.scene.settings.frame_s /
                                 (tuning::kMaxDisplacementPerStep * simulation.lengths.blockHeight_m));
  return static_cast<int>(std::clamp(steps, 1.0, static_cast<double>(tuning::kMaxFrequencySteps)));
}

// Whether the island moves so little that one step is as accurate as many.
bool isQuiescent(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const double most = quiescentSpeed(simulation);
  return everyBlock(step, [&](std::size_t b) {
    // A block that has just been released has no speed yet, and one that rigid steps moved may be at the turning point of a
    // bounce.
    if (!(simulation.restTime_s[b] > 0.0) || step.engine.memo.blockHistory[b].explicitLast) return false;
    for (std::size_t a = 0; a < 3; ++a) {
      const double* v = simulation.state.velocity.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) {
        if (!(std::abs(v[c]) <= most)) return false;
      }
    }
    return true;
  });
}

// Whether the island touches a sleeping block. Sleepers wake on a change of contact force; with fewer than
// tuning::kStandardImplicitSteps steps, numerical damping would filter out the vibration that should wake them.
bool touchesSleeping(const IslandStep& step) {
  return anyPair(step, [&](std::size_t at) {
    const BlockPair& key = step.engine.pairs.key[at];
    return step.engine.pairs.touches(at) && (isSleeper(step.simulation, key.a) || isSleeper(step.simulation, key.b));
  });
}

bool touchesAnything(const IslandStep& step) {
  return anyPair(step, [&](std::size_t at) { return step.engine.pairs.touches(at); });
}

// Number of implicit steps of the frame. `forced`: whether a force or the hand acts; `known`: whether that is as in the frame
// before.
int implicitSteps(const IslandStep& step, bool forced, bool known, bool mostlyFallen) {
  const Settings& settings = step.simulation.scene.settings;
  if (settings.substeps > 0) return settings.substeps;
  const bool calm = isQuiescent(step) && !forced;
  if (!traitsOf(settings.method).twoStep) return calm ? 1 : tuning::kStandardImplicitSteps;
  std::vector<IslandHistory>& histories = step.engine.memo.islandHistory;
  const std::int32_t present = std::max(1, mergedHistory(histories, step.blocks).implicitSteps);
  for (const std::int32_t block : step.blocks)
    known = known && step.engine.memo.blockHistory[static_cast<std::size_t>(block)].lastImplicitStep_s > 0.0;
  int least = forced ? tuning::kMinForcedSteps : 1;
  if (!calm && touchesSleeping(step)) least = tuning::kStandardImplicitSteps;
  if (!calm && !known) least = std::max(least, mostlyFallen ? tuning::kMinStepsAfterRigid : tuning::kMaxFrequencySteps);
  if (!known) least = std::max(least, present);  // a kick needs many
  // A block in the hand alone, which nothing holds against the hand's pull.
  if (forced && !touchesAnything(step)) least = known ? tuning::kMaxFrequencySteps : tuning::kStepsAfterKick;
  if (!calm && (!forced || !step.driven.empty())) least = std::max(least, stepsForDisplacement(step));
  const int steps = std::max(least, stepsForFrequency(step, present));
  for (const std::int32_t block : step.blocks) histories[static_cast<std::size_t>(block)].implicitSteps = steps;
  return steps;
}

// Steps in the part of the frame that is run, of so many in a whole frame.
int stepsInPart(const IslandStep& step, int steps) {
  const double share = step.part.duration_s() / step.simulation.scene.settings.frame_s;
  return std::max(1, static_cast<int>(std::ceil(steps * share - 1e-9)));
}

// Upper bound of the steps a frame of the last retry. In a wide island that nothing forces, finer
// steps would take seconds.
int mostStepsOfRetries(const IslandStep& step, bool forced) {
  if (forced) return tuning::kMaxLedSteps;
  return step.blocks.size() >= tuning::kParallelBlocks ? tuning::kMaxFrequencySteps : tuning::kMaxStandingSteps;
}

// Steps a frame of the last retry. Rigid steps leave what a hand leads, and a stack that a blow has set swaying, less well in
// place. But where blocks are about to rebound they are right.
int mostSteps(const IslandStep& step, bool forced, bool mostlyFallen) {
  if (step.simulation.scene.settings.substeps > 0) return 0;
  const int most = mostStepsOfRetries(step, forced);
  const bool canEndEarlier = !forced && most > tuning::kMaxFrequencySteps;
  return canEndEarlier && (mostlyFallen || isAboutToRebound(step)) ? tuning::kMaxFrequencySteps : most;
}

// Step count for retrying the rest of the frame after Newton failed: 4 a frame, or the next of 8, 16, 32 and so on, up to `most`.
// Needed when a whole face starts to slip at once.
int retryStepCount(double share, int steps, int most) {
  const auto of = [&](int frame) { return static_cast<int>(std::lround(share * frame)); };
  for (int frame = tuning::kStandardImplicitSteps; frame < most; frame *= 2) {
    if (of(frame) > steps) return of(frame);
  }
  return of(most);
}

// So many steps a frame or, where these do not fit, the fewest of the retries that do; 0 where none fit.
int fittingSteps(const IslandStep& step, int steps, bool forced, bool mostlyFallen) {
  const auto fit = [&](int count) { return implicitStepsFit(step, step.part.duration_s() / stepsInPart(step, count)); };
  if (fit(steps)) return steps;
  const int most = mostSteps(step, forced, mostlyFallen);
  for (int finer = tuning::kStandardImplicitSteps; finer < most; finer *= 2) {
    if (finer > steps && fit(finer)) return finer;
  }
  return most > steps && fit(most) ? most : 0;
}

// Restarts BDF2 (drops the history) when an external force ends: acceleration jumps, and the history is wrong. Not when one
// begins: friction balances it at first, so acceleration is continuous.
void resetHistory(IslandStep& step) {
  for (const std::int32_t block : step.blocks)
    step.engine.memo.blockHistory[static_cast<std::size_t>(block)].lastImplicitStep_s = 0.0;
}

// Upper bound of the angular speed of a block, rad/s: the rate of change of its mean edges over their length.
double turningSpeed(const AffineField& place, const AffineField& motion) {
  double fastest = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto& side = place.side[a];
    const auto& rate = motion.side[a];
    const double length = side[0] * side[0] + side[1] * side[1] + side[2] * side[2];
    fastest = std::max(fastest, (rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2]) / length);
  }
  return std::sqrt(fastest);
}

// Counts down the frames until implicit steps are tried again, and notes whether this one is forced and how many steps it is to
// have.
void noteFrame(IslandStep& step, bool forced, int steps) {
  for (const std::int32_t block : step.blocks) {
    IslandHistory& history = step.engine.memo.islandHistory[static_cast<std::size_t>(block)];
    if (step.part.begin_s == 0.0) history.rigidFrames = std::max(0, history.rigidFrames - 1);
    history.forced = forced;
    history.implicitSteps = steps;
  }
}

// Begins with the forces at the end of the last frame, if they are known. Where its step has left what it began with in the trial
// points, these become the points; except in an island that is not narrow, which evaluates its forces before it reads them.
void beginWithForces(IslandStep& step, bool known) {
  Engine& engine = step.engine;
  NewtonSystem& island = engine.memo.newtonSystems.of(step.blocks.front());
  island.forcesKnown = known;
  if (!known || !island.trialLags || step.blocks.size() > tuning::kNarrowBlocks) return;
  overPairs(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t pair : step.pairs.subspan(first, last - first)) {
      const auto at = static_cast<std::size_t>(pair);
      if (engine.pairs.touches(at)) engine.contacts.copyToTrial(engine.pairs.contact[at]);
    }
  });
  island.trialLags = false;
}

// A step in which user forces jump is one of implicit Euler: it carries no acceleration of the step before on. `begins`: it is
// the first of its length.
void chooseFormula(IslandStep& step, NewtonSystem& island, bool begins) {
  const BlockHistory& history = step.engine.memo.blockHistory[static_cast<std::size_t>(step.blocks.front())];
  step.twoStep = traitsOf(step.simulation.scene.settings.method).twoStep;
  if (step.twoStep && pushesJump(step, history.lastImplicitStep_s, step.drift_s)) {
    step.twoStep = false;
    island.forcesKnown = false;
  }
  const double effective_s = endShare(step.twoStep) * step.drift_s;
  if (begins || effective_s != island.jacobianStep_s) setJacobians(step, effective_s);
}

// Sets the number of frames until implicit steps are tried again.
void leaveImplicitSteps(IslandStep& step, bool mostlyFallen) {
  for (const std::int32_t block : step.blocks)
    step.engine.memo.islandHistory[static_cast<std::size_t>(block)].rigidFrames =
        framesOf(step.simulation, mostlyFallen ? tuning::kRigidRetryTime : tuning::kRigidRestTime);
}

}  // namespace

void prepareImplicit(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const std::size_t count = simulation.model.blockCount();
  engine.memo.previousVelocity.resize(count);
  engine.scratch.pastPosition.resize(count);
  engine.scratch.freePosition.resize(count);
  engine.memo.carriedMotion.resize(count);
  engine.memo.newtonSystems.use(count);
  engine.scratch.nodeOf.assign(count, 0);
  if (simulation.scene.settings.method == Method::implicitEigen) engine.memo.sparseFactors.use(count);
}

void setJacobians(IslandStep& step, double effective_s) {
  const BlockModel& model = step.simulation.model;
  NewtonSystem& island = step.engine.memo.newtonSystems.of(step.blocks.front());
  const std::vector<double>& edge_n_m = step.simulation.stiffness.edge_n_m;
  const auto fits = [&](std::size_t b, std::size_t kind) {
    const NewtonSystem::BlockClass& known = island.blockClasses[kind];
    return model.dimensions[b] == known.dimensions && model.mass[b] == known.mass && edge_n_m[b] == known.edge_n_m;
  };
  bool known = island.jacobianStep_s == effective_s && island.blockClassOf.size() == step.blocks.size();
  for (std::size_t i = 0; known && i < step.blocks.size(); ++i) {
    known = fits(static_cast<std::size_t>(step.blocks[i]), static_cast<std::size_t>(island.blockClassOf[i]));
  }
  if (known) return;
  island.jacobianStep_s = effective_s;
  island.blockClassOf.resize(step.blocks.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < step.blocks.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    if (count == 0 || !fits(b, count - 1)) {
      if (island.blockClasses.size() == count) island.blockClasses.emplace_back();
      island.blockClasses[count++] = {
          model.dimensions[b], model.mass[b], edge_n_m[b],
          blockJacobian(model, step.simulation.scene.settings.inertia, b, 1.0 / (effective_s * effective_s),
                        1.0 + step.simulation.dampingTime_s / effective_s)};
    }
    island.blockClassOf[i] = static_cast<std::int32_t>(count - 1);
  }
}

bool implicitStepsFit(const IslandStep& step, double step_s) {
  const Simulation& simulation = step.simulation;
  const bool lasting = touchesAnything(step) || holdsTether(step);
  if (!lasting || isAboutToCollide(step, step_s) || bounces(step, step_s)) return false;
  return everyBlock(step, [&](std::size_t b) {
    const double turning = turningSpeed(affineField(simulation.state.position, b), affineField(simulation.state.velocity, b));
    return !(turning * step_s > tuning::kMaxTurnPerStep);
  });
}

IslandOutcome runImplicitSteps(IslandStep& step, bool mostlyFallen, double& reached_s) {
  Simulation& simulation = step.simulation;
  Engine& engine = step.engine;
  IslandOutcome outcome;
  reached_s = step.part.begin_s;
  const double end_s = step.part.end_s;
  NewtonSystem& island = engine.memo.newtonSystems.of(step.blocks.front());
  const bool forced = isWorkedOn(step);
  const bool wasForced = engine.memo.islandHistory[static_cast<std::size_t>(step.blocks.front())].forced;
  if (wasForced && !forced) resetHistory(step);
  const int wanted = implicitSteps(step, forced, forced == wasForced, mostlyFallen);
  int steps = fittingSteps(step, wanted, forced, mostlyFallen);
  // If pairs, islands and forces are unchanged, the forces are those at the end of the last frame.
  const bool known = island.forcesKnown && !engine.memo.topologyChanged && !wasForced && !forced;
  island.forcesKnown = false;
  if (steps == 0) return outcome;
  bool begins = true;  // with steps of this length
  if (forced && !wasForced && reached_s == 0.0) followNewForces(step);
  noteFrame(step, forced, wanted);  // a search that has failed has put back what was noted before
  const auto takeSteps = [&](int count) {
    steps = count;
    if (count > 1) copyFrameStart(step);
    step.drift_s = (end_s - reached_s) / count;
    begins = true;
  };
  // Contacts of a heap change in nearly every iteration: factors that fill in would be made for one solution each.
  step.withoutFill = mostlyFallen && step.blocks.size() >= tuning::kParallelBlocks && !engine.memo.sparseFactors.isUsed();
  takeSteps(stepsInPart(step, steps));
  step.maxStiffening = 1.0;
  beginWithForces(step, known);
  while (steps > 0) {
    step.time_s = simulation.time_s + reached_s;
    step.gravity = simulation.scene.gravity.at(step.time_s + step.drift_s);  // forces are those of the step's end
    chooseFormula(step, island, std::exchange(begins, false));
    const double share = (end_s - reached_s) / simulation.scene.settings.frame_s;
    const int next = retryStepCount(share, steps, mostStepsOfRetries(step, forced));
    // An island that has mostly fallen goes back to rigid steps where implicit ones do not converge.
    const bool canRetryFiner = next > steps && simulation.scene.settings.substeps == 0 && !mostlyFallen;
    // Steps that are hardly finer need as many iterations.
    if (!stepImplicit(step, canRetryFiner && next >= 2 * steps)) {
      const int finer = canRetryFiner ? retryStepCount(share, steps, mostSteps(step, forced, mostlyFallen)) : 0;
      if (finer > steps) {
        takeSteps(finer);
        continue;
      }
      leaveImplicitSteps(step, mostlyFallen);
      return outcome;
    }
    ++outcome.substeps;
    --steps;
    reached_s = end_s - steps * step.drift_s;
    const std::uint64_t looked = step.counters.manifoldRefreshes + step.counters.contactsCreated;
    outcome.inside = updateContacts(step, refreshTravelOfImplicitSteps(simulation));
    if (!outcome.inside) return outcome;
    if (looked != step.counters.manifoldRefreshes + step.counters.contactsCreated) island.forcesKnown = false;
  }
  return outcome;
}

}  // namespace springtower
