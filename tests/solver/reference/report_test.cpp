#include "core/error.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/solver/reference/report_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

// Properties that the 2003 report states for its method. Its known errors are in report_failures_test.cpp.

// A block that falls flat from a height, one step a frame.
Scene blockThatFalls(double height, double restitution) {
  Scene scene = asReported(oneBlockScene(true));
  scene.blocks[0].centre.z() += height;
  scene.settings.frame_s = 1e-4;
  scene.settings.reportRestitution = restitution;
  return withSubsteps(scene, 1);
}

Scene twoThrownBlocks(Inertia inertia) {
  Scene scene = asReported(oneBlockScene(false), inertia);
  scene.blocks[0].centre = Vec3(-0.06, 0.0, 0.0);
  scene.blocks[0].velocity = Vec3(5.0, 0.0, 0.0);
  scene.blocks.push_back(scene.blocks[0]);
  scene.blocks[1].centre = Vec3(0.06, 0.004, 0.003);
  scene.blocks[1].orientation = Eigen::AngleAxisd(0.5, Vec3(1.0, 2.0, 3.0).normalized());
  scene.blocks[1].velocity = Vec3(-5.0, 0.0, 0.0);
  scene.blocks[1].mass *= 1.5;
  return scene;
}

double largestImpulse(const Simulation& simulation) {
  double largest = 0.0;
  for (const auto& contacts : simulation.engine->report.contacts) {
    for (const ReportContact& contact : contacts) largest = std::max(largest, contact.impulse);
  }
  return largest;
}

double leastImpulse(const Simulation& simulation) {
  double least = 1e300;
  for (const auto& contacts : simulation.engine->report.contacts) {
    for (const ReportContact& contact : contacts) least = std::min(least, contact.impulse);
  }
  return least;
}

struct ReportRestitutionTest : ::testing::TestWithParam<double> {};

// Eq. 2.11 holds for what collides: a corner. Until the floor is met the springs are at rest, so each corner falls alone.
TEST_P(ReportRestitutionTest, EachCornerLeavesTheFloorWithItsShareOfSpeed) {
  const double restitution = GetParam();
  Simulation simulation(blockThatFalls(0.02, restitution));
  double before = 0.0;
  int frame = 0;
  for (; frame < 1000 && largestImpulse(simulation) == 0.0; ++frame) {
    before = simulation.state.velocity.at(0, 0).z();
    prepareAndStep(simulation);
  }
  ASSERT_LT(frame, 1000) << "it never met the floor";
  const double meeting = before - kStandardGravity_m_s2 * simulation.scene.settings.frame_s;
  EXPECT_NEAR(meeting, -std::sqrt(2.0 * kStandardGravity_m_s2 * 0.02), 2e-3);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const bool bottom = cornerSide(c, 2) < 0.0;
    const double expected = bottom ? -restitution * meeting : meeting;
    EXPECT_NEAR(simulation.state.velocity.at(0, c).z(), expected, 1e-9) << "corner " << c;
  }
}

INSTANTIATE_TEST_SUITE_P(Method, ReportRestitutionTest, ::testing::Values(0.0, 0.1, 0.5, 1.0));

// The rebound of a whole block is different. Along the vertical it is two masses on a spring. With e = 0 the lower mass stays on
// the floor until the spring has reversed the upper one, which then lifts it: half the speed is returned, whatever the value of
// e. With e = 1 all of it is. Both up to the dissipation of the springs' dashpots and the block's lateral modes.
TEST(ReportMethod, ABlockReboundsThroughItsSpringsWhateverTheRestitution) {
  const auto rebound = [](double restitution) {
    Scene scene = blockThatFalls(0.02, restitution);
    Simulation simulation(scene);
    double falling = 0.0;
    double rising = 0.0;
    for (int frame = 0; frame < 1500; ++frame) {
      prepareAndStep(simulation);
      const double speed = centre(simulation.state.velocity, 0).z();
      falling = std::max(falling, -speed);
      rising = std::max(rising, speed);
    }
    return rising / falling;
  };
  const double plastic = rebound(0.0);
  EXPECT_GT(plastic, 0.35);
  EXPECT_LT(plastic, 0.5);
  EXPECT_NEAR(rebound(0.1), plastic, 0.05);
  const double elastic = rebound(1.0);
  EXPECT_GT(elastic, 0.8);
  EXPECT_LT(elastic, 1.0);
}

struct ReportInertiaTest : ::testing::TestWithParam<Inertia> {};

