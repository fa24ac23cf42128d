#include "solver/reference/midpoint.h"

#include "solver/reference/stages.h"

namespace springtower {

// The textbook midpoint method (report 4.3.2): forces at half a step advance the whole step. Figure 4.12 as printed uses an
// outdated state there and is of first order. Without damping it is never stable: amplitudes grow by (w dt)^4 / 8 a step.
void stepMidpoint(IslandStep& step) {
  Engine& engine = step.engine;
  MotionState& state = step.simulation.state;
  MotionState& middle = engine.scratch.stage[0];
  savePositions(step);
  stageAcceleration(step, state, engine.memo.carried, step.advance_s, true, engine.scratch.stageAcceleration[0]);
  advanceStage(step, state, state.velocity, engine.scratch.stageAcceleration[0], 0.5 * step.drift_s, middle);
  stageAcceleration(step, middle, state.velocity, 0.5 * step.drift_s, false, engine.scratch.stageAcceleration[1]);
  advanceStage(step, state, middle.velocity, engine.scratch.stageAcceleration[1], step.drift_s, state);
  copyCorners(step, middle.velocity, engine.memo.carried);
}

}  // namespace springtower
