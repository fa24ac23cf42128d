#include "core/error.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/block/springs.h"
#include "solver/explicit/stable_step.h"
#include "solver/frame/choose_method.h"
#include "solver/frame/pairs.h"
#include "solver/implicit/run.h"
#include "solver/rigid/run.h"
#include "solver/rigid/shapes.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "solver/world/stiffness.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace springtower {

namespace {

void placeBlock(const BlockSpec& spec, std::size_t b, Simulation& simulation) {
  simulation.model.dimensions[b] = spec.dimensions;
  simulation.model.mass[b] = spec.mass;
  if (spec.restitution) {
    const double others = std::sqrt(simulation.scene.restitution);
    simulation.model.rootRestitution.resize(simulation.model.blockCount(), others);
    simulation.model.rootRestitution[b] = std::sqrt(*spec.restitution);
  }
  if (spec.fixed) {
    simulation.model.fixed.resize(simulation.model.blockCount(), 0);
    simulation.model.fixed[b] = 1;
  }
  for (std::size_t c = 0; c < kCorners; ++c) {
    Vec3 arm;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      arm[axis] = 0.5 * cornerSide(c, a) * spec.dimensions[axis];
    }
    if (spec.strain) arm += (*spec.strain)[c];
    arm = spec.orientation * arm;
    simulation.state.position.set(b, c, spec.centre + arm);
    simulation.state.velocity.set(b, c, spec.velocity + spec.spin.cross(arm));
  }
}

// Largest eigenvalue of M^-1 K, 1/s2, expected of any contact set of this scene with this stiffness: the stiffest block's
// springs, and contacts that press a block from both sides against neighbours of the same compliance.
double foreseenSpectralRadius(const Simulation& simulation, const BlockStiffness& stiffness) {
  const Settings& settings = simulation.scene.settings;
  BlockModel model = simulation.model;
  double springs = 0.0;
  double lightest = 1e300;
  for (std::size_t b = 0; b < model.blockCount(); ++b) {
    if (model.isFixed(b)) continue;
    lightest = std::min(lightest, model.mass[b]);
    if (equalsPrevious(model, stiffness, b)) continue;
    setSprings(model, b, stiffness.edge_n_m[b], simulation.lengths.blockHeight_m, 0.0);
    springs = std::max(springs, blockSpectralRadius(model, settings.inertia, b));
  }
  const double compressionMass =
      inverseMass(settings.inertia).own / 2.0;  // 1/m times this, for the mode that presses a block flat
  const double contact =
      std::max(2.0 * tuning::kPointsPerSide * largestStiffness(stiffness), 4.0 * largest(stiffness.floor_n_m)) / 4.0 * 2.0 *
      compressionMass;
  return springs + (1.0 + settings.maxwellRatio) * contact / lightest;
}

// From tolerance to stiffness to substeps, or from substeps to tolerance. Stiffness is inversely proportional to the tolerance,
// and to the square of the step.
void chooseStiffness(Simulation& simulation) {
  const Settings& settings = simulation.scene.settings;
  LoadEstimate loads = estimateLoads(simulation.scene);
  const bool stable = isStableForAnyStep(settings.method);
  simulation.fixedSubsteps = stable ? 0 : settings.substeps;
  simulation.tolerance_m = toleranceOf(simulation.scene);
  BlockStiffness stiffness = stiffnessForTolerance(loads, simulation.tolerance_m);
  if (simulation.fixedSubsteps > 0) {
    const double allowed = stableSpectralRadius(settings.method, settings.frame_s / settings.substeps, simulation.dampingTime_s,
                                                settings.stabilitySafety);
    const double needed = foreseenSpectralRadius(simulation, stiffness);
    if (!settings.tolerance_m) {
      for (StackLoad& stack : loads.stacks) stack.sway_n_m = 0.0;
      const double unit = foreseenSpectralRadius(simulation, stiffnessForTolerance(loads, 1.0));
      simulation.tolerance_m = unit / allowed;
      stiffness = stiffnessForTolerance(loads, simulation.tolerance_m);
    } else if (needed > allowed && !settings.allowUnstable) {
      throw InputError(fmt::format(
          "settings: expected at least {} substeps for tolerance_m = {:g}, or allow_unstable, got substeps = {}",
          static_cast<int>(std::ceil(settings.frame_s /
                                     stableStep(settings.method, needed, simulation.dampingTime_s, settings.stabilitySafety))),
          *settings.tolerance_m, settings.substeps));
    }
  }
  for (double& edge_n_m : stiffness.edge_n_m) edge_n_m *= settings.springRatio;
  const bool explicitSprings = traitsOf(settings.method).family == MethodFamily::explicitSprings;
  if (explicitSprings && simulation.fixedSubsteps == 0)
    stiffenForMotion(simulation.scene, simulation.lengths.blockHeight_m, stiffness.edge_n_m);
  simulation.stiffness = std::move(stiffness);
}

// Factor by which a block's force error may exceed tuning::kNewtonResidual: forces of its stiffest contacts and springs change by
// that much when positions change by their rounding, and no iteration leaves less. Above 1 for towers of some hundred rows, whose
// stiffness grows as the cube of their height.
double roundingFactor(const Simulation& simulation, std::size_t b) {
  const BlockSpec& block = simulation.scene.blocks[b];
  const BlockStiffness& of = simulation.stiffness;
  const double distance_m = block.centre.norm() + block.dimensions.norm();
  const double error_n = tuning::kPositionRounding * distance_m * std::max({of.stack_n_m[b], of.floor_n_m[b], of.edge_n_m[b]});
  const double weight_n = block.mass * std::max(simulation.scene.gravity.magnitude, 1.0);
  return std::clamp(error_n / (tuning::kNewtonResidual * weight_n), 1.0, tuning::kMaxRoundingFactor);
}

