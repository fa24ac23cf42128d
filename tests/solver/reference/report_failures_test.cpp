#include "solver/metrics/measures.h"
#include "solver/sleep/rest.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/solver/reference/report_scenes.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

// Method `report` is a baseline: these tests document its known errors, and its disabling test.

// No static friction (report 5.7.2): far below the angle of friction, 21.8 degrees, a block creeps down.
TEST(ReportFailure, ABlockCreepsDownASlope) {
  Scene scene = oneBlockScene(true);
  scene.gravity.tilt_deg = 10.0;
  const auto moved = [](const Scene& slope) {
    Simulation simulation(slope);
    stepFor(simulation, 0.5);
    const ParticleArray settled = simulation.state.position;
    stepFor(simulation, 2.0);
    return largestCornerMove(settled, simulation.state.position);
  };
  const double reported = moved(asReported(scene));
  EXPECT_GT(reported, 1e-3);
  EXPECT_LT(reported, 0.1) << "without friction it would have slid by more than 4 m";
  EXPECT_LT(moved(scene), 1e-6) << "the default method";
}

// "It is the jitter that is effectively acting as the block's resting contact" (report 6.2.2). The tower stands, but walks.
TEST(ReportFailure, ATowerJittersAndCreeps) {
  struct Motion {
    double jitter = 0.0;
    double creep = 0.0;
    bool stands = false;
  };
  const auto motionOf = [](const Scene& scene) {
    Simulation simulation(scene);
    const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
    stepFor(simulation, 1.5);
    const ParticleArray settled = simulation.state.position;
    Motion motion;
    for (int frame = 0; frame < 30; ++frame) {
      prepareAndStep(simulation);
      const double speed = rootMeanSquareCornerSpeed(simulation.state.velocity);
      motion.jitter += speed * speed / 30.0;
    }
    motion.jitter = std::sqrt(motion.jitter);
    motion.creep = largestCornerMove(settled, simulation.state.position);
    motion.stands = standing(simulation.model, start, simulation.state.position).stands;
    return motion;
  };
  Scene tower = towerScene(6);
  const Motion reported = motionOf(asReported(tower));
  EXPECT_TRUE(reported.stands);
  EXPECT_GT(reported.jitter, 4e-3);
  EXPECT_GT(reported.creep, 2e-4);
  tower.settings.sleep = Sleep::off;
  const Motion ours = motionOf(tower);
  EXPECT_TRUE(ours.stands);
  EXPECT_LT(ours.jitter, 1e-3);
  EXPECT_LT(ours.creep, 5e-5);
}

// Figure 6.8b: (010)-(010)-(011)-(010)-(001) presses on one side. Without static friction "the lone middle block" of row 2 is
// "forced out slowly leading to the collapse of the tower". Here all rows drift with it, the higher the farther, until the tower
// falls after some 6 s (5 to 8 s for starts up to 0.1 mm higher) and that block is pushed out sideways. With static friction
// nothing moves after settling.
TEST(ReportFailure, ALoneMiddleBlockIsForcedOut) {
  struct Fate {
    double walked_m = 0.0;   // of the lone middle block, in the first seconds
    double ended_m = 0.0;    // and at the end
    double dropped_m = 0.0;  // of the top block at the end
  };
  const auto fateOf = [](const Scene& scene) {
    Simulation simulation(scene);
    stepFor(simulation, 1.0);
    const Vec3 settled = centre(simulation.state.position, 1);
    const double top = centre(simulation.state.position, 5).z();
    stepFor(simulation, 3.0);
    Fate fate;
    fate.walked_m = (centre(simulation.state.position, 1) - settled).norm();
    stepFor(simulation, 8.0);
    fate.ended_m = (centre(simulation.state.position, 1) - settled).norm();
    fate.dropped_m = top - centre(simulation.state.position, 5).z();
    return fate;
  };
  Scene tower = bitCodeScene("(010)-(010)-(011)-(010)-(001)");
  tower.settings.sleep = Sleep::off;
  const Fate reported = fateOf(asReported(tower));
  EXPECT_GT(reported.walked_m, 1e-3);
  EXPECT_GT(reported.ended_m, 0.4 * kBlockWidth_m);
  EXPECT_GT(reported.dropped_m, 2.0 * kBlockHeight_m) << "the tower has collapsed";
  const Fate ours = fateOf(tower);
  EXPECT_LT(ours.ended_m, 1e-6);
  EXPECT_LT(std::abs(ours.dropped_m), 1e-6);
}

