#include "core/scene/scene.h"
#include "solver/runner/run.h"
#include "solver/statics/statics.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <string>

namespace springtower {
namespace {

constexpr double kMillimetre = 1e-3;

// The full tower of 54 blocks, without sleep.
Scene fullTower(const TowerOptions& options = {}) {
  Scene scene = towerScene(18, options);
  scene.settings.sleep = Sleep::off;
  return scene;
}

RunResult runFor(const Scene& scene, double seconds) {
  Simulation simulation(scene);
  RunOptions options;
  options.seconds = seconds;
  return runScene(simulation, options);
}

// A run of the full tower on one thread, to which the time limit of a frame refers.
RunResult runMinute(const Scene& scene) {
  const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
  return runFor(scene, 60.0);
}

// The requirement for users: the tower comes to rest within a second, and for the rest of a minute it neither sinks nor creeps
// nor vibrates.
TEST(FullTower, StandsStillWithoutSleep) {
  const RunResult result = runMinute(fullTower());
  EXPECT_TRUE(result.standing.stands) << describe(result.standing);
  ASSERT_TRUE(result.restTime_s);
  EXPECT_LT(*result.restTime_s, 5.0) << "sleep is promised within 5 s, and it waits for this";
  EXPECT_LE(*result.maxPenetration_m, 0.05 * kMillimetre) << "the default tolerance: no resting penetration above it";
  EXPECT_LE(*result.creep_m, 0.005 * kMillimetre) << "a tenth of the tolerance: true static friction does not creep";
  EXPECT_LE(result.jitter_m_s, 1e-4 * kMillimetre) << "a tower at rest is still: 0.1 micrometre a second";
  EXPECT_LE(result.bottomRowCompression_m, 0.03 * kMillimetre) << "0.6 of the tolerance, under 17 rows";
  EXPECT_GT(result.bottomRowCompression_m, 0.0) << "loaded springs are compressed";
  EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U);
#ifdef NDEBUG  // sanitizers and assertions cost more than what they check
  // Half of a frame at 60 Hz, and some seventy times the median of 3600 frames: CPU time of this process, so that the load of the
  // machine does not matter.
  EXPECT_LT(result.frameTimes.cpuMedian, 8.0) << "ms";
#endif
}

class UnevenTowerTest : public ::testing::TestWithParam<std::uint64_t> {};

// With uneven heights each row rests on few points, which then carry several times their even share: twice the tolerance. Blocks
// that rock on two points take longer to come to rest, hence ten times the jitter.
TEST_P(UnevenTowerTest, StandsStillWithoutSleep) {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  options.seed = GetParam();
  const RunResult result = runMinute(fullTower(options));
  EXPECT_TRUE(result.standing.stands) << describe(result.standing);
  ASSERT_TRUE(result.restTime_s);
  EXPECT_LE(*result.maxPenetration_m, 0.1 * kMillimetre);
  EXPECT_LE(*result.creep_m, 0.005 * kMillimetre);
  EXPECT_LE(result.jitter_m_s, 1e-3 * kMillimetre);
  EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U);
}

INSTANTIATE_TEST_SUITE_P(FullTower, UnevenTowerTest, ::testing::Range(std::uint64_t{1}, std::uint64_t{6}),
                         [](const auto& tested) { return "Seed" + std::to_string(tested.param); });

// A rigid tower of 18 rows of 81 mm tips at atan(81 / 327.6), 13.9 degrees. At 10 degrees, with gravity along every second row,
// only static friction between all rows holds it.
TEST(FullTower, StandsUnderTiltedGravity) {
  Scene scene = fullTower();
  scene.gravity.tilt_deg = 10.0;
  const RunResult result = runMinute(scene);
  EXPECT_TRUE(result.standing.stands) << describe(result.standing);
  ASSERT_TRUE(result.creep_m);
  EXPECT_LE(*result.creep_m, 0.005 * kMillimetre) << "as upright: friction that holds does not slide";
  EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U);
}

class CollapseTest : public ::testing::TestWithParam<Sleep> {};

// Beyond its tipping angle the tower comes down: hundreds of impacts at up to 3 m/s. The pile is at rest before 6 s; in the
// seconds that follow neither sleep nor its absence may disturb it.
TEST_P(CollapseTest, IsWithoutFlaw) {
  Scene scene = towerScene(18);
  scene.settings.sleep = GetParam();
  scene.gravity.tilt_deg = 14.5;
  Simulation simulation(scene);
  RunOptions options;
  options.seconds = 10.0;
  const RunResult result = runScene(simulation, options);
  EXPECT_FALSE(result.standing.stands);
  EXPECT_GT(result.counters.contactsCreated, 500U) << "the pile's blocks have met many times";
  EXPECT_LE(result.deepest.depth, 1.0 * kMillimetre) << "a block's twentieth: nothing passes through anything";
  EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U);
  ASSERT_TRUE(result.maxEnergyRise);
  EXPECT_LE(*result.maxEnergyRise, 1e-6) << "of the energy at the start, in any frame: impacts and changes of contact only lose";
  // Blocks at rest on few points penetrate no more than those of an uneven tower. A block embedded in another would show as
  // millimetres.
  PenetrationWorkspace workspace;
  EXPECT_LE(maxPenetration(simulation.state.position, true, workspace).depth, 0.1 * kMillimetre);
}

