#include "solver/explicit/leapfrog.h"

#include "solver/contact/evaluate_forces.h"
#include "solver/world/over_island.h"
#include "solver/world/stage_clock.h"

namespace springtower {

// Report Eq. 4.4: the new velocity moves the position. Seen as a leapfrog, velocities belong to a time half a step before the
// positions, so where the step changes the kick takes the mean of the two steps (Hairer, Lubich & Wanner 2003); with a constant
// step this is Eq. 4.4 as printed, except for the first step, which kicks by half.
void stepSemiImplicitEuler(IslandStep& step) {
  Simulation& simulation = step.simulation;
  MotionState& state = simulation.state;
  evaluateForces(step, state, state.velocity, step.advance_s, PointUpdate::store);
  StageClock clock(step.times);
  const auto integrate = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto block = static_cast<std::size_t>(step.blocks[i]);
      double acceleration[3][kCorners];
      accelerate(step, block, acceleration);
      for (std::size_t a = 0; a < 3; ++a) {
        double* x = state.position.values(a, block);
        double* v = state.velocity.values(a, block);
        double* before = step.engine.memo.previous.values(a, block);
        for (std::size_t c = 0; c < kCorners; ++c) {
          before[c] = x[c];
          v[c] += step.kick_s * acceleration[a][c];
          x[c] += step.drift_s * v[c];
        }
      }
    }
  };
  overBlocks(step, integrate);
  clock.lap(Stage::integration);
}

}  // namespace springtower
