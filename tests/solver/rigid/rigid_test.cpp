#include "core/scene/scene.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/runner/run.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <string>

namespace springtower {
namespace {

constexpr double kFriction = 0.4;

// Properties of every rigid method.
struct RigidMethod : ::testing::TestWithParam<Method> {
  static Scene flying() {
    Scene scene = oneBlockScene(false);
    scene.settings.method = GetParam();
    return scene;
  }
  static Scene standing() {
    Scene scene = oneBlockScene(true);
    scene.settings.method = GetParam();
    return scene;
  }
  static Scene tower(int rows) {
    Scene scene = towerScene(rows);
    scene.settings.method = GetParam();
    scene.settings.sleep = Sleep::off;
    if (GetParam() == Method::rigidLcp) scene.settings.substeps = 1;  // it is exact in each step, and slow
    return scene;
  }
};

std::string nameOfTest(const ::testing::TestParamInfo<Method>& test) {
  std::string name(nameOf(test.param));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Methods, RigidMethod, ::testing::Values(Method::rigidPgs, Method::rigidLcp, Method::xpbd), nameOfTest);

// In free flight a block moves by its mean velocity in a step: after any number of steps it has fallen g t^2 / 2, within
// rounding.
TEST_P(RigidMethod, FallsFreely) {
  Scene scene = flying();
  scene.settings.substeps = 10;
  Simulation simulation(scene);
  const double start = centre(simulation.state.position, 0).z();
  stepFor(simulation, 0.5);
  const double drop = start - centre(simulation.state.position, 0).z();
  EXPECT_NEAR(drop, 0.5 * kStandardGravity_m_s2 * 0.5 * 0.5, 1e-12);
  EXPECT_NEAR(centre(simulation.state.velocity, 0).z(), -kStandardGravity_m_s2 * 0.5, 1e-12);
}

// A block that spins about the axis of middle moment tumbles. Angular momentum is conserved to rounding; the energy to second
// order in the step.
TEST_P(RigidMethod, TumblesWithItsAngularMomentum) {
  Scene scene = flying();
  scene.gravity.magnitude = 0.0;
  scene.blocks[0].spin = Vec3(0.05, 10.0, 0.02);
  scene.settings.substeps = 20;
  Simulation simulation(scene);
  const Vec3 before = momentum(simulation).angular;
  const double energyBefore = energy(simulation).kinetic;
  stepFor(simulation, 2.0);
  EXPECT_LT((momentum(simulation).angular - before).norm(), 1e-9 * before.norm());
  EXPECT_NEAR(energy(simulation).kinetic, energyBefore, 1e-4 * energyBefore);
  EXPECT_GT(std::abs(meanEdge(simulation.state.position, 0, 1).normalized().dot(Vec3::UnitY()) - 1.0), 1e-3)
      << "it did not tumble";
}

TEST_P(RigidMethod, DoesNotDeform) {
  Scene scene = tower(2);
  scene.gravity.tilt_deg = 30.0;
  Simulation simulation(scene);
  stepFor(simulation, 0.5);
  EXPECT_LT(maxStrain(simulation.model, simulation.state.position), 1e-12);
}

TEST_P(RigidMethod, SticksBelowTheFrictionAngle) {
  Scene scene = standing();
  scene.gravity.tilt_deg = degrees(std::atan(kFriction)) - 1.0;
  scene.gravity.direction_deg = 30.0;
  Simulation simulation(scene);
  stepFor(simulation, 0.2);
  const ParticleArray then = simulation.state.position;
  stepFor(simulation, 1.0);
  EXPECT_LT(largestCornerMove(then, simulation.state.position), 1e-5);
}

// Above it the block slides with g (sin a - mu cos a).
TEST_P(RigidMethod, SlidesAboveTheFrictionAngle) {
  Scene scene = standing();
  const double angle = std::atan(kFriction) + 0.1;
  scene.gravity.tilt_deg = degrees(angle);
  Simulation simulation(scene);
  stepFor(simulation, 0.2);
  const double then = centre(simulation.state.velocity, 0).x();
  stepFor(simulation, 0.5);
  const double expected = kStandardGravity_m_s2 * (std::sin(angle) - kFriction * std::cos(angle));
  EXPECT_NEAR((centre(simulation.state.velocity, 0).x() - then) / 0.5, expected, 0.02 * expected);
}

// A block that reaches the floor stops at its surface: the step is repeated with the contacts found in it.
TEST_P(RigidMethod, StopsAtTheFloor) {
  Scene scene = standing();
  scene.blocks[0].centre.z() += 0.02;
  Simulation simulation(scene);
  RunOptions options;
  options.seconds = 1.0;
  const RunResult result = runScene(simulation, options);
  EXPECT_LT(result.deepest.depth, 1e-5);
  EXPECT_LT(*result.maxEnergyRise, 1e-3);
  EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U);
  EXPECT_NEAR(centre(simulation.state.position, 0).z(), 0.5 * kBlockHeight_m, 1e-5);
}

TEST_P(RigidMethod, ASmallTowerStands) {
  Simulation simulation(tower(3));
  RunOptions options;
  options.seconds = 2.0;
  const RunResult result = runScene(simulation, options);
  EXPECT_TRUE(result.standing.stands) << describe(result.standing);
  EXPECT_LT(result.deepest.depth, 5e-5);
  EXPECT_LT(result.jitter_m_s, 1e-3);
}

// The contact forces that a rigid method stores balance the weight of the blocks on them.
TEST_P(RigidMethod, FloorCarriesTheWeight) {
  Simulation simulation(tower(2));
  stepFor(simulation, 1.0);
  double carried = 0.0;
  for (const ContactForce& contact : contactForces(simulation)) {
    if (contact.lower == kFloor) carried += contact.normalForce * contact.normal.z() + contact.frictionForce.z();
  }
  const double weight = 6.0 * kBlockMass_kg * kStandardGravity_m_s2;
  EXPECT_NEAR(carried, weight, 0.01 * weight);
}

// Put to sleep, the tower wakes and falls when the blocks below are pushed out.
TEST_P(RigidMethod, ASleepingTowerWakesWhenItLosesItsSupport) {
  Scene scene = bitCodeScene("(010)-(010)");
  scene.settings.method = GetParam();
  scene.forces.push_back(constantForce(0, -1, Vec3(0.0, 3.0, 0.0), 3.0, 3.2));
  Simulation simulation(scene);
  stepFor(simulation, 2.9);
  ASSERT_EQ(std::count(simulation.asleep.begin(), simulation.asleep.end(), std::uint8_t{1}), 2);
  stepFor(simulation, 2.0);
  EXPECT_LT(centre(simulation.state.position, 1).z(), 1.2 * kBlockHeight_m);
}

std::uint64_t hashAfter(const Scene& scene, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute([&] {
    Simulation simulation(scene);
    stepFor(simulation, 0.25);
    return stateHash(simulation);
  });
}

// Four leaning stacks, separate islands, that slide apart.
TEST_P(RigidMethod, IsTheSameOnAnyThreads) {
  Scene scene = tower(2);
  const std::vector<BlockSpec> one = scene.blocks;
  for (int i = 1; i < 4; ++i) {
    for (BlockSpec block : one) {
      block.centre.x() += 0.3 * i;
      scene.blocks.push_back(block);
    }
  }
  scene.gravity.tilt_deg = 24.0;
  const std::uint64_t hash = hashAfter(scene, 1);
  EXPECT_EQ(hashAfter(scene, 1), hash);
  EXPECT_EQ(hashAfter(scene, 2), hash);
  EXPECT_EQ(hashAfter(scene, 4), hash);
}

// A column of blocks that just touch, coming down together at this speed, m/s, in steps of 1 ms.
constexpr double kColumnSpeed_m_s = 0.5;
Scene columnComingDown(Method method, int rows, int passes) {
  std::string code = "(010)";
  for (int row = 1; row < rows; ++row) code += "-(010)";
  Scene scene = bitCodeScene(code);
  setSteps(scene.settings, method, 1e-3, 1);
  scene.settings.sleep = Sleep::off;
  scene.settings.iterations = passes;
  scene.restitution = 0.0;
  for (BlockSpec& block : scene.blocks) block.velocity.z() = -kColumnSpeed_m_s;
  return scene;
}

// Largest speed at which blocks of a column still approach one another after the step in which it landed, m/s.
double approachLeft(Method method, int rows, int passes) {
  Simulation simulation(columnComingDown(method, rows, passes));
  prepareAndStep(simulation);
  double fastest = 0.0;
  double below = 0.0;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) {
    const double own = centre(simulation.state.velocity, b).z();
    fastest = std::max(fastest, below - own);
    below = own;
  }
  return fastest;
}

