#include "solver/metrics/balance.h"

#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

Scene blockAlone(double height_m) {
  Scene scene = bitCodeScene("(010)");
  scene.blocks[0].centre.z() += height_m;
  return scene;
}

Imbalance imbalanceOf(const Simulation& simulation) {
  return largestImbalance(imbalances(simulation, contactForces(simulation)));
}

TEST(Balance, OfAFallingBlockLacksItsWholeWeight) {
  Simulation simulation(blockAlone(0.1));
  prepareAndStep(simulation);
  EXPECT_NEAR(imbalanceOf(simulation).force, 1.0, 1e-12);
  EXPECT_NEAR(imbalanceOf(simulation).torque, 0.0, 1e-12);
}

// The friction limit is 0.4 of the weight; a force of a quarter of the weight acts for two seconds, then friction has nothing
// left to balance.
TEST(Balance, OfAPushedBlockAtRestIncludesThePush) {
  Scene scene = blockAlone(0.0);
  const double weight = scene.blocks[0].mass * scene.gravity.magnitude;
  scene.forces.push_back(constantForce(0, -1, Vec3(0.1 * weight, 0.0, 0.0), 0.0, 2.0));
  Simulation simulation(scene);
  while (simulation.time_s < 1.99) prepareAndStep(simulation);
  ASSERT_EQ(userPushes(simulation).size(), 1U);
  EXPECT_LT(imbalanceOf(simulation).force, 1e-3);
  EXPECT_LT(imbalanceOf(simulation).torque, 1e-3);
  while (simulation.time_s < 3.0) prepareAndStep(simulation);
  EXPECT_TRUE(userPushes(simulation).empty());
  EXPECT_LT(imbalanceOf(simulation).force, 1e-3);
}

// The weight is carried at one point, 1 cm from the centre, by a block below that has nothing else under it.
TEST(Balance, OfTwoBlocksAddsTheReaction) {
  const Simulation simulation(bitCodeScene("(010)-(010)"));
  const double weight = simulation.model.mass[1] * simulation.scene.gravity.magnitude;
  const double height = simulation.model.dimensions[1].minCoeff();
  const Vec3 place = centre(simulation.state.position, 1) + Vec3(0.01, 0.0, 0.0);
  const std::vector<ContactForce> contacts = {
      {blockId(1), blockId(0), place, place, Vec3::UnitZ(), weight, Vec3::Zero(), 0.0, false}};
  const std::vector<Imbalance> left = imbalances(simulation, contacts);
  EXPECT_NEAR(left[1].force, 0.0, 1e-12);
  EXPECT_NEAR(left[1].torque, 0.01 / height, 1e-9);
  EXPECT_NEAR(left[0].force, 2.0, 1e-12);
}

TEST(Balance, WithoutGravityIsNotMeasured) {
  Scene scene = blockAlone(0.1);
  scene.gravity.magnitude = 0.0;
  EXPECT_EQ(imbalanceOf(Simulation(scene)).force, 0.0);
}

TEST(Cone, IsLeftByWhatFrictionExceedsItsCoefficientTimesTheNormalForce) {
  Simulation simulation(blockAlone(0.0));
  simulation.scene.staticFriction = 0.4;
  simulation.scene.kineticFriction = 0.3;
  ContactForce contact{blockId(0), kFloor, Vec3::Zero(), Vec3::Zero(), Vec3::UnitZ(), 2.0, Vec3(0.7, 0.0, 0.0), 0.0, false};
  EXPECT_EQ(farthestOutsideCone(simulation, std::vector{contact}), 0.0);
  contact.frictionForce.x() = 0.9;
  EXPECT_NEAR(farthestOutsideCone(simulation, std::vector{contact}), 0.1, 1e-12);
}

}  // namespace
}  // namespace springtower
