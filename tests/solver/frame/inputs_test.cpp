// What is changed between frames from outside.
#include "solver/frame/inputs.h"

#include "core/error.h"
#include "core/tuning.h"
#include "scenarios/loose.h"
#include "scenarios/towers.h"
#include "solver/hand/grip.h"
#include "solver/world/engine.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"
#include "tests/support/says.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

namespace springtower {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// By how much the speed of a block in the air may lack a constant force, m/s: velocities of explicit steps are half a step
// behind.
double laggingSpeed(const Simulation& simulation, double force_n) {
  const double step_s = simulation.scene.settings.frame_s / simulation.substeps;
  return 0.5 * step_s * force_n / simulation.model.mass[0] * (1.0 + 1e-9);
}

// A number beyond the blocks would be a write beyond their arrays.
TEST(Inputs, BlocksThatAreNotThereAreRefused) {
  Simulation simulation(oneBlockScene(false));
  for (const std::size_t block : {std::size_t{1}, std::numeric_limits<std::size_t>::max()}) {
    const auto message = ThrowsMessage<InputError>(HasSubstr("expected a block of the scene, from 0 to 0"));
    EXPECT_THAT([&] { kick(simulation, block, Vec3::UnitX()); }, message);
    EXPECT_THAT([&] { forceForOneFrame(simulation, block, Vec3::UnitX()); }, message);
    EXPECT_THAT([&] { handOn(simulation, blockId(block)); }, message);
    EXPECT_THAT([&] { drawingFrom(simulation, blockId(block), Vec3::UnitX(), 0.04); }, message);
  }
}

// The frame of a kick may take 128 implicit steps. Where it ends in rigid steps, and blocks sleep or go back to implicit ones
// later, these are no more than after any other fall.
TEST(Inputs, AKickThatEndsInRigidStepsLeavesNoMoreStepsThanAFall) {
  Scene scene = towerScene(3);
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  stepFor(simulation, 0.1);
  kick(simulation, 8, Vec3(0.0, 4.0, 1.0));
  bool wasRigid = false;
  for (int frame = 0; frame < 60; ++frame) {
    prepareAndStep(simulation);
    const Memo& memo = simulation.engine->memo;
    for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
      if (!memo.blockHistory[b].explicitLast) continue;
      wasRigid = true;
      EXPECT_LE(memo.islandHistory[b].implicitSteps, tuning::kMaxFrequencySteps) << "block " << b << ", frame " << frame;
    }
  }
  EXPECT_TRUE(wasRigid);
}

TEST(Inputs, AForceForOneFrameActsInThatFrameAlone) {
  Scene scene = oneBlockScene(false);
  scene.gravity.magnitude = 0.0;
  Simulation simulation(scene);
  const double frame_s = scene.settings.frame_s;
  setOnlyForce(simulation, forceForOneFrame(simulation, 0, Vec3(0.1, 0.0, 0.0)));
  prepareAndStep(simulation);
  const double speed_m_s = 0.1 * frame_s / scene.blocks[0].mass;
  const double lag_m_s = laggingSpeed(simulation, 0.1);
  EXPECT_NEAR(centre(simulation.state.velocity, 0).x(), speed_m_s, lag_m_s);
  clearForces(simulation);
  prepareAndStep(simulation);
  EXPECT_NEAR(centre(simulation.state.velocity, 0).x(), speed_m_s, lag_m_s);
}

TEST(Inputs, ForcesAddUpAndEndedOnesAreDropped) {
  Scene scene = oneBlockScene(false);
  scene.gravity.magnitude = 0.0;
  Simulation simulation(scene);
  applyForce(simulation, {0, -1, Vec3(0.1, 0.0, 0.0), 0.0, 0.05});
  applyForce(simulation, {0, -1, Vec3(0.2, 0.0, 0.0), 0.0, 0.05});
  EXPECT_EQ(simulation.scene.forces.size(), 2U);
  stepFor(simulation, 0.2);
  EXPECT_NEAR(centre(simulation.state.velocity, 0).x(), 0.3 * 0.05 / scene.blocks[0].mass, laggingSpeed(simulation, 0.3));
  applyForce(simulation, {0, -1, Vec3(0.2, 0.0, 0.0), 0.3, 0.4});
  EXPECT_EQ(simulation.scene.forces.size(), 1U);
}