// Fixed blocks sleep from the start, with the boxes and frames of blocks that have fallen asleep.
void placeFixedBlocks(Simulation& simulation) {
  Engine& e = *simulation.engine;
  const std::size_t count = simulation.model.blockCount();
  std::vector<std::int32_t> fixed;
  for (std::size_t b = 0; b < count; ++b) {
    if (simulation.model.isFixed(b)) fixed.push_back(static_cast<std::int32_t>(b));
  }
  if (!simulation.scene.drives.empty()) e.scratch.drivenMean.resize(count);
  e.sleep.movableCount = count - fixed.size();
  e.sleep.awakeCount = e.sleep.movableCount;
  for (const std::int32_t block : fixed) simulation.asleep[static_cast<std::size_t>(block)] = 1;
  computeFrames(simulation.state.position, fixed, e.memo.frames);
  computeSweptBoxes(simulation.state, fixed, 0.0, 0.0, Way::anySide, e.memo.sweepMargin, e.memo.boxes, e.scratch.reach);
}

// Sizes the data that every method uses.
void sizeEngine(Simulation& simulation) {
  const Scene& scene = simulation.scene;
  const BlockModel& model = simulation.model;
  const std::size_t count = model.blockCount();
  Engine& e = *simulation.engine;
  e.memo.boxes.resize(count);
  e.scratch.reach.assign(count, 0.0);
  e.scratch.path.assign(count, 0.0);
  e.scratch.assumedPath.assign(count, 0.0);
  e.memo.travelAtSweep.assign(count, 0.0);
  e.scratch.inParts.assign(count, 0);
  e.memo.sweepMargin.assign(count, tuning::kReplayMarginGrowth * tuning::kSweepMargin * simulation.lengths.blockHeight_m);
  e.memo.force.resize(count);
  e.memo.frames.resize(count);
  e.memo.motion.resize(count);
  e.scratch.contactForce.resize(count);
  const MethodFamily family = traitsOf(scene.settings.method).family;
  const bool isExplicit = family == MethodFamily::explicitSprings || family == MethodFamily::report;
  if (isExplicit) {
    e.springRadius.resize(count);
    e.memo.stepBound.assign(count, StepBound{});
  }
  e.memo.previous = simulation.state.position;
  e.memo.blockHistory.assign(count, BlockHistory{});
  e.memo.islandHistory.assign(count, IslandHistory{});
  e.sleep.windows.resize(count);
  if (!isRigid(scene.settings.method)) e.scratch.newContactCount.assign(count, 0);
  placeFixedBlocks(simulation);
  for (std::size_t b = 0; b < count; ++b) {
    if (isExplicit) {
      const bool equal = equalsPrevious(model, simulation.stiffness, b);
      e.springRadius[b] = equal ? e.springRadius[b - 1] : blockSpectralRadius(model, scene.settings.inertia, b);
    }
    e.sleep.windows[b].centre = centre(simulation.state.position, b);
  }
}

}  // namespace

Simulation::Simulation(const Scene& given) : scene(given), engine(std::make_unique<Engine>()) {
  checkScene(scene, scene.name);
  if (scene.settings.method == Method::automatic) scene.settings = chooseMethod(scene);
  friction = FrictionTable(scene);
  const std::size_t count = scene.blocks.size();
  model.dimensions.resize(count);
  model.mass.resize(count);
  for (std::size_t g = 0; g < kSpringGroups; ++g) {
    model.restLength[g].resize(count);
    model.springStiffness[g].resize(count);
    model.springDamping[g].resize(count);
  }
  state.resize(count);
  asleep.assign(count, 0);
  restTime_s.assign(count, 0.0);
  for (std::size_t b = 0; b < count; ++b) placeBlock(scene.blocks[b], b, *this);
  lengths.blockHeight_m = blockHeightOf(scene);
  lengths.fallTime_s =
      std::sqrt(lengths.blockHeight_m / (scene.gravity.magnitude > 0.0 ? scene.gravity.magnitude : kStandardGravity_m_s2));
  dampingTime_s = scene.settings.stiffnessDamping * lengths.fallTime_s;
  lengths.contactError_m = tuning::kFirstContactError * lengths.blockHeight_m;
  lengths.partingGap_m = tuning::kPartingGap * lengths.blockHeight_m;
  chooseStiffness(*this);
  const bool isReport = traitsOf(scene.settings.method).family == MethodFamily::report;  // its blocks have springs alone
  for (std::size_t b = 0; b < count; ++b) {
    setSprings(model, b, stiffness.edge_n_m[b], lengths.blockHeight_m, dampingTime_s);
    if (!isReport) setWarpStiffness(model, b, 4.0 * stiffness.edge_n_m[b] * tolerance_m);
  }

  sizeEngine(*this);
  for (std::size_t b = 0; b < count; ++b) engine->roundingFactor.push_back(roundingFactor(*this, b));
  Engine& e = *engine;
  const MethodTraits traits = traitsOf(scene.settings.method);
  if (traits.family == MethodFamily::report) {
    e.report.resize(count);
    e.scratch.pastPosition.resize(count);
  } else if (traits.family == MethodFamily::rigid) {
    prepareRigid(*this);
  } else {
    prepareImplicit(*this);  // explicit methods start in the equilibrium that implicit steps find
    if (isImplicit(scene.settings.method)) prepareShapes(*this);
  }
  if (traits.multiStage) {
    e.memo.carried.resize(count);
    e.memo.carriedMotion.resize(count);
    for (MotionState& stage : e.scratch.stage) stage = state;
    for (ParticleArray& acceleration : e.scratch.stageAcceleration) acceleration.resize(count);
  }
}

}  // namespace springtower
