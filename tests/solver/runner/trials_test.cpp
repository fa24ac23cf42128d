#include "solver/runner/trials.h"

#include "solver/statics/statics.h"
#include "tests/support/prepare_and_step.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

constexpr double kTrialWeight_n = kBlockMass_kg * kStandardGravity_m_s2;

Simulation settled(Scene scene, double seconds) {
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  while (simulation.time_s < seconds) prepareAndStep(simulation);
  return simulation;
}

// Alone on the floor a block slips at mu m g in any direction. (Friction is below 0.6: beyond that contacts of the default
// tolerance deform by more than the 0.05 mm of a slip before they slide.)
TEST(Pull, ABlockAloneSlipsAtFrictionTimesItsWeight) {
  for (const double friction : {0.2, 0.4, 0.5}) {
    for (const double angle : {0.0, 1.0}) {
      Scene scene = bitCodeScene("(010)");
      scene.staticFriction = friction;
      scene.kineticFriction = friction;
      Simulation simulation = settled(scene, 0.5);
      const SlipTrial trial = pullUntilSlip(simulation, 0, {std::cos(angle), std::sin(angle), 0.0});
      ASSERT_TRUE(trial.slipped) << friction;
      EXPECT_NEAR(trial.force_n / (friction * kTrialWeight_n), 1.0, 0.01) << friction << " towards " << angle;
    }
  }
}

struct PulledBlock {
  std::string name;
  std::string scene;
  int row;
  int position;
};

class PullTest : public ::testing::TestWithParam<PulledBlock> {};

// At first slip all contacts slide: the force is mu times the sum of the normal forces just before, and at most the limit of
// statics.
TEST_P(PullTest, SlipsAtFrictionTimesItsNormalForces) {
  const Scene scene = sceneFromName(GetParam().scene);
  std::size_t block = 0;
  while (scene.blocks[block].row != GetParam().row || scene.blocks[block].position != GetParam().position) ++block;
  const Vec3 direction = scene.blocks[block].orientation * Vec3::UnitX();
  Simulation simulation = settled(scene, 2.0);
  const SlipTrial trial = pullUntilSlip(simulation, block, direction);
  ASSERT_TRUE(trial.slipped);
  EXPECT_NEAR(trial.force_n / (scene.staticFriction * trial.normal_n), 1.0, 0.01);
  EXPECT_NEAR(trial.force_n / trial.limit_n, 1.0, 0.01);
  const std::optional<double> limit = pullLimit(staticScene(scene), blockId(block), direction);
  ASSERT_TRUE(limit.has_value());
  EXPECT_LT(trial.force_n, 1.01 * *limit);
}

INSTANTIATE_TEST_SUITE_P(Pull, PullTest,
                         ::testing::Values(PulledBlock{"Middle", "tower:6", 2, 2}, PulledBlock{"Outer", "tower:6", 3, 1},
                                           PulledBlock{"Loose", "(111)-(111)-(1L1)-(111)-(111)", 2, 2}),
                         [](const auto& block) { return block.param.name; });

// Light blocks rotate with the end of the block that is drawn from under them, so it slips at less than friction times the normal
// forces: at the friction limit for these normal forces.
TEST(Pull, LightBlocksTurnWithTheOneThatIsDrawn) {
  Scene scene = sceneFromName("tower:6");
  for (BlockSpec& above : scene.blocks) {
    if (above.row == 5) above.dimensions.y() *= 0.5;  // the narrower they are, the less their other contacts hold them
  }
  std::size_t block = 0;
  while (scene.blocks[block].row != 4 || scene.blocks[block].position != 1) ++block;
  Simulation simulation = settled(scene, 2.0);
  const SlipTrial trial = pullUntilSlip(simulation, block, scene.blocks[block].orientation * Vec3::UnitX());
  ASSERT_TRUE(trial.slipped);
  EXPECT_LT(trial.limit_n, 0.98 * scene.staticFriction * trial.normal_n);
  EXPECT_NEAR(trial.force_n / trial.limit_n, 1.0, 0.005);
}

// A column of six blocks tips over the edge of the lowest: half its width over half the column's height.
TEST(Tilt, AColumnGoesAtItsEdge) {
  const Scene scene = bitCodeScene("(010)-(010)-(010)-(010)-(010)-(010)");
  const double edge_deg = std::atan(0.5 * kBlockWidth_m / (3.0 * kBlockHeight_m)) * 57.29577951;
  const std::optional<StabilityMargin> margin = tiltMargin(staticScene(scene));
  ASSERT_TRUE(margin.has_value());
  EXPECT_NEAR(margin->tilt_deg, edge_deg, 0.01);
  const TiltTrial trial =
      tiltUntilFall(scene, {margin->direction_deg, margin->tilt_deg - 0.5, 2.0, 0.5, 0.1, margin->tilt_deg + 2.0});
  ASSERT_TRUE(trial.fell);
  EXPECT_NEAR(trial.tilt_deg, edge_deg, 0.3);
}

TEST(Tilt, AStandingTowerDoesNotFall) {
  const TiltTrial trial = tiltUntilFall(bitCodeScene("(010)-(010)"), {0.0, 0.0, 2.0, 0.0, 5.0, 5.0});
  EXPECT_FALSE(trial.fell);
  EXPECT_NEAR(trial.tilt_deg, 5.0, 0.1);
}

struct ScaleTest : ::testing::TestWithParam<std::pair<double, double>> {};

// Only the blocks and the frame change: every length of the engine is a multiple of the block height, every time of sqrt(h / g),
// every force of a weight. The differences are rounding, and the residual of implicit steps, 1e-5 of a weight.
TEST_P(ScaleTest, ATowerIsCompressedByTheSameShareOfItsHeight) {
  const auto [size, density] = GetParam();
  const auto compressed = [](const Scene& scene) {
    Simulation simulation(scene);
    for (int frame = 0; frame < 120; ++frame) prepareAndStep(simulation);
    const double top = simulation.lengths.blockHeight_m * 6.0;
    return 1.0 - centre(simulation.state.position, 17).z() / (top - 0.5 * simulation.lengths.blockHeight_m);
  };
  const double own = compressed(towerScene(6));
  EXPECT_GT(own, 1e-4);
  EXPECT_NEAR(compressed(scaled(towerScene(6), size, density)), own, 1e-3 * own);
}

// Blocks that overhang by 10 mm stay; with 14.4 mm, beyond the 13.35 mm of statics, they fall in the same number of frames.
TEST_P(ScaleTest, WhatFallsFallsInAsManyFrames) {
  const auto [size, density] = GetParam();
  const auto framesUntilFall = [](const Scene& scene) {
    Simulation simulation(scene);
    const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
    int frame = 0;
    while (frame < 120 && standing(simulation.model, start, simulation.state.position).stands) {
      prepareAndStep(simulation);
      ++frame;
    }
    return frame;
  };
  for (const double overhang_m : {0.0100, 0.0144}) {
    TowerOptions options;
    options.offsets.push_back({1, 2, 0.0, overhang_m});
    const Scene scene = bitCodeScene("(010)-(010)", options);
    const int frames = framesUntilFall(scene);
    EXPECT_EQ(frames == 120, overhang_m < 0.0133) << frames;
    EXPECT_NEAR(framesUntilFall(scaled(scene, size, density)), frames, 1) << overhang_m;
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, ScaleTest,
                         ::testing::Values(std::pair{0.1, 1.0}, std::pair{10.0, 1.0}, std::pair{1.0, 10.0}, std::pair{1.0, 0.1}));

}  // namespace
}  // namespace springtower