INSTANTIATE_TEST_SUITE_P(FullTower, CollapseTest, ::testing::Values(Sleep::on, Sleep::off),
                         [](const auto& tested) { return tested.param == Sleep::on ? "WithSleep" : "WithoutSleep"; });

class DroppedRowsTest : public ::testing::TestWithParam<double> {};

// Three rows fall together from 2 cm: all contacts of a block begin in the same step, each stiffened for the impact. They land,
// rebound and remain a tower; when the step count assumed one new contact at a time, energy was added.
TEST_P(DroppedRowsTest, LandWithoutGainingEnergy) {
  for (const Method method : {Method::implicit, Method::semiImplicitEuler}) {
    Scene scene = towerScene(3);
    for (BlockSpec& block : scene.blocks) block.centre.z() += 0.02;
    scene.settings.method = method;
    scene.settings.tolerance_m = GetParam();
    const RunResult result = runFor(scene, 3.0);
    ASSERT_TRUE(result.maxEnergyRise);
    EXPECT_LE(*result.maxEnergyRise, 1e-6) << nameOf(method) << ": of the energy at the start, in any frame";
    EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U) << nameOf(method);
  }
}

INSTANTIATE_TEST_SUITE_P(Tolerances, DroppedRowsTest, ::testing::Values(2e-4, 1e-4, 5e-5, 1e-5),
                         [](const auto& tested) { return std::to_string(std::lround(1e6 * tested.param)) + "micrometres"; });

struct Published {
  const char* code;
  double dy_m;  // of the top block
  bool stands;
  const char* name;
};

class PublishedTest : public ::testing::TestWithParam<Published> {};

// The report's static configurations (its section 6.1.1), with its results for the real tower, except for T2. There the top block
// keeps the one under it from tipping off the lowest. With the pitch of 27.15 mm used here the common centre of mass of these two
// lies half a pitch from the axis, at 13.575 mm, while the lowest block begins at 27.15 - 13.35 = 13.8 mm: the centre is 0.225 mm
// outside its edge, and nominal T2 falls, slowly. With the top block 2 mm further from the axis the centre moves out by 1 mm and
// lies over the lowest block, and all stand as the real ones did; with it 1 mm further in they fall.
TEST_P(PublishedTest, DoesWhatTheRealTowerDid) {
  TowerOptions tower;
  if (GetParam().dy_m != 0.0) tower.offsets.push_back({2, 3, 0.0, GetParam().dy_m});
  Simulation simulation(bitCodeScene(GetParam().code, tower));
  RunOptions options;
  options.seconds = 10.0;
  options.stopWhenFallen = true;
  options.stopWhenAtRest = true;
  options.secondsAfterRest = 0.5;
  const RunResult result = runScene(simulation, options);
  EXPECT_EQ(result.standing.stands, GetParam().stands) << describe(result.standing);
  EXPECT_EQ(result.restTime_s.has_value(), GetParam().stands) << "it stands for good, and was never at rest before a fall";
  EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U);
}

INSTANTIATE_TEST_SUITE_P(Report, PublishedTest,
                         ::testing::Values(Published{"(010)-(010)-(010)-(010)-(010)-(010)", 0.0, true, "T1"},
                                           Published{"(001)-(010)-(001)", 0.0, false, "T2"},
                                           Published{"(001)-(010)-(001)", 0.002, true, "T2TopFurtherOut"},
                                           Published{"(001)-(010)-(001)", -0.001, false, "T2TopFurtherIn"},
                                           Published{"(001)-(010)", 0.0, false, "T2WithoutTop"},
                                           Published{"(001)-(101)-(001)", 0.0, false, "T3"},
                                           Published{"(100)-(010)-(001)", 0.0, false, "T4"},
                                           Published{"(010)-(010)-(011)", 0.0, true, "T5"},
                                           Published{"(010)-(010)-(011)-(010)-(001)", 0.0, true, "T6"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

struct PlacedTest : ::testing::TestWithParam<double> {};

// A block lowered by half a millimetre, crosswise, onto the end of a block that lies across another: the pair's centre of mass is
// at half the distance, and the lower edge at half a block's width, so it stays if the distance is less than that width.
TEST_P(PlacedTest, ABlockLaidOnTopStaysOrTipsWhatIsBelow) {
  const double distance_m = GetParam();
  const bool stays = distance_m < kBlockWidth_m;
  Scene scene = bitCodeScene("(010)-(010)");
  BlockSpec placed;
  placed.centre = Vec3(0.0, distance_m, 2.5 * kBlockHeight_m);
  scene.blocks.push_back(placed);
  EXPECT_EQ(staticScene(scene).rest == Rest::stands, stays);
  scene.blocks.back().centre.z() += 0.5 * kMillimetre;
  const RunResult result = runFor(scene, 3.0);
  EXPECT_EQ(result.standing.stands, stays) << describe(result.standing);
  EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U);
}

INSTANTIATE_TEST_SUITE_P(Distances, PlacedTest, ::testing::Values(0.010, 0.018, 0.022, 0.031, 0.036));

}  // namespace
}  // namespace springtower
