#include "solver/reference/stages.h"

#include "solver/contact/evaluate_forces.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/stage_clock.h"

#include <algorithm>

namespace springtower {

void stageAcceleration(IslandStep& step, const MotionState& source, const ParticleArray& carried, double advance_s, bool commit,
                       ParticleArray& acceleration) {
  if (!commit) placeDriven(step, step.time_s, step.time_s + advance_s);
  evaluateForces(step, source, carried, advance_s, commit ? PointUpdate::store : PointUpdate::discard);
  StageClock clock(step.times);
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    double values[3][kCorners];
    accelerate(step, b, values);
    for (std::size_t a = 0; a < 3; ++a) std::copy(values[a], values[a] + kCorners, acceleration.values(a, b));
  }
  clock.lap(Stage::integration);
}

void advanceStage(const IslandStep& step, const MotionState& base, const ParticleArray& velocity,
                  const ParticleArray& acceleration, double duration_s, MotionState& destination) {
  StageClock clock(step.times);
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t a = 0; a < 3; ++a) {
      const double* x = base.position.values(a, b);
      const double* v = base.velocity.values(a, b);
      const double* rate = velocity.values(a, b);
      const double* kick = acceleration.values(a, b);
      double* toX = destination.position.values(a, b);
      double* toV = destination.velocity.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) {
        const double nextX = x[c] + duration_s * rate[c];
        const double nextV = v[c] + duration_s * kick[c];
        toX[c] = nextX;
        toV[c] = nextV;
      }
    }
  }
  clock.lap(Stage::integration);
}

void copyCorners(const IslandStep& step, const ParticleArray& from, ParticleArray& to) {
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t a = 0; a < 3; ++a) std::copy(from.values(a, b), from.values(a, b) + kCorners, to.values(a, b));
  }
}

void savePositions(IslandStep& step) {
  copyCorners(step, step.simulation.state.position, step.engine.memo.previous);
}

}  // namespace springtower
