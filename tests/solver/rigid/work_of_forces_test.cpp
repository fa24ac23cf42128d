// Bounds of energy in rigid steps allow for the work of forces and of the hand.
#include "core/scene/scene.h"
#include "solver/metrics/measures.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/method_names.h"
#include "tests/support/prepare_and_step.h"

#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// In space.
Scene emptyScene(double restitution) {
  Scene scene;
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  scene.settings.sleep = Sleep::off;
  scene.restitution = restitution;
  return scene;
}

// A block that slides on another without friction while a force presses it on keeps its speed along the face: of what the force
// adds to their energy, 2.4 mJ in a substep at 3 m/s, nothing is taken from the 0.2 mJ with which they move against each other.
// In one frame, before the force tips the block over that lies ahead.
TEST(WorkOfForces, IsNotTakenFromWhatSlides) {
  Scene scene = emptyScene(0.0);
  scene.staticFriction = scene.kineticFriction = 0.0;
  scene.blocks.resize(2);
  for (std::size_t b = 0; b < 2; ++b) {
    scene.blocks[b].centre.z() = (0.5 + static_cast<double>(b)) * kBlockHeight_m;
    scene.blocks[b].velocity = Vec3(b == 1 ? 0.2 : 0.0, 0.0, -3.0);
  }
  scene.forces.push_back(constantForce(1, -1, Vec3(0.0, 0.0, -1.0), 0.0, 0.1));
  Simulation simulation(scene);
  prepareAndStep(simulation);
  const Vec3 relative = centre(simulation.state.velocity, 1) - centre(simulation.state.velocity, 0);
  EXPECT_NEAR(relative.x(), 0.2, 0.01 * 0.2);
  EXPECT_EQ(simulation.counters.implicitSteps, 0U) << "it is about rigid steps";
}

class WorkOfForcesIn : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Methods, WorkOfForcesIn,
                         ::testing::Values(Method::implicit, Method::rigidPgs, Method::rigidLcp, Method::xpbd), methodName);

// A small block meets a plank that a force drives on, 50 N on 1 kg, and parts from it as fast as it came: of the force's work,
// 0.2 J in a substep, nothing is taken from the rebound. The gap of 10 mm closes at 1 m/s + 50 m/s2 t until t = (sqrt(2) - 1) /
// 50 s, at sqrt(2) m/s, and until the frame ends the plank gains on the block again: 0.995 m/s are left, less what the force adds
// in the step of the impact.
TEST_P(WorkOfForcesIn, ARebound) {
  Scene scene = emptyScene(1.0);
  scene.settings.method = GetParam();
  scene.blocks.resize(2);
  scene.blocks[0].dimensions = {0.2, 0.2, 0.02};
  scene.blocks[0].mass = 1.0;
  scene.blocks[0].velocity.z() = 5.0;
  scene.blocks[1].dimensions = {0.02, 0.02, 0.02};
  scene.blocks[1].mass = 1e-6;
  scene.blocks[1].centre.z() = 0.02 + 0.01;
  scene.blocks[1].velocity.z() = 4.0;
  scene.forces.push_back(constantForce(0, -1, Vec3(0.0, 0.0, 50.0), 0.0, 1.0));
  Simulation simulation(scene);
  prepareAndStep(simulation);
  const double relative = centre(simulation.state.velocity, 1).z() - centre(simulation.state.velocity, 0).z();
  const double longestStep_s = scene.settings.frame_s / 4.0;
  const double met_s = (std::sqrt(2.0) - 1.0) / 50.0;
  const double left = std::sqrt(2.0) - 50.0 * (scene.settings.frame_s - met_s);
  EXPECT_NEAR(relative, left, 50.0 * longestStep_s);
}

}  // namespace
}  // namespace springtower
