// What the implicit steps of a heap that has fallen need to converge.
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
