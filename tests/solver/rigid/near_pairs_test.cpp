// Which pairs are looked at anew in rigid steps.
#include "core/scene/scene.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

constexpr double kSpin_rad_s = 5.0;
constexpr double kGap_m = 1e-4;

// Two blocks one above the other, which turn as one about a level axis half way between them.
Scene turningPair() {
  Scene scene;
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  scene.settings.method = Method::rigidPgs;
  for (const double side : {-1.0, 1.0}) {
    BlockSpec block;
    block.centre = Vec3(0.0, 0.0, 0.2 + side * 0.5 * (kBlockHeight_m + kGap_m));
    block.spin = kSpin_rad_s * Vec3::UnitX();
    block.velocity = block.spin.cross(block.centre - Vec3(0.0, 0.0, 0.2));
    scene.blocks.push_back(block);
  }
  return scene;
}

// Nothing holds the blocks on their circles: in a frame of t = 1/60 s each leaves its own by (w t)^2 / 2 of its radius, 26
// micrometres, so both move 52 against one another. Their speeds in space would add up to 8 mm, half a millimetre in each step.
TEST(NearPairs, OfBlocksThatTurnAsOneAreListedOnce) {
  Simulation simulation(turningPair());
  prepareAndStep(simulation);
  std::vector<PointGroup> groups;
  simulation.engine->scratch.rigidWork.forEach([&](const RigidIsland& island) { groups = island.steadyKnown.groups; });
  ASSERT_EQ(groups.size(), 1U);
  EXPECT_GE(groups.front().count, 4) << "the corners of both faces";
  const double angle = kSpin_rad_s * simulation.scene.settings.frame_s;
  const double leaves_m = 0.5 * angle * angle * (kBlockHeight_m + kGap_m);
  EXPECT_GT(groups.front().moved_m, 0.5 * leaves_m);
  EXPECT_LT(groups.front().moved_m, 4.0 * leaves_m) << "an upper bound, added up over the steps of the frame";
}

}  // namespace
}  // namespace springtower
