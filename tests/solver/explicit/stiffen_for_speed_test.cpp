// Springs of explicit methods get stiffer as forces make blocks faster than their scene let foresee, and only then.
#include "scenarios/registry.h"
#include "solver/frame/prepare.h"
#include "solver/world/simulation.h"
#include "solver/world/snapshot.h"

#include <cstdint>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

namespace springtower {
namespace {

// A force of fourteen weights on one corner of the top block, which spins it and gives it 30 m/s.
const UserForce kOnCorner{.block = 3, .corner = 4, .force = Vec3(0.0, 2.7, 0.0), .start_s = 0.1, .end_s = 0.34};

Scene pushedStack(Method method, const UserForce& force) {
  Scene scene = bitCodeScene("(111)-(010)");
  scene.settings.method = method;
  scene.settings.tolerance_m = 2e-4;
  scene.seconds = 0.6;
  scene.forces = {force};
  return scene;
}

void stepFrames(Simulation& simulation, int frames) {
  prepare(simulation);
  for (int i = 0; i < frames; ++i) stepFrame(simulation);
}

// Without, the block turns itself inside out (random scene 2576 and its kind).
TEST(StiffenForSpeed, ABlockThatAForceOrATorqueSpeedsUpDoesNotDiverge) {
  const UserForce torque{.block = 3, .start_s = 0.1, .end_s = 0.34, .torque = Vec3(0.05, 0.0, 0.0)};
  for (const Method method : {Method::semiImplicitEuler, Method::rungeKutta4}) {
    for (const UserForce& force : {kOnCorner, torque}) {
      SCOPED_TRACE(testing::Message() << nameOf(method) << (force.corner < 0 ? ", torque" : ", force"));
      Simulation simulation(pushedStack(method, force));
      EXPECT_NO_THROW(stepFrames(simulation, 36));
    }
  }
}

// What is pressed or held stays slow, however strong the force is and however long it lasts.
TEST(StiffenForSpeed, WhatIsHeldKeepsItsSprings) {
  Scene scene = bitCodeScene("(111)-(010)");
  scene.settings.method = Method::semiImplicitEuler;
  scene.forces = {UserForce{.block = 3, .force = Vec3(0.05, 0.0, -3.0), .end_s = 100.0}};
  Simulation simulation(scene);
  const std::vector<double> before = simulation.stiffness.edge_n_m;
  stepFrames(simulation, 60);
  EXPECT_EQ(simulation.stiffness.edge_n_m, before);
}

TEST(StiffenForSpeed, LeavesOtherIslandsAsTheyAre) {
  Scene scene = pushedStack(Method::semiImplicitEuler, kOnCorner);
  scene.blocks.push_back(scene.blocks[0]);
  scene.blocks.back().centre.x() += 10.0;
  Simulation simulation(scene);
  const std::vector<double> before = simulation.stiffness.edge_n_m;
  stepFrames(simulation, 36);
  EXPECT_GT(simulation.stiffness.edge_n_m[3], 2.0 * before[3]);
  EXPECT_EQ(simulation.stiffness.edge_n_m[4], before[4]);
}

// A snapshot brings the springs of its time: into a simulation that was never fast, and back into one that has been.
TEST(StiffenForSpeed, SnapshotsCarryTheSprings) {
  const Scene scene = pushedStack(Method::semiImplicitEuler, kOnCorner);
  Simulation simulation(scene);
  stepFrames(simulation, 3);
  const std::shared_ptr<const Snapshot> slow = takeSnapshot(simulation);
  const std::vector<double> slowEdges = simulation.stiffness.edge_n_m;
  stepFrames(simulation, 17);
  const std::shared_ptr<const Snapshot> fast = takeSnapshot(simulation);
  const double fastEnergy_j = energy(simulation).total();
  stepFrames(simulation, 10);
  const std::uint64_t end = stateHash(simulation);

  Simulation other(scene);
  restoreSnapshot(other, *fast);
  EXPECT_EQ(energy(other).total(), fastEnergy_j);
  stepFrames(other, 10);
  EXPECT_EQ(stateHash(other), end);

  restoreSnapshot(simulation, *slow);
  EXPECT_EQ(simulation.stiffness.edge_n_m, slowEdges);
  stepFrames(simulation, 27);
  EXPECT_EQ(stateHash(simulation), end);
}

}  // namespace
}  // namespace springtower
