#include "solver/frame/explicit_steps.h"

#include "core/elementary.h"
#include "core/error.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/contact/approach.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/query.h"
#include "solver/contact/slip.h"
#include "solver/contact/update.h"
#include "solver/explicit/leapfrog.h"
#include "solver/explicit/motion_bound.h"
#include "solver/explicit/stable_step.h"
#include "solver/explicit/strain_limit.h"
#include "solver/reference/midpoint.h"
#include "solver/reference/report_frame.h"
#include "solver/reference/report_step.h"
#include "solver/reference/runge_kutta4.h"
#include "solver/world/checkpoint.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/stiffness.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>

namespace springtower {

namespace {

// Contribution of the hand's springs and dashpots to the squared frequencies (1/s2) and damping rates (1/s) of an island.
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

// Factor by which an additional damping rate shortens the step that dt^2 K + 2 dt C < 4 allows.
double shortening(double radius, double dampingTime_s, double damping) {
  const auto longest = [&](double rate) { return std::sqrt(rate * rate + 4.0 * radius) - rate; };
  return longest(dampingTime_s * radius + damping) / longest(dampingTime_s * radius);
}

[[noreturn]] void refuseSteps(const IslandStep& step, double needed, const MotionBound& motion) {
  const double time_s = step.simulation.time_s;
  if (motion.steps >= needed && std::isfinite(needed))
    throw StepLimitError(
        fmt::format("block {} at {:.6f} s: it spins, or is pushed, so fast that method {} needs {:.3g} steps for the "
                    "next frame, allowed are {:.3g}",
                    motion.block, time_s, nameOf(step.simulation.scene.settings.method), needed,
                    static_cast<double>(tuning::kMaxExplicitSubsteps)),
        motion.block, time_s);
  const std::int32_t block = spectralBound(step.simulation, step.blocks, step.pairs).block;
  if (!std::isfinite(needed))
    throw DivergenceError(fmt::format("block {} diverged at {:.6f} s: no step is small enough for its stiffness", block, time_s),
                          block, time_s);
  throw StepLimitError(
      fmt::format("block {} at {:.6f} s: its springs or contacts are so stiff for its mass that method {} needs {:.3g} steps for "
                  "the next frame, allowed are {:.3g} (the methods auto and implicit do not depend on stiffness)",
                  block, time_s, nameOf(step.simulation.scene.settings.method), needed,
                  static_cast<double>(tuning::kMaxExplicitSubsteps)),
      block, time_s);
}

// Steps a frame that a spin (rad/s) needs with method midpoint. It takes corners half a step along their tangents and there feels
// springs of frequency w that are too long: the energy of the spin grows by (w dt)^2 (spin dt)^2 / 8 in each step.
double midpointSteps(double radius, double spin, double frame_s) {
  return frame_s * elementary::cbrt(frame_s * radius * spin * spin / (8.0 * tuning::kMaxMidpointGain));
}

// Chooses the number of steps of an island for this frame, and the largest stiffening of contacts made in it.
int chooseSubsteps(IslandStep& step) {
  Simulation& simulation = step.simulation;
  const Settings& settings = simulation.scene.settings;
  const bool isReport = traitsOf(settings.method).family == MethodFamily::report;
  StepBound& record = step.engine.memo.stepBound[static_cast<std::size_t>(step.blocks.front())];
  const std::uint64_t signature = contactSignature(step.engine, step.pairs) ^ (step.blocks.size() << 1U);
  if (signature != record.contactSignature || record.spectralRadius == 0.0) {
    record.spectralRadius = spectralBound(simulation, step.blocks, step.pairs).radius;
    record.contactSignature = signature;
  }
  const double standing = record.spectralRadius;
  const ApproachEstimate approach =
      isReport ? ApproachEstimate{} : estimateApproach(step);  // contacts of method `report` have no stiffness
  const double stiffening = approach.stiffening;
  const double born = approach.pointRate;
  // Simultaneous contacts of a block add up: the step is stable either for all of them at resting stiffness, or for one with the
  // stiffening of the impact.
  const double together = std::max(1, approach.together);

  double allowed = 0.0;  // largest stable eigenvalue of the chosen step
  int substeps = simulation.fixedSubsteps;
  if (substeps > 0) {
    allowed =
        stableSpectralRadius(settings.method, settings.frame_s / substeps, simulation.dampingTime_s, settings.stabilitySafety);
  } else {
    const TetherRates held = tetherRates(step);
    const double begun = standing + (approach.meeting || stiffening > 1.0 ? together * born : 0.0);
    const double needed = std::max(begun, standing + (stiffening > 1.0 ? stiffening * born : 0.0));
    const MotionBound motion = isReport ? MotionBound{} : motionBound(step);
    const double margin = settings.stabilitySafety * (isReport ? tuning::kReportStepMargin : 1.0);
    const auto stepsFor = [&](double radius) {
      const double dt = stableStep(settings.method, radius + held.stiffness, simulation.dampingTime_s, margin) *
                        shortening(radius + held.stiffness, simulation.dampingTime_s, held.damping);
      return std::max(std::ceil(settings.frame_s / dt), 1.0);
    };
    const double stable = std::min(stepsFor(needed), std::max<double>(tuning::kMaxImpactSubsteps, stepsFor(begun)));
    const double turning = settings.method == Method::midpoint ? midpointSteps(standing, motion.spin, settings.frame_s) : 1.0;
    const double steps = std::max({stable, motion.steps, std::min<double>(tuning::kMaxImpactSubsteps, std::ceil(turning))});
    if (!(steps <= tuning::kMaxExplicitSubsteps)) refuseSteps(step, steps, motion);
    substeps = static_cast<int>(steps);
    allowed =
        stableSpectralRadius(settings.method, settings.frame_s / substeps, simulation.dampingTime_s, settings.stabilitySafety);
    if (held.stiffness > 0.0) allowed = std::min(allowed, needed);
  }
  step.maxStiffening = born > 0.0 ? std::clamp((allowed - standing) / (together * born), 1.0, std::max(1.0, stiffening)) : 1.0;
  return substeps;
}

using StepFunction = void (*)(IslandStep&);

// One explicit step of a method.
StepFunction explicitStepOf(Method method) {
  switch (method) {
    case Method::midpoint:
      return stepMidpoint;
    case Method::rungeKutta4:
      return stepRungeKutta4;
    case Method::report:
      return stepReport;
    default:
      return stepSemiImplicitEuler;
  }
}

}  // namespace

IslandOutcome runExplicitSteps(IslandStep& step) {
  Simulation& simulation = step.simulation;
  const Settings& settings = simulation.scene.settings;
  const StepFunction takeStep = explicitStepOf(settings.method);
  const bool isReport = traitsOf(settings.method).family == MethodFamily::report;
  const bool leapfrog = traitsOf(settings.method).leapfrog;
  const double begin_s = step.part.begin_s;
  const double rest_s = step.part.duration_s();
  copyFrameStart(step);
  step.pushedBefore_s = 0.0;
  IslandOutcome outcome;
  outcome.substeps = std::max(1, static_cast<int>(std::ceil(chooseSubsteps(step) * rest_s / settings.frame_s - 1e-9)));
  step.drift_s = rest_s / outcome.substeps;
  double last = step.engine.memo.blockHistory[static_cast<std::size_t>(step.blocks.front())].lastExplicitStep_s;
  step.usesActiveList = true;
  step.activeListSteps = 0;
  const DrivenVelocity which = traitsOf(settings.method).multiStage ? DrivenVelocity::atEnd : DrivenVelocity::mean;
  placeDriven(step, simulation.time_s + begin_s - last, simulation.time_s + begin_s, which);
  for (int substep = 0; substep < outcome.substeps; ++substep) {
    step.time_s = simulation.time_s + begin_s + substep * step.drift_s;
    step.gravity = simulation.scene.gravity.at(step.time_s);
    step.kick_s = 0.5 * (last + step.drift_s);
    step.advance_s = last;
    // The time over which this step changes velocities.
    step.pushedUntil_s = step.time_s + (leapfrog ? 0.5 : 1.0) * step.drift_s;
    step.pushedFrom_s = leapfrog ? step.pushedUntil_s - step.kick_s : step.time_s;
    if (!isReport) findSlippingContacts(step);
    takeStep(step);
    if (!isReport) limitStrain(step);
    last = step.drift_s;
    placeDriven(step, step.time_s, step.time_s + step.drift_s, which);
    outcome.inside = isReport ? acceptReportStep(step) : updateContacts(step, refreshTravelOfExplicitSteps(simulation));
    if (!outcome.inside) break;
  }
  for (const std::int32_t block : step.blocks) {
    BlockHistory& history = step.engine.memo.blockHistory[static_cast<std::size_t>(block)];
    history.lastExplicitStep_s = last;
    history.explicitLast = true;
    history.lastImplicitStep_s = 0.0;
  }
  return outcome;
}

}  // namespace springtower
