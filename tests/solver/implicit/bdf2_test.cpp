// The history of BDF2, where a frame is run again.
#include "scenarios/towers.h"
#include "solver/metrics/measures.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cstddef>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// A frame that is run again in a large scene has lost the positions from which the step before it began, and takes the way of
// that step from its velocities: an error of the third order, here in every frame of a tower that sways by a tenth of a degree
// once a second.
TEST(Bdf2, DoesWithoutThePositionsBeforeTheFrame) {
  const Scene scene = swaying(awake(towerScene(18)), 0.1, 1.0);
  Simulation kept(scene);
  Simulation lost(scene);
  prepareAndStep(kept);
  prepareAndStep(lost);
  double swayed_m = 0.0;
  double differs_m = 0.0;
  const Vec3 start = centre(kept.state.position, 53);
  for (int frame = 0; frame < 120; ++frame) {
    for (BlockHistory& history : lost.engine->memo.blockHistory) {
      EXPECT_EQ(history.startKnown, history.lastImplicitStep_s > 0.0);
      history.startKnown = false;
    }
    stepFrame(kept);
    stepFrame(lost);
    swayed_m = std::max(swayed_m, (centre(kept.state.position, 53) - start).norm());
    for (std::size_t b = 0; b < 54; ++b)
      differs_m = std::max(differs_m, (centre(kept.state.position, b) - centre(lost.state.position, b)).norm());
  }
  EXPECT_GT(differs_m, 0.0);
  EXPECT_LE(differs_m, 0.02 * swayed_m);
}

}  // namespace
}  // namespace springtower
