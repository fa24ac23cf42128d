#include "solver/frame/choose_method.h"

#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// One block above the floor, its lowest corner `fall_m` above it.
Scene fallingBlock(double fall_m, double tilt_deg) {
  Scene scene = oneBlockScene(true);
  const double tilt = tilt_deg * std::numbers::pi / 180.0;
  scene.blocks[0].orientation = Eigen::AngleAxisd(tilt, Vec3::UnitX());
  scene.blocks[0].centre.z() = fall_m + 0.5 * (kBlockHeight_m * std::cos(tilt) + kBlockWidth_m * std::sin(tilt)) + 1e-12;
  scene.settings.method = Method::automatic;
  return scene;
}

TEST(ChooseMethod, WhatStandsOrFallsFlatIsSteppedImplicitly) {
  Scene tower = towerScene(18);
  tower.settings.method = Method::automatic;
  EXPECT_EQ(chooseMethod(tower).method, Method::implicit);
  tower.settings.tolerance_m = 1e-6;
  EXPECT_EQ(chooseMethod(tower).method, Method::implicit) << "at any tolerance";
  EXPECT_EQ(chooseMethod(fallingBlock(0.05, 0.0)).method, Method::implicit);
  EXPECT_EQ(chooseMethod(fallingBlock(1e-5, 10.0)).method, Method::implicit);
}

// m v^2 against four times k (8 tolerances)^2, with k = (m g / 2) / tolerance: the method changes at a fall of 64 tolerances.
TEST(ChooseMethod, WhatFallsFarAndAskewIsTakenAsRigid) {
  for (const double tolerance_m : {1e-4, 1e-5}) {
    Scene near = fallingBlock(60.0 * tolerance_m, 10.0);
    Scene far = fallingBlock(70.0 * tolerance_m, 10.0);
    near.settings.tolerance_m = far.settings.tolerance_m = tolerance_m;
    EXPECT_EQ(chooseMethod(near).method, Method::implicit);
    EXPECT_EQ(chooseMethod(far).method, Method::rigidPgs);
  }
}

// Implicit methods change to rigid steps by themselves for falls of three blocks and more.
TEST(ChooseMethod, SomeBlocksThatFallAskewAreSteppedImplicitly) {
  const auto heap = [](int blocks) {
    Scene scene = fallingBlock(0.05, 10.0);
    for (int i = 1; i < blocks; ++i) {
      scene.blocks.push_back(scene.blocks.back());
      scene.blocks.back().centre.x() += 0.1;
    }
    return scene;
  };
  EXPECT_EQ(chooseMethod(heap(2)).method, Method::rigidPgs);
  EXPECT_EQ(chooseMethod(heap(3)).method, Method::implicit);
  EXPECT_EQ(chooseMethod(heap(300)).method, Method::implicit);
}

// A block thrown at another rocks like one that falls askew; a single block that slides collides with nothing.
TEST(ChooseMethod, WhatMeetsAtSpeedIsTakenAsRigid) {
  for (const double gravity : {kStandardGravity_m_s2, 0.0}) {
    Scene scene = oneBlockScene(true);
    scene.gravity.magnitude = gravity;
    scene.settings.method = Method::automatic;
    scene.blocks[0].velocity.x() = 2.0;
    EXPECT_EQ(chooseMethod(scene).method, Method::implicit);
    scene.blocks.push_back(scene.blocks[0]);
    scene.blocks[1].centre.x() += 0.3;
    EXPECT_EQ(chooseMethod(scene).method, Method::implicit) << "both alike";
    scene.blocks[1].velocity.x() = -2.0;
    EXPECT_EQ(chooseMethod(scene).method, Method::rigidPgs);
    EXPECT_GE(chooseMethod(scene).substeps, 1);
  }
}

// The sag of rigid blocks is proportional to the square of the step: a quarter of the tolerance requires twice the steps.
TEST(ChooseMethod, RigidStepsFollowTheTolerance) {
  Scene scene = fallingBlock(0.05, 10.0);
  scene.settings.tolerance_m = 4e-6;
  const int coarse = chooseMethod(scene).substeps;
  scene.settings.tolerance_m = 1e-6;
  EXPECT_NEAR(chooseMethod(scene).substeps, 2 * coarse, 2);
  scene.settings.substeps = 7;
  EXPECT_EQ(chooseMethod(scene).substeps, 7) << "as set";
}

TEST(ChooseMethod, ASimulationNamesWhatWasChosen) {
  EXPECT_EQ(Simulation(fallingBlock(0.05, 10.0)).scene.settings.method, Method::rigidPgs);
  EXPECT_EQ(Simulation(fallingBlock(0.0, 0.0)).scene.settings.method, Method::implicit);
}

}  // namespace
}  // namespace springtower
