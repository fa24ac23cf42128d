#include "solver/implicit.h"

#include "solver/meeting.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// Steps of a frame where the user names none; and where nothing moves farther than kCalm tolerances in it.
constexpr int kImplicitSteps = 4;
constexpr int kCalmSteps = 1;
constexpr double kCalm = 0.1;
// Angle by which a block may turn in an implicit step, rad: the two-step formula turns along chords.
constexpr double kMostTurn = 0.01;

// Whether the island does so little that one step tells it as well as four. What a hand or a force begins to move is not calm.
bool isCalm(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const double most = kCalm * simulation.tolerance_m / simulation.scene.settings.frame_s;
  for (const std::int32_t block : step.blocks) {
    // What has just been let go of has no speed yet, and what explicit steps brought here may be at a bounce's turn.
    const auto b = static_cast<std::size_t>(block);
    if (!(simulation.restTime_s[b] > 0.0) || step.engine.clock[b].lastDrift_s > 0.0) return false;
    for (std::size_t a = 0; a < 3; ++a) {
      const double* v = simulation.state.velocity.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) {
        if (!(std::abs(v[c]) <= most)) return false;
      }
    }
  }
  return !holdsTether(step) && !isPushed(step);
}

int implicitSteps(const IslandStep& step) {
  const int asked = step.simulation.scene.settings.substeps;
  if (asked > 0) return asked;
  return isCalm(step) ? kCalmSteps : kImplicitSteps;
}

// The angular speed of a block is at most this, rad/s: how fast its mean edges change against their length.
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

}  // namespace

void prepareImplicit(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const std::size_t count = simulation.model.blockCount();
  engine.previousVelocity.resize(count);
  engine.history.resize(count);
  engine.target.resize(count);
  engine.stepVelocity.resize(count);
  engine.carriedMotion.resize(count);
  engine.implicitIslands.resize(count);
  engine.nodeOf.assign(count, 0);
  if (simulation.scene.settings.method == Method::implicitEigen) engine.sparseFactors.resize(count);
}

void setJacobians(IslandStep& step, double effective_s) {
  const BlockModel& model = step.simulation.model;
  ImplicitIsland& island = step.engine.implicitIslands[static_cast<std::size_t>(step.blocks.front())];
  const auto fits = [&](std::size_t b, std::size_t kind) {
    return model.dimensions[b] == island.kinds[kind].dimensions && model.mass[b] == island.kinds[kind].mass;
  };
  bool known = island.jacobianStep_s == effective_s && island.kindOf.size() == step.blocks.size();
  for (std::size_t i = 0; known && i < step.blocks.size(); ++i) {
    known = fits(static_cast<std::size_t>(step.blocks[i]), static_cast<std::size_t>(island.kindOf[i]));
  }
  if (known) return;
  island.jacobianStep_s = effective_s;
  island.kindOf.resize(step.blocks.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < step.blocks.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    if (count == 0 || !fits(b, count - 1)) {
      if (island.kinds.size() == count) island.kinds.emplace_back();
      island.kinds[count++] = {model.dimensions[b], model.mass[b],
                               blockJacobian(model, step.simulation.scene.settings.inertia, b, 1.0 / (effective_s * effective_s),
                                             1.0 + step.simulation.dampingTime_s / effective_s)};
    }
    island.kindOf[i] = static_cast<std::int32_t>(count - 1);
  }
}

bool implicitStepsFit(const IslandStep& step, double step_s) {
  const Simulation& simulation = step.simulation;
  const bool touches = std::any_of(step.pairs.begin(), step.pairs.end(), [&](std::int32_t at) {
    return step.engine.pairs[static_cast<std::size_t>(at)].manifold.touch != Touch::apart;
  });
  if (!touches || meetsSoon(step, step_s) || bounces(step, step_s)) return false;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    if (step.engine.clock[b].explicitFrames > 0) return false;
    const double turning = turningSpeed(affineField(simulation.state.position, b), affineField(simulation.state.velocity, b));
    if (turning * step_s > kMostTurn) return false;
  }
  return true;
}

IslandOutcome runImplicitSteps(IslandStep& step, double& reached_s) {
  Simulation& simulation = step.simulation;
  Engine& engine = step.engine;
  IslandOutcome outcome;
  reached_s = 0.0;
  int steps = implicitSteps(step);
  const bool fits = implicitStepsFit(step, simulation.scene.settings.frame_s / steps);
  for (const std::int32_t block : step.blocks) {
    std::int32_t& frames = engine.clock[static_cast<std::size_t>(block)].explicitFrames;
    frames = std::max(0, frames - 1);
  }
  ImplicitIsland& island = engine.implicitIslands[static_cast<std::size_t>(step.blocks.front())];
  // Where nothing has come or gone since, the forces are those that the last frame ended with.
  const bool forced = holdsTether(step) || isPushed(step);
  const bool known = island.forcesKnown && !engine.regrouped && !island.forced && !forced;
  island.forced = forced;
  island.forcesKnown = false;
  if (!fits) return outcome;
  step.drift_s = simulation.scene.settings.frame_s / steps;
  setJacobians(step, endShare(simulation.scene.settings.method) * step.drift_s);
  step.scaleMost = 1.0;
  island.forcesKnown = known;
  for (int i = 0; i < steps; ++i) {
    step.time_s = simulation.time_s + i * step.drift_s;
    step.gravity = simulation.scene.gravity.at(step.time_s + step.drift_s);  // forces are those of the step's end
    if (!stepImplicit(step)) {
      if (steps < kImplicitSteps && simulation.scene.settings.substeps == 0) {  // it was not calm after all
        steps = kImplicitSteps;
        step.drift_s = simulation.scene.settings.frame_s / steps;
        setJacobians(step, endShare(simulation.scene.settings.method) * step.drift_s);
        i = -1;
        continue;
      }
      for (const std::int32_t block : step.blocks) engine.clock[static_cast<std::size_t>(block)].explicitFrames = kExplicitFrames;
      return outcome;
    }
    ++outcome.substeps;
    reached_s = simulation.scene.settings.frame_s * (i + 1) / steps;
    const std::uint64_t looked = step.counters.manifoldRefreshes + step.counters.contactsBorn;
    outcome.inside = updateContacts(step, renewalOfImplicitSteps(simulation));
    if (!outcome.inside) return outcome;
    if (looked != step.counters.manifoldRefreshes + step.counters.contactsBorn) {
      island.forcesKnown = false;
    }
  }
  return outcome;
}

}  // namespace springtower
