// Heaps that have fallen come to rest: what rigid steps need for that, and what implicit ones need to converge.
#include "core/scene/scene.h"
#include "scenarios/registry.h"
#include "solver/frame/prepare.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace springtower {
namespace {

bool isRigidAnywhere(const Simulation& simulation) {
  const std::vector<IslandHistory>& history = simulation.engine->memo.islandHistory;
  return std::any_of(history.begin(), history.end(), [](const IslandHistory& island) { return island.rigid; });
}

double fastestCornerOf(const Simulation& simulation) {
  double fastest = 0.0;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) fastest = std::max(fastest, simulation.state.velocity.at(b, c).norm());
  }
  return fastest;
}

// Blocks fall into heaps and stay in rigid steps throughout. From 1.5 s on no corner is faster than 0.1 mm/s, at which blocks
// fall asleep. By what a heap sinks in a substep, as its passes do not converge, it paid for the push-out of overlaps before, and
// rose again: in 22 to 26 frames of the same half second some block was faster.
TEST(HeapRest, HeapsInRigidStepsAreStill) {
  for (const char* name : {"heap:60", "heap:80", "heap:100"}) {
    SCOPED_TRACE(name);
    Scene scene = sceneNamed(name);
    scene.settings.sleep = Sleep::off;
    Simulation simulation(scene);
    prepare(simulation);
    std::vector<IslandHistory>& history = simulation.engine->memo.islandHistory;
    for (int frame = 0; frame < 120; ++frame) {
      for (IslandHistory& island : history) island.rigidFrames = 1000;
      stepFrame(simulation);
      if (frame < 90) continue;
      EXPECT_LE(fastestCornerOf(simulation), 1e-4) << "frame " << frame;
    }
    EXPECT_TRUE(std::all_of(history.begin(), history.end(), [](const IslandHistory& island) { return island.rigid; }));
  }
}

// Where a force jumps (a dashpot that begins with the whole closing speed, edges that are found as faces), Newton's iteration
// fails, and the heap goes back to rigid steps again and again.
TEST(HeapRest, ImplicitStepsConvergeInFallenHeaps) {
  for (const char* name : {"heap:40", "heap:80", "heap:120"}) {
    SCOPED_TRACE(name);
    Scene scene = sceneNamed(name);
    scene.settings.sleep = Sleep::off;
    Simulation simulation(scene);
    prepare(simulation);
    for (int frame = 0; frame < 240; ++frame) stepFrame(simulation);
    EXPECT_FALSE(isRigidAnywhere(simulation)) << "at rest after 4 s";
    EXPECT_LT(rootMeanSquareCornerSpeed(simulation.state.velocity), 1e-5);
    const std::uint64_t failures = simulation.counters.newtonFailures;
    for (int frame = 0; frame < 30; ++frame) stepFrame(simulation);
    EXPECT_EQ(simulation.counters.newtonFailures, failures);
  }
}

}  // namespace
}  // namespace springtower
