// The judge of random scenes finds what is wrong, and nothing where nothing is.
#include "tests/random/judge.h"

#include "scenarios/loose.h"
#include "scenarios/random_scene.h"
#include "tests/random/course.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace springtower {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Json = nlohmann::ordered_json;

constexpr double kPatience_s = 60.0;  // also where sanitizers slow everything down

JudgeOptions patient() {
  JudgeOptions options;
  options.limit_s = kPatience_s;
  return options;
}

Scene fileScene(const std::string& name) {
  return sceneFromToml(SPRINGTOWER_TEST_DATA_DIR "/random/" + name + ".toml");
}

TEST(RandomJudge, FindsNothingWrongWithABlockThatLies) {
  Scene scene = oneBlockScene(true);
  scene.seconds = 0.5;
  const Record record = judgeScene(scene, patient());
  EXPECT_EQ(record.frames, 30);
  EXPECT_NEAR(record.simulated_s, 0.5, 1e-12);
  EXPECT_LT(record.movedMost, 1e-2);
  EXPECT_EQ(record.sameOnTwoThreads, true);
  EXPECT_EQ(record.sameVerdict, true);
  for (const Fault fault : faultsOf(record)) EXPECT_EQ(fault, Fault::slow) << describe(record, fault);
}

// Explicit steps that are far too long for the stiffness, which no cure of the engine helps.
TEST(RandomJudge, FindsWhatDiverges) {
  const Record record = judgeScene(fileScene("unstable"), patient());
  EXPECT_THAT(faultsOf(record), Contains(Fault::diverged));
  EXPECT_THAT(describe(record, Fault::diverged), HasSubstr("diverged: block"));
  EXPECT_TRUE(record.notFinite.empty());
  EXPECT_EQ(record.sameOnTwoThreads, true);
  EXPECT_FALSE(record.sameVerdict.has_value());
}

TEST(RandomJudge, FindsABlockThatFallsThroughWhatItShouldHit) {
  Scene scene = droppedBlockScene(0.03);
  scene.settings.continuousTests = false;  // nothing is hit: the fault is planted
  scene.seconds = 0.5;
  const Record record = judgeScene(scene, patient());
  EXPECT_THAT(faultsOf(record), Contains(Fault::deep));
  EXPECT_GT(record.deepest_m, kBlockHeight_m);
  EXPECT_GT(record.movedMost, kMaxMove);
}

// Gravity that swings does work on a block in flight, which the judge does not count.
TEST(RandomJudge, FindsEnergyFromNowhere) {
  Scene scene = oneBlockScene(false);
  scene.blocks[0].velocity.z() = 1.0;
  scene.seconds = 0.5;
  EXPECT_THAT(faultsOf(judgeScene(scene, patient())), Not(Contains(Fault::energy)));
  scene.gravity.sway_deg = 60.0;
  scene.gravity.sway_hz = 1.0;
  const Record record = judgeScene(scene, patient());
  EXPECT_THAT(faultsOf(record), Contains(Fault::energy));
  EXPECT_GT(record.energyGained, kMaxEnergyGain);
}

// The scene's own force does work as well, and that is counted.
TEST(RandomJudge, CountsTheWorkOfForces) {
  Scene scene = oneBlockScene(true);
  scene.seconds = 0.5;
  UserForce force;
  force.force = Vec3(1.0, 0.0, 0.0);  // N, five weights
  force.end_s = 0.3;
  scene.forces = {force};
  const Record record = judgeScene(scene, patient());
  EXPECT_GT(record.movedMost, 1.0);
  EXPECT_LT(record.energyGained, kMaxEnergyGain);
}

// In scene 3784 the held block hits others: within frame 168 the hand's force rises from 0.2 to 8.7 N, and the mean of the
// forces at its ends times the way is 0.05 J too large, then 0.13 J too small. Counted as work, it was a gain of 0.16.
TEST(RandomJudge, DoesNotCountWorkOfTheHandThatIsNotKnown) {
  Scene scene = randomScene(3784).scene;
  scene.seconds = 4.0;
  const Record record = judgeScene(scene, patient());
  EXPECT_TRUE(record.byHand);
  EXPECT_THAT(faultsOf(record), Not(Contains(Fault::energy)));
}

TEST(RandomJudge, FindsWhatIsSlow) {
  Record record;
  record.frames = 1;
  record.simulated_s = 1.0;
  record.processor_s = 1.5;
  EXPECT_THAT(faultsOf(record), ::testing::ElementsAre(Fault::slow));
  record.processor_s = 0.5;
  EXPECT_THAT(faultsOf(record), IsEmpty());
}

TEST(RandomJudge, EndsARunWithTheFrameInWhichItsTimeIsOver) {
  Scene scene = oneBlockScene(true);
  scene.seconds = 100.0;
  JudgeOptions options;
  options.limit_s = 0.0;
  const Record record = judgeScene(scene, options);
  EXPECT_TRUE(record.cut);
  EXPECT_EQ(record.frames, 1);
  EXPECT_THAT(faultsOf(record), Not(Contains(Fault::threads)));
}

