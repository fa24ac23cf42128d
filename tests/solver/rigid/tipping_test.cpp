// What tips in an island of many blocks falls as it does alone.
#include "core/scene/scene.h"
#include "scenarios/walls.h"
#include "solver/metrics/measures.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

constexpr double kTippingSide_m = 0.015;
constexpr double kTippingHeight_m = 0.075;
constexpr double kBeyondBalance = std::numbers::pi / 180.0;  // rad, beyond the angle at which it balances on its edge
const double kBalanceAngle = std::atan(kTippingSide_m / kTippingHeight_m);

// A block on one edge in the middle of a wall's top, released at rest beyond balance.
Scene blockOnEdge(int columns, int courses) {
  Scene scene = wallScene(columns, courses);
  scene.settings.sleep = Sleep::off;
  const auto top = std::ranges::max_element(scene.blocks, {}, [](const BlockSpec& block) { return block.centre.z(); });
  BlockSpec block;
  block.dimensions = Vec3(kTippingSide_m, kBlockWidth_m, kTippingHeight_m);
  block.mass = 600.0 * block.dimensions.prod();
  block.orientation = Eigen::AngleAxisd(kBalanceAngle + kBeyondBalance, Vec3::UnitY());
  block.centre = Vec3(top->centre.x(), 0.0, top->centre.z() + 0.5 * kBlockHeight_m) -
                 block.orientation * Vec3(0.5 * kTippingSide_m, 0.0, -0.5 * kTippingHeight_m);
  scene.blocks.push_back(block);
  return scene;
}

double beyondBalance(const Simulation& simulation) {
  const Vec3 up = meanEdge(simulation.state.position, simulation.model.blockCount() - 1, 2);
  return std::atan2(up.x(), up.z()) - kBalanceAngle;
}

struct Wall {
  int columns;
  int courses;
};
class TippingTest : public ::testing::TestWithParam<Wall> {};

// Near balance the angle grows as cosh(p t), p = sqrt(3 g / (4 R)), R from edge to centre (Housner 1963). In rigid steps a wall
// sways on the springs of its contacts; of its energy, a thousand times that of the block, the block has none to give. 5 %: the
// edge slips a little, and the first four frames are implicit.
TEST_P(TippingTest, OnAWallInRigidStepsGrowsAsAlone) {
  Simulation simulation(blockOnEdge(GetParam().columns, GetParam().courses));
  for (int frame = 0; frame < 10; ++frame) {
    if (frame >= 4) {
      for (IslandHistory& history : simulation.engine->memo.islandHistory) history.rigidFrames = 100;
    }
    prepareAndStep(simulation);
  }
  for (const IslandHistory& history : simulation.engine->memo.islandHistory) ASSERT_TRUE(history.rigid) << "all in rigid steps";
  const double rate = std::sqrt(0.75 * kStandardGravity_m_s2 / (0.5 * std::hypot(kTippingSide_m, kTippingHeight_m)));
  const double alone = kBeyondBalance * std::cosh(rate * simulation.time_s);
  EXPECT_NEAR(beyondBalance(simulation), alone, 0.05 * alone);
}

INSTANTIATE_TEST_SUITE_P(Walls, TippingTest, ::testing::Values(Wall{1, 1}, Wall{10, 4}, Wall{20, 12}), [](const auto& test) {
  return std::to_string(test.param.columns) + "x" + std::to_string(test.param.courses);
});

}  // namespace
}  // namespace springtower
