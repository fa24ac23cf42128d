// A snapshot holds everything that the next frames depend on: a scene that has never been stepped continues from it like the one
// it was taken from.
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

void expectTheSameFuture(const Scene& scene, int framesBefore, int framesAfter) {
  Simulation original(scene);
  for (int frame = 0; frame < framesBefore; ++frame) prepareAndStep(original);
  Simulation other(scene);
  restoreSnapshot(other, *takeSnapshot(original));
  EXPECT_EQ(stateHash(other), stateHash(original));
  for (int frame = 0; frame < framesAfter; ++frame) {
    prepareAndStep(original);
    prepareAndStep(other);
    ASSERT_EQ(stateHash(other), stateHash(original)) << "frame " << frame;
  }
}

TEST(Snapshot, OfATowerAtRestGoesOnInAnotherScene) {
  expectTheSameFuture(towerScene(6), 20, 20);
}

TEST(Snapshot, OfAFallingTowerGoesOnInAnotherScene) {
  Scene scene = towerScene(18);
  scene.gravity.tilt_deg = 14.5;
  expectTheSameFuture(scene, 30, 30);
}

TEST(Snapshot, OfExplicitStepsGoesOnInAnotherScene) {
  Scene scene = towerScene(4);
  scene.settings.method = Method::semiImplicitEuler;
  expectTheSameFuture(scene, 10, 10);
}

TEST(Snapshot, OfATowerAsleepGoesOnInAnotherScene) {
  Scene scene = towerScene(3);
  scene.forces.push_back(constantForce(7, -1, Vec3(0.4, 0.0, 0.0), 1.2, 2.0));
  expectTheSameFuture(scene, 70, 40);
}

// Inputs that are changed between frames are part of it.
TEST(Snapshot, BringsInputsBack) {
  Simulation simulation(towerScene(2));
  prepareAndStep(simulation);
  const auto snapshot = takeSnapshot(simulation);
  simulation.scene.gravity.tilt_deg = 3.0;
  simulation.scene.staticFriction = 0.9;
  simulation.scene.forces.push_back(constantForce(0, -1, Vec3::UnitX(), 0.0, 1.0));
  restoreSnapshot(simulation, *snapshot);
  EXPECT_EQ(simulation.scene.gravity.tilt_deg, 0.0);
  EXPECT_NE(simulation.scene.staticFriction, 0.9);
  EXPECT_TRUE(simulation.scene.forces.empty());
}

}  // namespace
}  // namespace springtower
