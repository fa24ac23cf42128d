// The named scenes.
#include "scenarios/registry.h"

#include "core/error.h"
#include "core/limits.h"
#include "scenarios/gate.h"
#include "scenarios/loose.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <utility>

namespace springtower {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

constexpr double kSameNumber = 1e-15;  // rounding between a length written in a file and computed in code

TEST(Scenarios, AreEachMadeAtTheirUsualSizeAndStartSoundly) {
  for (const Scenario& scenario : scenarios()) {
    const Scene scene = makeScene(scenario, usualSize(scenario));
    EXPECT_NO_THROW(checkScene(scene, scenario.name)) << scenario.name;
    EXPECT_FALSE(scene.blocks.empty()) << scenario.name;
    EXPECT_THAT(scene.name, StartsWith(std::string(scenario.name)));
  }
}

TEST(Scenarios, AreEachMadeAtTheirLeastSize) {
  for (const Scenario& scenario : scenarios()) {
    const ScenarioSize least = {scenario.numbers[0].least, scenario.numbers[1].least};
    EXPECT_NO_THROW(makeScene(scenario, least)) << scenario.name;
  }
}

TEST(Scenarios, HaveNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (const Scenario& scenario : scenarios()) {
    EXPECT_TRUE(names.insert(scenario.name).second) << scenario.name << " twice";
    EXPECT_EQ(findScenario(scenario.name), &scenario);
    EXPECT_EQ(scenario.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz-"), std::string_view::npos) << scenario.name;
  }
  EXPECT_EQ(findScenario("castle"), nullptr);
  EXPECT_EQ(findScenario(""), nullptr);
}

TEST(Scenarios, HaveUsualSizesAmongThoseThatAreAllowed) {
  for (const Scenario& scenario : scenarios()) {
    for (const SizeNumber& number : scenario.numbers) {
      EXPECT_LE(number.least, number.usual) << scenario.name;
      EXPECT_LE(number.usual, number.most) << scenario.name;
    }
  }
}

TEST(ScenarioName, MayHaveASize) {
  EXPECT_EQ(sceneNamed("tower").blocks.size(), 54U);
  EXPECT_EQ(sceneNamed("tower:4").blocks.size(), 12U);
  EXPECT_EQ(sceneNamed("wall").blocks.size(), 246U);
  EXPECT_EQ(sceneNamed("wall:3x2").blocks.size(), 7U);
  EXPECT_EQ(sceneNamed("wall:3x2").name, "wall:3x2");
  EXPECT_EQ(sceneNamed("thrown").blocks.size(), 2U);
  EXPECT_EQ(sceneNamed("thrown").name, "thrown");
  EXPECT_EQ(sceneNamed("towers:3").blocks.size(), 3U * 54U);
  EXPECT_EQ(usageOf(*findScenario("wall")), "wall:COLUMNSxCOURSES");
  EXPECT_EQ(usageOf(*findScenario("thrown")), "thrown");
  EXPECT_EQ(allowedSizes(*findScenario("wall")), "1 to 4000 columns, 1 to 100 courses");
}

// Bricks lie across their pyramid, half a pitch aside from row to row: each on two of the row below, which touch it with a gap
// between them.
TEST(Scenarios, BricksLieAcrossTheirPyramid) {
  const Scene pyramid = sceneNamed("bricks:3");
  ASSERT_EQ(pyramid.blocks.size(), 6U);
  const double pitch_m = kBlockWidth_m + kWallGap_m;
  for (std::size_t i = 0; i < 3; ++i) {
    const BlockSpec& lowest = pyramid.blocks[i];
    EXPECT_NEAR(lowest.centre.x(), (static_cast<double>(i) - 1.0) * pitch_m, kSameNumber);
    EXPECT_NEAR(lowest.centre.z(), 0.5 * kBlockHeight_m, kSameNumber);
    EXPECT_NEAR(std::abs((lowest.orientation * Vec3::UnitX()).y()), 1.0, kSameNumber) << "its length lies across";
  }
  EXPECT_NEAR(pyramid.blocks[3].centre.x(), -0.5 * pitch_m, kSameNumber);
  EXPECT_NEAR(pyramid.blocks[5].centre.x(), 0.0, kSameNumber);
  EXPECT_NEAR(pyramid.blocks[5].centre.z(), 2.5 * kBlockHeight_m, kSameNumber);
}

TEST(ScenarioName, MayBeABitCodeOrAFile) {
  EXPECT_EQ(sceneNamed("(010)-(101)").blocks.size(), 3U);
  EXPECT_EQ(sceneNamed(SPRINGTOWER_SOURCE_DIR "/scenes/report_t1.toml").blocks.size(), 6U);
  EXPECT_THAT([] { sceneNamed("no-such-scene.toml"); },
              ThrowsMessage<InputError>(AllOf(StartsWith("no-such-scene.toml: expected "), EndsWith(", got no such file"))));
}

TEST(ScenarioName, ThatIsUnknownSaysAllThatIsAllowed) {
  for (const std::string name : {"castle", "castle:3", ""}) {
    EXPECT_THAT([&] { sceneNamed(name); },
                ThrowsMessage<InputError>(AllOf(StartsWith("'" + name + "': expected tower:ROWS, "),
                                                HasSubstr("wall:COLUMNSxCOURSES"), HasSubstr("thin-wall"),
                                                EndsWith("a bit code such as (010)-(111), or a .toml file, got none of them"))));
  }
}

TEST(ScenarioName, OfAWrongSizeSaysWhichAreAllowed) {
  for (const std::string size : {"", "20", "20x", "x12", "20x12x2", "20 x 12", "a", "0x12", "20x101", "99999999999x1", "-1x2"}) {
    EXPECT_THAT([&] { sceneNamed("wall:" + size); },
                ThrowsMessage<InputError>("wall:COLUMNSxCOURSES: expected 1 to 4000 columns, 1 to 100 courses, got the size '" +
                                          size + "'"));
  }
  EXPECT_THAT([] { sceneNamed("thrown:2"); }, ThrowsMessage<InputError>("thrown: expected the name alone, got the size '2'"));
  EXPECT_THAT([] { sceneNamed("tower:ten"); },
              ThrowsMessage<InputError>("tower:R: expected a whole number of rows from 1 to 2000, got 'ten'"));
}

TEST(ScenarioName, TakesOptionsOfTowersForTowersOnly) {
  TowerOptions options;
  options.startGap_m = 0.01;
  EXPECT_GT(sceneNamed("tower:2", options).blocks.back().centre.z(), 0.037);
  EXPECT_GT(sceneNamed("towers:2", options).blocks.back().centre.z(), 0.45);
  EXPECT_THAT([&] { sceneNamed("wall:3x2", options); },
              ThrowsMessage<InputError>("wall:3x2: expected a tower for a start gap, got another scene"));
}

// The files show how such a scene is written; a change of one requires a change of the other.
TEST(Scenarios, AreThoseOfTheFilesOfTheSameScenes) {
  for (const auto& [name, file] : {std::pair{"slope", "block_on_slope"}, std::pair{"thin-wall", "thin_wall"}}) {
    const Scene made = sceneNamed(name);
    const Scene read = sceneFromToml(std::string(SPRINGTOWER_SOURCE_DIR "/scenes/") + file + ".toml");
    ASSERT_EQ(made.blocks.size(), read.blocks.size()) << name;
    for (std::size_t b = 0; b < made.blocks.size(); ++b) {
      EXPECT_LT((made.blocks[b].centre - read.blocks[b].centre).norm(), kSameNumber) << name;
      EXPECT_EQ(made.blocks[b].dimensions, read.blocks[b].dimensions) << name;
      EXPECT_EQ(made.blocks[b].orientation.coeffs(), read.blocks[b].orientation.coeffs()) << name;
      EXPECT_EQ(made.blocks[b].velocity, read.blocks[b].velocity) << name;
      EXPECT_EQ(made.blocks[b].mass, read.blocks[b].mass) << name;
    }
    EXPECT_EQ(made.gravity.tilt_deg, read.gravity.tilt_deg) << name;
    EXPECT_EQ(made.gravity.direction_deg, read.gravity.direction_deg) << name;
    EXPECT_EQ(made.staticFriction, read.staticFriction) << name;
    EXPECT_EQ(made.seconds, read.seconds) << name;
  }
}

TEST(Scenarios, OfAskewBlocksEndWhereTheyWouldOverlap) {
  EXPECT_NO_THROW(checkScene(askewPileScene(kMaxAskewBlocks), "askew"));
  EXPECT_THROW(checkScene(askewPileScene(kMaxAskewBlocks + 1), "askew"), InputError);
}

TEST(Scenarios, OfManyTowersLayThemOnASquare) {
  const Scene five = squareOf(towerScene(1), 5);
  ASSERT_EQ(five.blocks.size(), 15U);
  EXPECT_EQ(five.blocks[9].centre.x() - five.blocks[0].centre.x(), 0.0);  // the fourth begins the second line of three
  EXPECT_NEAR(five.blocks[9].centre.y() - five.blocks[0].centre.y(), kTowerSpacing_m, kSameNumber);
  const Scene six = grid(towerScene(1), 2, 3, 0.2);
  EXPECT_NEAR(six.blocks[3].centre.y() - six.blocks[0].centre.y(), 0.2, kSameNumber);
  EXPECT_NEAR(six.blocks[9].centre.x() - six.blocks[0].centre.x(), 0.2, kSameNumber);
}

TEST(Scenarios, FindTheMiddleBlock) {
  const Scene tower = towerScene(18);
  EXPECT_EQ(tower.blocks[middleBlock(tower)].row, 9);
  EXPECT_EQ(tower.blocks[middleBlock(tower)].position, 2);
  EXPECT_EQ(middleBlock(towerScene(1)), 1U);
}

TEST(Scenarios, OfTheGatesAreAwake) {
  for (const GateTower& gate : gateTowers()) {
    const Scene scene = sceneOf(gate, Method::semiImplicitEuler);
    EXPECT_EQ(scene.settings.sleep, Sleep::off) << gate.name;
    EXPECT_EQ(scene.settings.method, Method::semiImplicitEuler) << gate.name;
    EXPECT_EQ(scene.gravity.tilt_deg, gate.tilt_deg) << gate.name;
  }
}

}  // namespace
}  // namespace springtower
