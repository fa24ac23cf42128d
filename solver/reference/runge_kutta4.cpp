#include "solver/reference/runge_kutta4.h"

#include "solver/reference/stages.h"

namespace springtower {

// The classical Runge-Kutta method of fourth order; stable for undamped springs up to w dt = 2 sqrt 2.
void stepRungeKutta4(IslandStep& step) {
  Engine& engine = step.engine;
  MotionState& state = step.simulation.state;
  auto& stage = engine.scratch.stage;
  auto& rate = engine.scratch.stageAcceleration;
  const double half = 0.5 * step.drift_s;
  savePositions(step);
  stageAcceleration(step, state, engine.memo.carried, step.advance_s, true, rate[0]);
  advanceStage(step, state, state.velocity, rate[0], half, stage[0]);
  stageAcceleration(step, stage[0], state.velocity, half, false, rate[1]);
  advanceStage(step, state, stage[0].velocity, rate[1], half, stage[1]);
  stageAcceleration(step, stage[1], stage[0].velocity, half, false, rate[2]);
  advanceStage(step, state, stage[1].velocity, rate[2], step.drift_s, stage[2]);
  stageAcceleration(step, stage[2], stage[1].velocity, step.drift_s, false, rate[3]);

  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t a = 0; a < 3; ++a) {
      double* x = state.position.values(a, b);
      double* v = state.velocity.values(a, b);
      double* carried = engine.memo.carried.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) {
        const double velocity = (v[c] + 2.0 * stage[0].velocity.values(a, b)[c] + 2.0 * stage[1].velocity.values(a, b)[c] +
                                 stage[2].velocity.values(a, b)[c]) /
                                6.0;
        const double acceleration =
            (rate[0].values(a, b)[c] + 2.0 * rate[1].values(a, b)[c] + 2.0 * rate[2].values(a, b)[c] + rate[3].values(a, b)[c]) /
            6.0;
        carried[c] = velocity;
        x[c] += step.drift_s * velocity;
        v[c] += step.drift_s * acceleration;
      }
    }
  }
}

}  // namespace springtower
