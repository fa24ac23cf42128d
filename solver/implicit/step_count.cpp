#include "solver/implicit/step_count.h"

#include "core/elementary.h"
#include "core/lanes.h"
#include "core/tuning.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace springtower {

namespace {

double fourthPower(double value) {
  return value * value * value * value;
}

int stepsFor(double angle4, double damping) {
  const double steps = elementary::cbrt(angle4 / (4.0 * damping));
  return static_cast<int>(std::ceil(std::clamp(steps, 1.0, static_cast<double>(tuning::kMaxFrequencySteps))));
}

SPRINGTOWER_KERNEL
void updateFrequenciesOf(IslandStep& step, std::span<const std::int32_t> blocks, double effective_s) {
  Engine& engine = step.engine;
  const ParticleArray& velocity = step.simulation.state.velocity;
  const double frame_s = step.simulation.scene.settings.frame_s;
  const double share = step.drift_s / (tuning::kFrequencyWindowFrames * frame_s);
  const double rate = 1.0 / (step.drift_s * step.drift_s);
  const double ofVelocity = 3.0 / effective_s;
  const double fastest = fourthPower(tuning::kMaxVibrationAngle / frame_s);
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    BlockHistory& past = engine.memo.blockHistory[b];
    if (!(past.lastImplicitStep_s > 0.0)) continue;
    double jerk[kCorners] = {};
    double speed[kCorners] = {};
    for (std::size_t a = 0; a < 3; ++a) {
      const double pull = 3.0 * effective_s * step.gravity[static_cast<Eigen::Index>(a)];
      const double* v = velocity.values(a, b);
      const double* before = engine.memo.previousVelocity.values(a, b);
      const double* history = engine.scratch.pastPosition.values(a, b);
      const double* target = engine.scratch.freePosition.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) {
        // The change of velocity in this step minus that in the step before; the latter follows from the target: 3 ((target -
        // history) / h' - pull - before).
        const double change = v[c] + 2.0 * before[c] + pull - ofVelocity * (target[c] - history[c]);
        jerk[c] += change * change;
        speed[c] += v[c] * v[c];
      }
    }
    const double mass = step.simulation.model.mass[b];
    past.motion += share * (mass * std::accumulate(speed, speed + kCorners, 0.0) - past.motion);
    const double jerkNow = mass * rate * rate * std::accumulate(jerk, jerk + kCorners, 0.0);
    past.jerk += share * (std::min(jerkNow, fastest * past.motion) - past.jerk);
  }
}

}  // namespace

double quiescentSpeed(const Simulation& simulation) {
  return tuning::kQuiescentDisplacement * simulation.tolerance_m / simulation.scene.settings.frame_s;
}

void updateFrequencyEstimate(IslandStep& step, double effective_s) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    updateFrequenciesOf(step, step.blocks.subspan(first, last - first), effective_s);
  });
}

int stepsForFrequency(const IslandStep& step, int present) {
  const Simulation& simulation = step.simulation;
  const double frame_s = simulation.scene.settings.frame_s;
  const double calm = quiescentSpeed(simulation);
  double jerk = 0.0;
  double motion = 0.0;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    jerk += step.engine.memo.blockHistory[b].jerk;
    motion += step.engine.memo.blockHistory[b].motion + simulation.model.mass[b] * static_cast<double>(kCorners) * calm * calm;
  }
  const double angle4 = fourthPower(frame_s) * jerk / motion;  // (w T)^4
  return std::clamp(present, stepsFor(angle4, tuning::kMaxStepDamping), stepsFor(angle4, tuning::kMinStepDamping));
}

}  // namespace springtower