TEST(Inputs, SleepAndFrictionWakeAllBlocks) {
  const auto woken = [](const Simulation& simulation) {
    return simulation.wakes[static_cast<std::size_t>(WakeReason::settings)];
  };
  Simulation simulation(towerScene(2));
  stepFor(simulation, 3.0);
  ASSERT_TRUE(allAsleep(simulation));
  setFriction(simulation, 0.5, 0.3);
  EXPECT_EQ(simulation.scene.staticFriction, 0.5);
  EXPECT_EQ(simulation.scene.kineticFriction, 0.3);
  EXPECT_EQ(woken(simulation), 6U);
  stepFor(simulation, 3.0);
  ASSERT_TRUE(allAsleep(simulation));
  setSleep(simulation, Sleep::off);
  EXPECT_EQ(woken(simulation), 12U);
  stepFor(simulation, 3.0);
  EXPECT_FALSE(allAsleep(simulation));
}

TEST(Inputs, WhatIsNotAllowedChangesNothing) {
  Simulation simulation(towerScene(1));
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      [&] {
        applyForce(simulation, {3, -1, Vec3::UnitX(), 0.0, 1.0});
      },
      ThrowsMessage<InputError>(HasSubstr("force: block: expected 0 to 2, got 3")));
  EXPECT_THAT(
      [&] {
        setOnlyForce(simulation, {0, -1, Vec3(0.0, kNan, 0.0), 0.0, 1.0});
      },
      ThrowsMessage<InputError>(says("force: force y: expected ..., got nan")));
  EXPECT_THAT(
      [&] {
        applyForce(simulation, {0, -1, Vec3::UnitX(), 1.0, 0.5});
      },
      ThrowsMessage<InputError>(says("force: end: expected 1 to ..., got 0.5")));
  EXPECT_THAT([&] { setGravity(simulation, {.magnitude = -1.0}); },
              ThrowsMessage<InputError>(says("gravity: magnitude: expected ..., got -1")));
  EXPECT_THAT([&] { setFriction(simulation, 0.2, 0.3); },
              ThrowsMessage<InputError>(says("kinetic friction: expected 0 to 0.2..., got 0.3")));
  EXPECT_TRUE(simulation.scene.forces.empty());
  EXPECT_EQ(simulation.scene.gravity.magnitude, kStandardGravity_m_s2);
  EXPECT_EQ(simulation.scene.staticFriction, 0.4);
}

TEST(Inputs, OfASceneInThePlaneStayInIt) {
  Scene scene = oneBlockScene(true);
  scene.plane = true;
  Simulation simulation(scene);
  EXPECT_THAT(
      [&] {
        applyForce(simulation, {0, -1, Vec3(1.0, 0.1, 0.0), 0.0, 1.0});
      },
      ThrowsMessage<InputError>(says("force: force y: expected ..., got 0.1")));
  EXPECT_THAT([&] { setGravity(simulation, {.tilt_deg = 5.0, .direction_deg = 90.0}); },
              ThrowsMessage<InputError>(HasSubstr("gravity: y")));
  applyForce(simulation, {0, -1, Vec3(1.0, 0.0, 0.1), 0.0, 1.0});
  setGravity(simulation, {.tilt_deg = 5.0});
  EXPECT_EQ(simulation.scene.forces.size(), 1U);
  EXPECT_EQ(simulation.scene.gravity.tilt_deg, 5.0);
}

}  // namespace
}  // namespace springtower