// Impulses, friction and springs act in pairs; gravity is off.
TEST_P(ReportInertiaTest, ACollisionKeepsMomentum) {
  Scene scene = twoThrownBlocks(GetParam());
  scene.settings.tolerance_m = 2e-5;
  Simulation simulation(scene);
  simulation.scene.gravity.magnitude = 0.0;  // the springs' stiffness was chosen for the usual one
  const Vec3 before = momentum(simulation).linear;
  const double part = scene.blocks[0].mass * 5.0;
  double least = 1e300;
  for (int frame = 0; frame < 12; ++frame) {
    prepareAndStep(simulation);
    least = std::min(least, leastImpulse(simulation));
    EXPECT_LT((momentum(simulation).linear - before).norm(), 1e-12 * part) << "frame " << frame;
  }
  EXPECT_GT(simulation.counters.cubicHits, 0u);
  EXPECT_GT(least, 0.0) << "an impulse pulled";
  EXPECT_LT(centre(simulation.state.velocity, 0).x(), 0.0) << "they went through each other";
  EXPECT_GT(centre(simulation.state.velocity, 1).x(), centre(simulation.state.velocity, 0).x());
}

// With e = 1 and no other dissipation, the impulses conserve energy, for any weights.
TEST_P(ReportInertiaTest, AnElasticCollisionKeepsEnergy) {
  Scene scene = twoThrownBlocks(GetParam());
  scene.settings.reportRestitution = 1.0;
  scene.settings.reportFrictionDrag = 0.0;
  scene.settings.stiffnessDamping = 0.0;
  scene.kineticFriction = scene.staticFriction = 0.0;
  Simulation simulation(withSubsteps(scene, 1000));
  simulation.scene.gravity.magnitude = 0.0;
  const double before = energy(simulation).total();
  double kinetic = 1e300;
  for (int frame = 0; frame < 6; ++frame) {
    prepareAndStep(simulation);
    const Energy now = energy(simulation);
    kinetic = std::min(kinetic, now.kinetic);
    EXPECT_NEAR(now.total(), before, 0.03 * before);
  }
  EXPECT_GT(simulation.counters.cubicHits, 0u);
  EXPECT_LT(kinetic, 0.95 * before) << "nothing went into the springs";
}