// Figure 6.21: springs that are stable with a frame's few steps are soft, and a full tower is squashed. Stiffness must not
// require more steps.
TEST(ReportFailure, SoftSpringsSquashAFullTower) {
  const auto compression = [](Method method, int steps) {
    Scene scene = towerScene(18);
    scene.settings.sleep = Sleep::off;
    scene.settings.method = method;
    scene.settings.substeps = steps;
    if (method == Method::implicit) scene.settings.tolerance_m = toleranceOf(scene);
    Simulation simulation(scene);
    stepFor(simulation, 2.0);
    double lost = 0.0;
    for (std::size_t b = 0; b < 3; ++b)
      lost += (scene.blocks[b].dimensions.z() - meanEdge(simulation.state.position, b, 2).norm()) / 3.0;
    return lost;
  };
  const double soft = compression(Method::semiImplicitEuler, 30);
  EXPECT_GT(soft, 3e-4);
  EXPECT_LT(compression(Method::implicit, 4), 0.1 * soft) << "with a seventh of the steps";
}

// "All collisions are guaranteed to be solved within just a couple of iterations" (report 6.2.2 and its abstract). They are in
// most steps, but not in all: when some towers of four to eight rows are released (which ones is a matter of rounding), all steps
// of a frame take more than ten passes each. The default method does not resolve collisions one by one: all contact forces of an
// island are in one system of equations, which is solved a couple of times in every step here.
TEST(ReportFailure, CollisionsTakeMoreThanACoupleOfIterations) {
  double most = 0.0;
  for (const int rows : {4, 5, 6, 8}) {
    Scene scene = towerScene(rows);
    scene.settings.sleep = Sleep::off;
    Scene passes = asReported(scene);
    passes.settings.reportIterations = 1000;
    Simulation reported(passes);
    Simulation ours(scene);
    double mostOfOurs = 0.0;
    for (int frame = 0; frame < 60; ++frame) {
      const Counters before = reported.counters;
      prepareAndStep(reported);
      most = std::max(most, static_cast<double>(reported.counters.responseIterations - before.responseIterations) /
                                static_cast<double>(reported.counters.steps - before.steps));
      const Counters ourBefore = ours.counters;
      prepareAndStep(ours);
      ASSERT_GT(ours.counters.implicitSteps, ourBefore.implicitSteps);
      mostOfOurs = std::max(mostOfOurs, static_cast<double>(ours.counters.implicitIterations - ourBefore.implicitIterations) /
                                            static_cast<double>(ours.counters.implicitSteps - ourBefore.implicitSteps));
    }
    EXPECT_LT(mostOfOurs, 3.0);
    EXPECT_EQ(ours.counters.newtonFailures, 0U) << "a step that did not converge";
  }
  EXPECT_GT(most, 10.0);
}

// Largest horizontal displacement of the blocks of the top row, m.
double topRowMoves(Simulation& simulation, std::size_t first, double seconds) {
  std::array<Vec3, 3> start;
  for (std::size_t i = 0; i < 3; ++i) start[i] = centre(simulation.state.position, first + i);
  stepFor(simulation, seconds);
  double farthest = 0.0;
  for (std::size_t i = 0; i < 3; ++i)
    farthest = std::max(farthest, (centre(simulation.state.position, first + i) - start[i]).head<2>().norm());
  return farthest;
}

// Step 11: a loose block drawn out of row 5 at some 40 cm/s; a block of the top row "moves slightly, unrealistic".
TEST(ReportFailure, TheTopRowMovesWhenALooseBlockIsDrawnOut) {
  Scene scene = bitCodeScene("(111)-(111)-(111)-(111)-(L11)-(111)-(111)-(111)");
  scene.settings.sleep = Sleep::off;
  const std::size_t loose = 12;
  const Vec3 along = scene.blocks[loose].orientation * Vec3::UnitX();
  UserForce& force = scene.forces.emplace_back();
  force.block = static_cast<std::int32_t>(loose);
  force.force = 0.156 * along;
  force.start_s = 0.2;
  force.end_s = 0.45;
  Simulation reported(asReported(scene));
  EXPECT_GT(topRowMoves(reported, 21, 0.8), 3e-4);
  Simulation ours(scene);
  EXPECT_LT(topRowMoves(ours, 21, 0.8), 1e-4) << "the report's real tower did not move";
  EXPECT_GT((centre(ours.state.position, loose) - scene.blocks[loose].centre).norm(), 0.08) << "and the block is out";
}

