#include "core/error.h"
#include "core/scene/scene.h"
#include "scenarios/registry.h"
#include "solver/frame/prepare.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>

namespace springtower {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A heap of 25 blocks in rigid steps, falling or just landed; a tower of 27 at rest in implicit steps.
Simulation steppedScene(const std::string& name, int frames) {
  Simulation simulation(sceneNamed(name));
  prepare(simulation);
  for (int i = 0; i < frames; ++i) stepFrame(simulation);
  return simulation;
}

void setVelocity(std::size_t block, double speed, Simulation& simulation) {
  for (std::size_t c = 0; c < kCorners; ++c) simulation.state.velocity.set(block, c, Vec3(speed, 0.0, 0.0));
}

std::string messageOf(Simulation& simulation, int frames) {
  try {
    for (int i = 0; i < frames; ++i) stepFrame(simulation);
  } catch (const DivergenceError& error) {
    return error.what();
  }
  return "none";
}

// A velocity that is none, or that no block has, ends the run with the block and the time. Once it was followed by ever larger
// swept boxes, without end: a block that is not in its box after a frame takes the frame again with a larger one.
TEST(Divergence, OfABlockThatMovesWithoutBoundsEndsTheFrame) {
  for (const int frames : {3, 40}) {
    for (const double speed : {kNan, kInfinity, -kInfinity, 2e8, 1e13, 1e100, 1e300}) {
      SCOPED_TRACE(testing::Message() << speed << " m/s after " << frames << " frames");
      Simulation simulation = steppedScene("heap:25", frames);
      setVelocity(7, speed, simulation);
      const std::string message = messageOf(simulation, 2);
      EXPECT_NE(message.find("diverged at"), std::string::npos) << message;
      EXPECT_EQ(message.rfind("block ", 0), 0U) << message;
      if (frames == 40 && speed == 2e8) {
        EXPECT_NE(message.find("it moves at 2e+08 m/s"), std::string::npos) << message;
      }
    }
  }
}

// One corner is enough, of a velocity or a position.
TEST(Divergence, OfASingleCornerEndsTheFrame) {
  for (const auto& [scene, frames] : {std::pair("heap:25", 0), std::pair("heap:25", 3), std::pair("heap:25", 40),
                                      std::pair("tower:9", 0), std::pair("tower:9", 5)}) {
    for (const double value : {kNan, kInfinity}) {
      SCOPED_TRACE(testing::Message() << value << " in " << scene << " after " << frames << " frames");
      Simulation moved = steppedScene(scene, frames);
      moved.state.position.values(1, 7)[3] = value;
      EXPECT_NE(messageOf(moved, 1).find("diverged at"), std::string::npos);
      Simulation hit = steppedScene(scene, frames);
      hit.state.velocity.values(2, 7)[3] = value;
      EXPECT_NE(messageOf(hit, 1).find("diverged at"), std::string::npos);
    }
  }
}

// The fastest that a scene may give, and a hundred times that, are motion.
TEST(Divergence, IsNotThatOfAFastBlock) {
  for (const double speed : {1e3, 1e5}) {
    Simulation simulation = steppedScene("heap:25", 3);
    setVelocity(24, speed, simulation);
    EXPECT_EQ(messageOf(simulation, 2), "none") << speed << " m/s";
  }
}

// A block of 39 kg on one of 20 g, a ten-thousandth of a millimetre deep at most: explicit steps would be millions a frame. They
// are refused by the block that is too light for what it carries, before anything has moved; implicit steps carry it.
TEST(StepLimit, OfAnExplicitMethodIsSaidBeforeTheFrame) {
  Scene scene = sceneNamed("tower:1");
  scene.blocks.resize(1);
  BlockSpec plate = scene.blocks.front();
  plate.centre[2] += plate.dimensions[2];
  plate.mass = 2000.0 * plate.mass;
  scene.blocks.push_back(plate);
  scene.settings.tolerance_m = 1e-7;
  scene.settings.method = Method::semiImplicitEuler;
  Simulation simulation(scene);
  prepare(simulation);
  const ParticleArray before = simulation.state.position;
  try {
    stepFrame(simulation);
    FAIL() << "expected an error, took " << simulation.substeps << " steps";
  } catch (const StepLimitError& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.block, 0);
    EXPECT_EQ(message.rfind("block 0 at 0.000000 s", 0), 0U) << message;
    EXPECT_NE(message.find("method semi-implicit-euler needs"), std::string::npos) << message;
    EXPECT_NE(message.find("allowed are 1e+06"), std::string::npos) << message;
  }
  for (std::size_t c = 0; c < kCorners; ++c) EXPECT_EQ(simulation.state.position.at(0, c), before.at(0, c));
  scene.settings.method = Method::implicit;
  Simulation carried(scene);
  prepareAndStep(carried);
  EXPECT_GT(centre(carried.state.position, 1)[2], centre(before, 1)[2] - 1e-5);
}

// Springs that only the weight of blocks had to bend less than a tolerance let a block that spins or hits fast turn itself inside
// out: these are stiff enough for the scene's speeds (stiffenForMotion).
TEST(Divergence, IsNotThatOfAFastBlockOfSprings) {
  struct Start {
    Vec3 velocity;
    Vec3 spin;
  };
  for (const Method method : {Method::semiImplicitEuler, Method::rungeKutta4}) {
    for (const Start& start : {Start{Vec3(0.0, 0.0, -20.0), Vec3::Zero()}, Start{Vec3(0.0, 0.0, -30.0), Vec3(0.0, 0.0, 300.0)},
                               Start{Vec3::Zero(), Vec3(0.0, 900.0, 0.0)}}) {
      SCOPED_TRACE(testing::Message() << nameOf(method) << ", " << start.velocity.transpose() << " m/s, "
                                      << start.spin.transpose() << " rad/s");
      Scene scene = sceneNamed("dropped-on-corner");
      scene.settings.method = method;
      scene.blocks[0].velocity = start.velocity;
      scene.blocks[0].spin = start.spin;
      Simulation simulation(scene);
      prepare(simulation);
      EXPECT_EQ(messageOf(simulation, 12), "none");
    }
  }
}

// The limit of strain (limitStrain) takes back what such springs are strained by more, but not a step that strains softer ones by
// half the thickness of a plate: of 216 plates and planks, thrown at 5 to 150 m/s, 54 diverged with the springs of their weight.
TEST(Divergence, IsNotThatOfAPlateThrownAtTheFloor) {
  for (const Method method : {Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4}) {
    for (const double thickness_m : {0.0003, 0.001}) {
      SCOPED_TRACE(testing::Message() << nameOf(method) << ", " << thickness_m << " m");
      Scene scene = sceneNamed("dropped-on-corner");
      scene.settings.method = method;
      scene.settings.tolerance_m = 0.01 * thickness_m;
      scene.blocks[0].dimensions = Vec3(0.1, 0.06, thickness_m);
      scene.blocks[0].mass = 600.0 * scene.blocks[0].dimensions.prod();
      scene.blocks[0].centre = Vec3(0.0, 0.0, 0.075);
      scene.blocks[0].velocity = Vec3(-1.7, -11.0, -50.0);
      scene.blocks[0].spin = Vec3(-220.0, 0.0, -720.0);
      Simulation simulation(scene);
      prepare(simulation);
      EXPECT_EQ(messageOf(simulation, 6), "none");
    }
  }
}

}  // namespace
}  // namespace springtower