TEST(RandomJudge, MeasuresNoLossOfMomentumOfAFreeBlock) {
  Scene scene = spinningBlockScene();
  scene.blocks[0].velocity = Vec3(0.3, -0.2, 0.1);
  scene.seconds = 0.5;
  scene.settings.method = Method::semiImplicitEuler;
  const Record record = judgeScene(scene, patient());
  ASSERT_TRUE(record.momentumLost.has_value());
  EXPECT_LT(*record.momentumLost, 1e-9);
  EXPECT_LT(*record.angularLost, kMaxAngularLoss);
  EXPECT_FALSE(judgeScene(oneBlockScene(true), JudgeOptions{0.0}).momentumLost.has_value());
}

TEST(RandomJudge, TellsTwoCoursesApart) {
  Scene scene = droppedBlockScene(0.03);
  scene.seconds = 0.3;
  const Course one = playScene(scene, 1, kPatience_s);
  EXPECT_TRUE(agree(one, playScene(scene, 2, kPatience_s)));
  scene.blocks[0].centre.z() += 1e-9;
  EXPECT_FALSE(agree(one, playScene(scene, 1, kPatience_s)));
}

TEST(RandomJudge, TellsACourseThatEndsBeforeTheOtherIsOverItsLimit) {
  Course whole;
  whole.frames = 40;
  whole.hashes = {1, 2, 3, 4};
  Course cut = whole;
  cut.cut = true;
  cut.frames = 30;
  cut.hashes = {1, 2, 3};
  EXPECT_TRUE(agree(whole, cut));
  EXPECT_TRUE(agree(cut, whole));
  Course diverged = whole;
  diverged.diverged = "block 0 diverged";
  diverged.frames = 25;
  diverged.hashes = {1, 2};
  EXPECT_FALSE(agree(diverged, cut)) << "the other went on";
  EXPECT_FALSE(agree(cut, diverged));
  diverged.frames = 35;
  diverged.hashes = {1, 2, 3};
  EXPECT_TRUE(agree(diverged, cut)) << "where the other would have gone is not known";
}

// A torque does work on a block in space that turns with it: as much as it gains.
TEST(RandomJudge, CountsTheWorkOfATorque) {
  Scene scene = spinningBlockScene();
  scene.blocks[0].spin = Vec3::Zero();
  scene.seconds = 0.5;
  scene.forces.push_back(UserForce{.block = 0, .end_s = 1.0, .torque = Vec3(0.0, 0.0, 1e-4)});
  const Record record = judgeScene(scene, patient());
  EXPECT_LT(record.energyGained, 1e-3);
}

// Within any run: also where the first one is over and measured.
TEST(RandomRecord, IsOfASceneThatHungWhereItsProcessWasEndedAtItsLimit) {
  Record record;
  record.simulated_s = 1.0;
  record.ended = "limit";
  EXPECT_THAT(faultsOf(record), ::testing::ElementsAre(Fault::hung, Fault::slow));
  EXPECT_THAT(describe(record, Fault::hung), HasSubstr("the first run"));
  record.frames = 60;
  record.hash = "0123456789abcdef";
  EXPECT_THAT(faultsOf(record), ::testing::ElementsAre(Fault::hung, Fault::slow));
  EXPECT_THAT(describe(record, Fault::hung), HasSubstr("a run after the first"));
  record.ended = "signal 11";
  EXPECT_THAT(faultsOf(record), ::testing::ElementsAre(Fault::crash));
}

TEST(RandomRecord, HasAFaultWhereWhatWasMeasuredIsNotANumber) {
  Record record;
  record.frames = 1;
  record.simulated_s = 1.0;
  record.energyGained = record.deepest_m = std::numeric_limits<double>::quiet_NaN();
  record.momentumLost = record.angularLost = record.energyGained;
  const auto faults = ::testing::ElementsAre(Fault::energy, Fault::deep, Fault::momentum);
  EXPECT_THAT(faultsOf(record), faults);
  EXPECT_THAT(faultsOf(recordFromJson(Json::parse(recordJson(record).dump()))), faults);
}

TEST(RandomRecord, ComesBackFromJson) {
  Record record = judgeScene(fileScene("unstable"), patient());
  record.seed = 17;
  const Record back = recordFromJson(recordJson(record));
  EXPECT_EQ(recordJson(back), recordJson(record));
  EXPECT_EQ(back.diverged, record.diverged);
  EXPECT_EQ(back.seed, record.seed);
}

TEST(RandomRecord, HasNamesForAllFaults) {
  for (const Fault fault : kFaults) EXPECT_EQ(faultFromName(nameOf(fault), "test"), fault);
  EXPECT_THROW(faultFromName("beauty", "test"), std::exception);
}

}  // namespace
}  // namespace springtower