// Largest penetration in a column over the following 50 ms, m.
double deepestInColumn(Method method, int rows, int passes) {
  Simulation simulation(columnComingDown(method, rows, passes));
  PenetrationWorkspace workspace;
  double deepest = 0.0;
  for (int step = 0; step < 50; ++step) {
    prepareAndStep(simulation);
    deepest = std::max(deepest, maxPenetration(simulation.state.position, true, workspace).depth);
  }
  return deepest;
}

// A step in which blocks make contact is repeated from its start: clearances measured at the end of the first attempt must not be
// used in the second. Blocks that pass one another undetected would be found inside each other later.
TEST(RigidSteps, TakenAgainMissNoContact) {
  for (const Method method : {Method::rigidPgs, Method::xpbd}) {
    Scene scene = towerScene(12);
    scene.gravity.tilt_deg = 20.0;
    scene.settings.method = method;
    scene.settings.substeps = 32;
    Simulation simulation(scene);
    RunOptions options;
    options.seconds = 1.5;
    const RunResult result = runScene(simulation, options);
    EXPECT_GT(result.counters.contactsCreated, 300U) << nameOf(method);
    EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U) << nameOf(method);
  }
}

// A block that lands in the last of a frame's four steps has moved by that step once, however often it is repeated, and its
// manifold, created at the end of the first attempt, is that of the final position.
TEST(RigidSteps, TakenAgainAreGoneOnce) {
  constexpr double kSpeed_m_s = 1e-3;  // too slow for a manifold to be refreshed by travel
  Scene scene;
  BlockSpec block;
  block.centre.z() = 0.5 * block.dimensions.z() + 0.9 * kSpeed_m_s * scene.settings.frame_s;
  block.velocity.z() = -kSpeed_m_s;
  scene.blocks = {block};
  scene.gravity.magnitude = 0.0;
  scene.settings.method = Method::rigidPgs;
  scene.settings.substeps = 4;
  scene.settings.iterations = 1000;
  Simulation simulation(scene);
  const double start = centre(simulation.state.position, 0).z();
  prepareAndStep(simulation);
  ASSERT_EQ(simulation.counters.contactsCreated, 1U);
  const double way = start - centre(simulation.state.position, 0).z();
  EXPECT_NEAR(simulation.engine->memo.blockHistory[0].travel, way, 1e-9);
  EXPECT_EQ(simulation.counters.manifoldRefreshes, 1U);
}

