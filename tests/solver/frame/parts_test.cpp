// Frames in parts: what moves fast is stepped through the frame part by part, what rests in one step.
#include "core/scene/scene.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <span>

namespace springtower {
namespace {

// Three bricks upon one another without gravity, moving together.
void addStack(Scene& scene, const Vec3& lowest, const Vec3& velocity) {
  for (int i = 0; i < 3; ++i) {
    BlockSpec block;
    block.centre = lowest + Vec3(0.0, 0.0, i * block.dimensions.z());
    block.velocity = velocity;
    scene.blocks.push_back(block);
  }
}

Scene inSpace() {
  Scene scene;
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  scene.settings.sleep = Sleep::off;
  return scene;
}

Vec3 momentumOf(const Simulation& simulation) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b)
    sum += simulation.model.mass[b] * centre(simulation.state.velocity, b);
  return sum;
}

bool isRigid(const Simulation& simulation, std::size_t block) {
  return simulation.engine->memo.islandHistory[block].rigid;
}

// A stack flies past another that rests: the one in many rigid steps, the other in one implicit step a frame.
TEST(Parts, WhatRestsTakesOneStepAFrameBesideWhatFlies) {
  Scene scene = inSpace();
  addStack(scene, Vec3::Zero(), Vec3::Zero());
  addStack(scene, Vec3(-0.5, 1.0, 0.0), Vec3(4.0, 0.0, 0.0));
  Simulation simulation(scene);
  prepareAndStep(simulation);  // rigid from here on
  for (int frame = 0; frame < 10; ++frame) {
    const std::uint64_t before = simulation.counters.implicitSteps;
    stepFrame(simulation);
    EXPECT_LE(simulation.counters.implicitSteps - before, 1U);
    EXPECT_GT(simulation.substeps, 10);
    EXPECT_TRUE(isRigid(simulation, 3));
    EXPECT_FALSE(isRigid(simulation, 0));
  }
}

// It flies into the other one: their islands become one within the frame in which they meet, the resting one having been run up
// to that time. No momentum is lost, and nothing passes through anything.
TEST(Parts, WhatIsMetWithinAFrameMovesOnWithWhatMeetsIt) {
  for (const double way_m : {0.30, 0.31, 0.32, 0.33, 0.34, 0.35}) {
    Scene scene = inSpace();
    addStack(scene, Vec3::Zero(), Vec3::Zero());
    addStack(scene, Vec3(-way_m, 0.004, 0.005), Vec3(5.0, 0.0, 0.0));
    Simulation simulation(scene);
    prepareAndStep(simulation);
    const Vec3 before = momentumOf(simulation);
    PenetrationWorkspace workspace;
    double deepest_m = 0.0;
    for (int frame = 0; frame < 12; ++frame) {
      stepFrame(simulation);
      deepest_m = std::max(deepest_m, maxPenetration(simulation.state.position, false, workspace).depth);
    }
    EXPECT_LT((momentumOf(simulation) - before).norm(), 1e-12 * before.norm()) << way_m;
    EXPECT_LT(deepest_m, 5e-4) << way_m;
    EXPECT_TRUE(isRigid(simulation, 0)) << way_m;
    EXPECT_GT(centre(simulation.state.velocity, 0).x(), 0.5) << "it has been hit";
  }
}

// A fast stack in a row of others 2 mm apart: each passes the blow on within a step, faster than its points were listed for.
TEST(Parts, ABlowIsPassedOnThroughManyWithoutOverlap) {
  Scene scene = inSpace();
  const double pitch_m = BlockSpec().dimensions.x() + 2e-3;
  for (int i = 0; i < 6; ++i) addStack(scene, Vec3(i * pitch_m, 0.0, 0.0), i == 0 ? Vec3(6.0, 0.0, 0.0) : Vec3(Vec3::Zero()));
  Simulation simulation(scene);
  const Vec3 before = [&] {
    prepareAndStep(simulation);
    return momentumOf(simulation);
  }();
  PenetrationWorkspace workspace;
  for (int frame = 0; frame < 20; ++frame) {
    stepFrame(simulation);
    EXPECT_LT(maxPenetration(simulation.state.position, false, workspace).depth, 5e-4) << "frame " << frame;
  }
  EXPECT_LT((momentumOf(simulation) - before).norm(), 1e-10 * before.norm())
      << "stacks that are slow again are solved to a residual";
}

}  // namespace
}  // namespace springtower