// Step 12: a block dropped on the tower from 1 cm; "the top row slides a bit", without a cause.
TEST(ReportFailure, TheTopRowSlidesUnderADroppedBlock) {
  Scene scene = towerScene(6);
  scene.settings.sleep = Sleep::off;
  const BlockSpec& under =
      scene.blocks[scene.blocks.size() - 4];  // of the row below the top: the dropped block has the same orientation
  BlockSpec dropped = scene.blocks.back();
  dropped.orientation = under.orientation;
  dropped.centre = Vec3(under.centre.x(), under.centre.y(), dropped.centre.z() + dropped.dimensions.z() + 0.01);
  scene.blocks.push_back(dropped);
  Simulation reported(asReported(scene));
  EXPECT_GT(topRowMoves(reported, 15, 2.5), 3e-3);
  Simulation ours(scene);
  EXPECT_LT(topRowMoves(ours, 15, 2.5), 1e-3) << "a small amount, as the real one";
}

// A block across another, its centre of mass 0.3 mm beyond the edge, held down at its inner end until it has settled.
Scene overhangingBlock() {
  Scene scene = oneBlockScene(true);
  BlockSpec upper = scene.blocks[0];
  upper.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ());
  upper.centre = Vec3(0.0, 0.5 * kBlockWidth_m + 3e-4, 1.5 * kBlockHeight_m);
  scene.blocks.push_back(upper);
  for (const int corner : {0, 2}) scene.forces.push_back(constantForce(1, corner, Vec3(0.0, 0.0, -0.005), 0.0, 0.3));
  return scene;
}

// Report 6.2.2, before Figure 6.22: the start of tipping is too slow for the disabling test, and the block hangs there for ever.
TEST(ReportFailure, TheDisablingTestHoldsAnOverhangingBlock) {
  const auto drop = [](const Scene& scene) {
    Simulation simulation(scene);
    stepFor(simulation, 2.0);
    return 1.5 * kBlockHeight_m - centre(simulation.state.position, 1).z();
  };
  Scene reported = withSubsteps(asReported(overhangingBlock()), 200);
  EXPECT_GT(drop(reported), 1e-3) << "awake it falls";
  reported.settings.sleep = Sleep::report;
  EXPECT_LT(drop(reported), 2e-4);
  reported.settings.sleep = Sleep::on;
  EXPECT_GT(drop(reported), 1e-3);
  Scene ours = overhangingBlock();
  ours.settings.sleep = Sleep::on;
  EXPECT_GT(drop(ours), 1e-3);
}

// Figure 6.22: in a tower at rest some blocks are not disabled, as "the particles are moving enough to categorise them as moving
// blocks. The situation becomes worse with more blocks in the tower". The units of the report's distance are not known. In metres
// it disables every block of these towers; with a quarter of it a tower of two rows is disabled, and hardly a block of six rows,
// which stand as well.
TEST(ReportFailure, TheDisablingTestKeepsARestingTowerAwake) {
  struct Rest {
    std::ptrdiff_t awake = 0;
    bool stands = false;
  };
  const auto restOf = [](const Scene& scene, double seconds) {
    Simulation simulation(scene);
    const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
    stepFor(simulation, seconds);
    return Rest{std::count(simulation.asleep.begin(), simulation.asleep.end(), std::uint8_t{0}),
                standing(simulation.model, start, simulation.state.position).stands};
  };
  const auto reported = [&](int rows, double share) {
    Scene scene = asReported(towerScene(rows));
    scene.settings.sleep = Sleep::report;
    scene.settings.reportDisableDistance_m *= share;
    return restOf(scene, 2.5);
  };
  EXPECT_EQ(reported(6, 1.0).awake, 0);
  EXPECT_LE(reported(2, 0.25).awake, 2) << "of 6";
  const Rest high = reported(6, 0.25);
  EXPECT_GE(high.awake, 12) << "of 18";
  EXPECT_TRUE(high.stands);
  const Rest ours = restOf(towerScene(6), 5.0);
  EXPECT_EQ(ours.awake, 0);
  EXPECT_TRUE(ours.stands);
}

