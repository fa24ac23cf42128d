#include "core/scene/scene.h"
#include "scenarios/registry.h"
#include "solver/metrics/measures.h"
#include "solver/runner/run.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>
#include <string>
#include <utility>

namespace springtower {
namespace {

constexpr double kGravity = kStandardGravity_m_s2;

// A stack of blocks in the air that lands flat at this speed.
Scene droppedStack(int blocks, double speed) {
  Scene scene;
  scene.settings.sleep = Sleep::off;
  for (int i = 0; i < blocks; ++i) {
    BlockSpec block;
    block.centre.z() = speed * speed / (2.0 * kGravity) + (0.5 + i) * kBlockHeight_m;
    scene.blocks.push_back(block);
  }
  return scene;
}

// Speed of the centre of mass after the first landing over that before it, from height and speed as the first frame after it
// ends: in free flight their energy is constant.
double reboundOf(const Scene& scene, double speed) {
  Simulation simulation(scene);
  const double landing_s = speed / kGravity;
  while (simulation.time_s <= landing_s) prepareAndStep(simulation);
  const auto count = static_cast<double>(scene.blocks.size());
  double height = 0.0;
  double rise = 0.0;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    height += (centre(simulation.state.position, b).z() - (0.5 + static_cast<double>(b)) * kBlockHeight_m) / count;
    rise += centre(simulation.state.velocity, b).z() / count;
  }
  return std::sqrt(std::max(0.0, rise * rise + 2.0 * kGravity * height)) / speed;
}

struct ReboundCase {
  Method method;
  double tolerance_m;
  double frame_s;
};

struct FlatDrop : ::testing::TestWithParam<ReboundCase> {};

// Speed after over speed before is the coefficient, whatever the height, the number of blocks, the tolerance and the frame. 0.03
// is the required bound; the passes through a stack of four end at 1 % of the speed.
TEST_P(FlatDrop, ReboundsWithTheCoefficient) {
  const Method method = GetParam().method;
  for (const double coefficient : {0.0, 0.5, 0.9}) {
    for (int blocks = 1; blocks <= 4; ++blocks) {
      for (const double speed : {0.2, 0.5, 1.0, 2.0, 5.0}) {
        // Steps of 4 ms, in which stacks fall by a third of a millimetre too much.
        if (method == Method::rigidLcp && blocks > 1 && speed < 0.5) continue;
        // One pass leaves the blocks of a stack inside one another, and steps after it push them apart.
        if (method == Method::xpbd && blocks > 1 && coefficient == 0.0) continue;
        SCOPED_TRACE(testing::Message() << blocks << " blocks at " << speed << " m/s, coefficient " << coefficient);
        Scene scene = droppedStack(blocks, speed);
        scene.restitution = coefficient;
        scene.settings.method = method;
        scene.settings.tolerance_m = GetParam().tolerance_m;
        scene.settings.frame_s = GetParam().frame_s;
        EXPECT_NEAR(reboundOf(scene, speed), coefficient, 0.03);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, FlatDrop,
                         ::testing::Values(ReboundCase{Method::implicit, kBlockTolerance_m, 1.0 / 60.0},
                                           ReboundCase{Method::implicit, 1e-5, 1.0 / 60.0},
                                           ReboundCase{Method::implicit, 1e-6, 1.0 / 240.0},
                                           ReboundCase{Method::implicit, kBlockTolerance_m, 1.0 / 1000.0},
                                           ReboundCase{Method::rigidPgs, kBlockTolerance_m, 1.0 / 60.0},
                                           ReboundCase{Method::rigidLcp, kBlockTolerance_m, 1.0 / 60.0},
                                           ReboundCase{Method::xpbd, kBlockTolerance_m, 1.0 / 60.0}),
                         [](const auto& test) { return "Case" + std::to_string(test.index); });

// sqrt(g h) / 20: a rebound by a thousandth of the height.
TEST(Rebound, SlowImpactsHaveNone) {
  const double least = std::sqrt(kGravity * kBlockHeight_m) / 20.0;
  for (const double share : {0.5, 0.9, 2.0, 10.0}) {
    Scene scene = droppedStack(1, share * least);
    scene.settings.frame_s = 1e-3;
    EXPECT_NEAR(reboundOf(scene, share * least), share < 1.0 ? 0.0 : 0.5, 0.03) << share;
  }
}

// Two blocks have the geometric mean of their coefficients: one that never rebounds, never does.
TEST(Rebound, ABlockMayHaveItsOwn) {
  Scene scene = droppedStack(1, 1.0);
  scene.restitution = 0.36;
  scene.blocks[0].restitution = 0.81;
  EXPECT_NEAR(reboundOf(scene, 1.0), std::sqrt(0.36 * 0.81), 0.01);
  scene.blocks[0].restitution = 0.0;
  EXPECT_NEAR(reboundOf(scene, 1.0), 0.0, 0.01);
}

// Without gravity, flat against one another: they part at the coefficient times the speed at which they met, and their momentum
// is what it was.
TEST(Rebound, TwoBlocksInSpacePartAndKeepTheirMomentum) {
  for (const double coefficient : {0.0, 0.3, 1.0}) {
    Scene scene;
    scene.floor = false;
    scene.gravity.magnitude = 0.0;
    scene.restitution = coefficient;
    scene.settings.sleep = Sleep::off;
    BlockSpec block;
    block.velocity = {1.0, 0.0, 0.0};
    scene.blocks.push_back(block);
    block.centre.x() = kBlockLength_m + 0.01;
    block.velocity = {-2.0, 0.0, 0.0};
    block.mass = 3.0 * kBlockMass_kg;
    scene.blocks.push_back(block);
    Simulation simulation(scene);
    const Momentum before = momentum(simulation);
    stepFor(simulation, 0.1);
    const double parting = (centre(simulation.state.velocity, 1) - centre(simulation.state.velocity, 0)).x();
    EXPECT_NEAR(parting, 3.0 * coefficient, 0.03) << coefficient;
    EXPECT_LT((momentum(simulation).linear - before.linear).norm(), 1e-12 * before.linear.norm()) << coefficient;
  }
}

// A row with gaps: every block hands on (1 + e) / 2 of the speed at which it was hit.
TEST(Rebound, ABlowIsHandedOnAlongARow) {
  constexpr int kBlocks = 4;
  Scene scene;
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  scene.settings.sleep = Sleep::off;
  for (int i = 0; i < kBlocks; ++i) {
    BlockSpec block;
    block.centre.y() = i * (kBlockWidth_m + 0.004);
    if (i == 0) block.velocity.y() = 1.0;
    scene.blocks.push_back(block);
  }
  Simulation simulation(scene);
  stepFor(simulation, 0.2);
  EXPECT_NEAR(centre(simulation.state.velocity, kBlocks - 1).y(), std::pow(0.75, kBlocks - 1), 0.01);
}

// A rebound gains no energy, however a block lands, with any coefficient.
TEST(Rebound, GainsNoEnergy) {
  for (const double coefficient : {0.5, 1.0}) {
    for (int i = 0; i < 12; ++i) {
      SCOPED_TRACE(testing::Message() << "coefficient " << coefficient << ", turn " << i);
      Scene scene = droppedStack(1, 1.5);
      scene.restitution = coefficient;
      scene.blocks[0].centre.z() += 0.04;
      scene.blocks[0].orientation = Eigen::AngleAxisd(0.5 * i, Vec3(1.0, 0.2 * i, 0.3).normalized());
      scene.blocks[0].spin = {3.0, -5.0, 1.0};
      Simulation simulation(scene);
      RunOptions options;
      options.seconds = 1.0;
      const RunResult result = runScene(simulation, options);
      ASSERT_TRUE(result.maxEnergyRise.has_value());
      EXPECT_LE(*result.maxEnergyRise, 1e-4);
    }
  }
}

// Several blocks that meet at once, with friction, gain energy by Newton's law alone: it is bounded. Half a millionth
// is what passes that do not converge leave of a heap at its start.
TEST(Rebound, OfManyBlocksGainsNoEnergy) {
  for (const auto& [method, name] : {std::pair(Method::xpbd, "heap:25"), std::pair(Method::rigidLcp, "heap:6")}) {
    for (const double coefficient : {0.9, 1.0}) {
      SCOPED_TRACE(testing::Message() << nameOf(method) << ", coefficient " << coefficient);
      Scene scene = sceneNamed(name);
      scene.settings.method = method;
      scene.restitution = coefficient;
      Simulation simulation(scene);
      double least_j = energy(simulation).total();
      const double start_j = least_j;
      for (int frame = 0; frame < 90; ++frame) {
        prepareAndStep(simulation);
        const Energy now = energy(simulation);
        const double moving_j = now.kinetic + now.gravity;
        ASSERT_LE(moving_j, least_j + 5e-7 * start_j) << "frame " << frame;
        least_j = std::min(least_j, moving_j);
      }
    }
  }
}

}  // namespace
}  // namespace springtower