// Blocks that touch and separate are not affected: an impulse never pulls.
TEST_P(ReportInertiaTest, TouchingBlocksDrawApartFreely) {
  Scene scene = asReported(oneBlockScene(false), GetParam());
  scene.blocks[0].centre.setZero();
  scene.blocks.push_back(scene.blocks[0]);
  scene.blocks[1].centre.z() = kBlockHeight_m;
  scene.blocks[1].velocity = Vec3(0.0, 0.0, 0.1);
  Simulation simulation(scene);
  for (int frame = 0; frame < 10; ++frame) {
    prepareAndStep(simulation);
    EXPECT_EQ(largestImpulse(simulation), 0.0);
  }
  const Vec3 apart = centre(simulation.state.velocity, 1) - centre(simulation.state.velocity, 0);
  EXPECT_NEAR(apart.z(), 0.1, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Method, ReportInertiaTest, ::testing::Values(Inertia::lumped, Inertia::cuboid));

// A corner that lies below the floor and rises is not held back.
TEST(ReportMethod, TheFloorNeverPulls) {
  Scene scene = blockThatFalls(0.0, 0.1);
  scene.blocks[0].velocity.z() = 0.1;
  Simulation simulation(scene);
  for (std::size_t c = 0; c < kCorners; ++c) simulation.state.position.add(0, c, Vec3(0.0, 0.0, -0.005));
  prepareAndStep(simulation);
  EXPECT_EQ(largestImpulse(simulation), 0.0);
  EXPECT_NEAR(centre(simulation.state.velocity, 0).z(), 0.1 - kStandardGravity_m_s2 * scene.settings.frame_s, 1e-12);
}

// Dynamic friction alone, with the drag off, slows a sliding block by mu g. The normal forces of single steps are those of
// bounces, but their mean is the weight.
TEST(ReportMethod, DynamicFrictionSlowsASlidingBlock) {
  Scene scene = withSubsteps(asReported(oneBlockScene(true)), 200);
  scene.settings.reportFrictionDrag = 0.0;
  scene.blocks[0].velocity = Vec3(2.0, 0.0, 0.0);
  Simulation simulation(scene);
  stepFor(simulation, 0.1);
  const double before = centre(simulation.state.velocity, 0).x();
  stepFor(simulation, 0.3);
  const double deceleration = (before - centre(simulation.state.velocity, 0).x()) / 0.3;
  EXPECT_NEAR(deceleration, scene.kineticFriction * kStandardGravity_m_s2, 0.05 * deceleration);
  scene.settings.reportFrictionDrag = 5.0;
  Simulation dragged(scene);
  stepFor(dragged, 0.4);
  EXPECT_LT(centre(dragged.state.velocity, 0).x(), centre(simulation.state.velocity, 0).x());
}

// One pass resolves each collision once; the remaining ones stay embedded. More passes leave fewer. The counts of the report's
// Table 5.2 decrease from stage to stage.
TEST(ReportMethod, PassesAreCountedAndBounded) {
  const auto runTower = [](int passes) {
    Scene scene = asReported(towerScene(3));
    scene.settings.reportIterations = passes;
    Simulation simulation(scene);
    for (int frame = 0; frame < 6; ++frame) prepareAndStep(simulation);
    return simulation.counters;
  };
  const Counters one = runTower(1);
  EXPECT_EQ(one.responseIterations, one.steps);
  const Counters three = runTower(3);
  EXPECT_GT(three.responseIterations, three.steps);
  EXPECT_LE(three.responseIterations, 3 * three.steps);
  EXPECT_GT(three.candidateTests, three.boxOverlaps);
  EXPECT_GT(three.boxOverlaps, three.planeCrossings);
  EXPECT_GE(three.planeCrossings, three.cubicTests);
  EXPECT_GT(three.cubicTests, three.cubicHits);
  EXPECT_GT(three.cubicHits, 0u);
  EXPECT_EQ(three.contactsCreated, 0u) << "it has no lasting contacts";
}

// Four towers and a block that falls on one of them: islands that split and join.
Scene scatteredScene() {
  const Scene tower = towerScene(2);
  Scene scene = asReported(tower);
  scene.blocks.clear();
  for (int place = 0; place < 4; ++place) {
    for (BlockSpec block : tower.blocks) {
      block.centre.x() += 0.15 * place;
      scene.blocks.push_back(block);
    }
  }
  scene.blocks.push_back(tower.blocks[0]);
  scene.blocks.back().centre.z() = 0.08;
  scene.blocks.back().velocity.x() = 0.5;
  scene.settings.sleep = Sleep::report;
  return scene;
}

TEST(ReportMethod, IsTheSameForAnyNumberOfThreads) {
  const auto hashAfter = [](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    return arena.execute([] {
      Simulation simulation(scatteredScene());
      for (int frame = 0; frame < 20; ++frame) prepareAndStep(simulation);
      return stateHash(simulation);
    });
  };
  const std::uint64_t one = hashAfter(1);
  EXPECT_EQ(hashAfter(1), one) << "twice in one process";
  EXPECT_EQ(hashAfter(2), one);
  EXPECT_EQ(hashAfter(4), one);
}

TEST(ReportMethod, RepeatsItsFutureFromASnapshot) {
  Simulation simulation(scatteredScene());
  for (int frame = 0; frame < 10; ++frame) prepareAndStep(simulation);
  ASSERT_GT(largestImpulse(simulation), 0.0);
  const auto snapshot = takeSnapshot(simulation);
  const std::uint64_t now = stateHash(simulation);
  for (auto& contacts : simulation.engine->report.contacts) contacts.clear();
  EXPECT_NE(stateHash(simulation), now) << "the contacts are part of the state";
  restoreSnapshot(simulation, *snapshot);
  EXPECT_EQ(stateHash(simulation), now);
  for (int frame = 0; frame < 10; ++frame) prepareAndStep(simulation);
  const std::uint64_t future = stateHash(simulation);
  restoreSnapshot(simulation, *snapshot);
  EXPECT_NE(stateHash(simulation), future);
  for (int frame = 0; frame < 10; ++frame) prepareAndStep(simulation);
  EXPECT_EQ(stateHash(simulation), future);
}

// Far beyond the stability limit the springs burst, which is detected in the same step.
TEST(ReportMethod, DivergenceIsCaught) {
  Scene scene = withSubsteps(asReported(towerScene(2)), 4);
  scene.settings.tolerance_m = 1e-6;
  scene.settings.allowUnstable = true;
  Simulation simulation(scene);
  EXPECT_THROW(stepFor(simulation, 1.0), DivergenceError);
}

}  // namespace
}  // namespace springtower
