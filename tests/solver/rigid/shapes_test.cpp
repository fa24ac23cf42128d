#include "core/scene/scene.h"
#include "scenarios/registry.h"
#include "solver/frame/prepare.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

bool isAnyRigid(const Simulation& simulation) {
  const std::vector<IslandHistory>& history = simulation.engine->memo.islandHistory;
  return std::any_of(history.begin(), history.end(), [](const IslandHistory& island) { return island.rigid; });
}

class HeapAtRestTest : public ::testing::TestWithParam<const char*> {};

// What falls in a heap comes to rest in implicit steps: the impulses of its contacts become the forces of springs that are
// compressed as far, and its blocks have the shape that these give them. Hand-overs that lose a fifth of the forces, or that find
// blocks undeformed, set it in motion again, and it stays in rigid steps for ever.
TEST_P(HeapAtRestTest, IsLeftToImplicitSteps) {
  Scene scene = sceneNamed(GetParam());
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  prepare(simulation);
  Energy before = energy(simulation);
  const double start_j = before.total();
  double rise = 0.0;
  for (int frame = 0; frame < 240; ++frame) {
    stepFrame(simulation);
    const Energy now = energy(simulation);
    rise = std::max(rise, energyRise(before, now) / start_j);
    before = now;
  }
  EXPECT_LE(rise, 1e-6) << "contacts and blocks are strained by what falls, not before it does";
  EXPECT_FALSE(isAnyRigid(simulation));
  EXPECT_LT(rootMeanSquareCornerSpeed(simulation.state.velocity), 1e-5);
  PenetrationWorkspace workspace;
  EXPECT_LE(maxPenetration(simulation.state.position, true, workspace).depth, 5e-4);
}

INSTANTIATE_TEST_SUITE_P(Scenes, HeapAtRestTest, ::testing::Values("heap:25", "heap:30", "heap:60"), [](const auto& test) {
  std::string name = test.param;
  name.erase(name.find(':'), 1);
  return name;
});

}  // namespace
}  // namespace springtower