// One block lies on the floor without friction, another slides towards it.
Scene comingBlock(double speed) {
  Scene scene = withSubsteps(asReported(oneBlockScene(true)), 200);
  scene.staticFriction = scene.kineticFriction = 0.0;
  scene.settings.reportFrictionDrag = 0.0;
  scene.settings.sleep = Sleep::report;
  scene.blocks.push_back(scene.blocks[0]);
  scene.blocks[1].centre.x() = -kBlockLength_m - 0.15 * speed;  // they collide after 0.15 s
  scene.blocks[1].velocity.x() = speed;
  return scene;
}

// Report 4.7: a disabled block is enabled by a sufficiently large impulse, and takes part in the same collision.
TEST(ReportDisabling, ACollisionEnablesABlock) {
  Simulation simulation(comingBlock(1.0));
  stepFor(simulation, 0.1);
  ASSERT_EQ(simulation.asleep[0], 1);
  const Vec3 before = momentum(simulation).linear;
  const Counters counters = simulation.counters;
  stepFor(simulation, 0.1);
  EXPECT_EQ(simulation.asleep[0], 0);
  EXPECT_GT(simulation.counters.replayedFrames, counters.replayedFrames);
  EXPECT_GT(centre(simulation.state.velocity, 0).x(), 0.3);
  EXPECT_NEAR(momentum(simulation).linear.x(), before.x(), 1e-9 * before.x());
}

// The frame in which that happens is run again with the block enabled from the start of the frame.
TEST(ReportDisabling, TheFrameIsAsIfTheBlockHadBeenEnabled) {
  Scene scene = comingBlock(1.0);
  scene.staticFriction = scene.kineticFriction = 0.1;  // so that contacts of the step before matter
  Simulation simulation(scene);
  stepFor(simulation, 0.1);
  ASSERT_EQ(simulation.asleep[0], 1);
  auto snapshot = takeSnapshot(simulation);
  for (int frame = 0; frame < 60 && simulation.asleep[0] == 1; ++frame) {
    snapshot = takeSnapshot(simulation);
    prepareAndStep(simulation);
  }
  ASSERT_EQ(simulation.asleep[0], 0);
  const std::uint64_t hash = stateHash(simulation);
  const std::uint64_t replayed = simulation.counters.replayedFrames;
  restoreSnapshot(simulation, *snapshot);
  wake(simulation, 0, WakeReason::kick);
  prepareAndStep(simulation);
  EXPECT_LT(simulation.counters.replayedFrames, replayed);
  EXPECT_EQ(stateHash(simulation), hash);
}

TEST(ReportDisabling, ATouchDoesNot) {
  Simulation simulation(comingBlock(0.02));
  stepFor(simulation, 0.1);
  ASSERT_EQ(simulation.asleep[0], 1);
  const Vec3 before = centre(simulation.state.position, 0);
  stepFor(simulation, 0.2);
  EXPECT_EQ(simulation.asleep[0], 1);
  EXPECT_EQ(centre(simulation.state.position, 0), before);
  EXPECT_LT(centre(simulation.state.velocity, 1).x(), 0.0) << "it never came";
}

TEST(ReportDisabling, ATowerOfDisabledBlocksIsAtRestAndCostsNothing) {
  Scene scene = withSubsteps(asReported(towerScene(2)), 200);
  Simulation awake(scene);
  stepFor(awake, 0.5);
  EXPECT_FALSE(atRest(awake));
  EXPECT_EQ(std::count(awake.asleep.begin(), awake.asleep.end(), 1), 0);
  scene.settings.sleep = Sleep::report;
  Simulation simulation(scene);
  stepFor(simulation, 0.5);
  EXPECT_TRUE(atRest(simulation));
  EXPECT_EQ(std::count(simulation.asleep.begin(), simulation.asleep.end(), 0), 0);
  for (const auto& contacts : simulation.engine->report.contacts) EXPECT_TRUE(contacts.empty()) << "friction of long ago";
  const std::uint64_t steps = simulation.counters.steps;
  stepFor(simulation, 0.5);
  EXPECT_EQ(simulation.counters.steps, steps);
}

}  // namespace
}  // namespace springtower