// Report Figure 3.3: "by resolving one pair, another pair of embedded objects can occur", and by resolving that the first again.
// One pass over a column would leave some pairs at half the speed at which it comes down; so an impact is passed through until
// its speeds change by no more than a hundredth, or all pairs are solved at once (`rigid-lcp`).
TEST(RigidImpact, IsResolvedThroughAColumn) {
  for (const int passes : {1, 10}) EXPECT_LT(approachLeft(Method::rigidPgs, 8, passes), 0.02 * kColumnSpeed_m_s);
  EXPECT_LT(approachLeft(Method::rigidPgs, 8, 1000), 1e-3 * kColumnSpeed_m_s);
  EXPECT_LT(approachLeft(Method::rigidLcp, 8, 1), 1e-3 * kColumnSpeed_m_s);
}

// Approach left by a few passes embeds the blocks. A method that solves for all contact forces together has no passes.
TEST(RigidFailure, FewPassesLeaveBlocksEmbedded) {
  const double few = deepestInColumn(Method::rigidPgs, 24, 1);
  EXPECT_GT(few, 5e-4);
  EXPECT_GT(deepestInColumn(Method::rigidPgs, 24, 10), 0.1 * few);
  EXPECT_LT(deepestInColumn(Method::rigidPgs, 24, 1000), 0.25 * few);
  EXPECT_LT(deepestInColumn(Method::implicit, 24, 1), 0.25 * few) << "the default method, in as many steps";
}

}  // namespace
}  // namespace springtower
