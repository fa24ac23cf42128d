// springtower profile of walls and pyramids, run as a user would.
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace springtower {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

ProgramResult profileOf(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "profile");
  return runProgram("springtower", arguments);
}

TEST(ProfileStacks, RefusesWhatItDoesNotKnowAndWritesNothing) {
  const ScratchFolder scratch;
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused = {
      {{"--scenes", "walls,castle"},
       "--scenes: expected rest, sway, heights, pull, pull-sleep, game, collapse, "
       "asleep, towers, pile, walls, pyramids, starts, topple, hit, heaps, piles, rain, got 'castle'"},
      {{"--stacks", "castle:3"},
       "--stacks: expected wall:COLUMNSxCOURSES of 1 to 4000 and 1 to 100, cubes:ROWS "
       "of 1 to 400, bricks:ROWS of 1 to 400, tower:ROWS of 1 to 1000, uneven:ROWS of 1 to 1000, tilted:ROWS of 1 to 1000, "
       "uneven-tilted:ROWS of 1 to 1000, tilted-towers:TOWERS of 1 to 2000, got 'castle:3'"},
      {{"--stacks", "wall:20"}, "--stacks: expected ..., got 'wall:20'"},
      {{"--stacks", "wall:0x5"}, "--stacks: expected ..., got 'wall:0x5'"},
      {{"--stacks", "cubes:401"}, "--stacks: expected ..., got 'cubes:401'"},
      {{"--stacks", "cubes:4x4"}, "--stacks: expected ..., got 'cubes:4x4'"},
      {{"--stacks", "bricks"}, "--stacks: expected ..., got 'bricks'"},
      {{"--peer-limit", "-1"}, "--peer-limit"},
      {{"--full", "--quick"}, "--full"}};
  for (const auto& [arguments, message] : refused) {
    std::vector<std::string> all = arguments;
    all.insert(all.end(), {"--out", scratch.file("out")});
    const ProgramResult result = profileOf(all);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_THAT(result.error, says(message));
    EXPECT_FALSE(std::filesystem::exists(scratch.file("out")));
  }
}

// Towers whose first frame takes a search: all begin in equilibrium, leaning ones too.
TEST(ProfileStarts, TimesTheSearchForTheEquilibriumOfTowers) {
  const ScratchFolder scratch;
  const ProgramResult result =
      profileOf({"--stacks", "tower:9,uneven:9,tilted:9,uneven-tilted:9,tilted-towers:4", "--threads", "1", "--samples", "1",
                 "--frames", "5", "--settle", "0.1", "--peer-limit", "0", "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const std::vector<std::pair<std::string, int>> expected = {
      {"tower:9", 27}, {"uneven:9", 27}, {"tilted:9", 27}, {"uneven-tilted:9", 27}, {"tilted-towers:4", 4 * 54}};
  const Json cases = Json::parse(contentOf(scratch.file("out/profile.json"))).at("cases");
  ASSERT_EQ(cases.size(), expected.size());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    SCOPED_TRACE(cases.at(i).dump());
    EXPECT_EQ(cases.at(i).at("stack"), expected[i].first);
    EXPECT_EQ(cases.at(i).at("blocks"), expected[i].second);
    EXPECT_EQ(cases.at(i).at("stands"), true);
    EXPECT_GT(cases.at(i).at("equilibrium_s").get<double>(), 0.0);
    EXPECT_LE(cases.at(i).at("creep_mm_per_minute").get<double>(), 0.01);
    EXPECT_THAT(result.output, HasSubstr("\n" + expected[i].first + " "));
  }
}

// A wall and both pyramids, small, that all tests below read.
class StackFiles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    result_ = profileOf({"--stacks", "wall:6x4,cubes:6,bricks:5", "--samples", "2", "--frames", "10", "--settle", "0.5",
                         "--peer-limit", "1", "--out", path("out")});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { ASSERT_EQ(result_.exitCode, 0) << result_.error; }

  static std::string path(const std::string& name) { return folder_->file(name); }
  static Json json() { return Json::parse(contentOf(path("out/profile.json"))); }

  // A profile whose figures were put there: what is printed of it.
  static std::string printedOf(const Json& file) {
    std::ofstream(path("made.json")) << file;
    const ProgramResult again = profileOf({"--from", path("made.json"), "--out", path("made")});
    EXPECT_EQ(again.exitCode, 0) << again.error;
    return again.output;
  }

  // The first case of the small profile as another stack with so many blocks that took so long, on one thread.
  static Json caseOf(const std::string& stack, double blocks, double ms) {
    Json one = json().at("cases").at(0);
    one["stack"] = stack;
    one["blocks"] = static_cast<int>(blocks);
    one["cpu_ms"]["median"] = ms;
    return one;
  }

  inline static std::unique_ptr<ScratchFolder> folder_;
  inline static ProgramResult result_;
};

TEST_F(StackFiles, SayHowStacksStand) {
  const std::vector<std::pair<std::string, int>> expected = {{"wall:6x4", 6 + 7 + 6 + 7}, {"cubes:6", 21}, {"bricks:5", 15}};
  const Json cases = json().at("cases");
  ASSERT_EQ(cases.size(), 2 * expected.size()) << "on one thread and on two";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Json& one = cases.at(i);
    SCOPED_TRACE(one.dump());
    EXPECT_EQ(one.at("stack"), expected[i / 2].first);
    EXPECT_EQ(one.at("blocks"), expected[i / 2].second);
    EXPECT_EQ(one.at("threads"), 1 + i % 2);
    EXPECT_EQ(one.at("stands"), true);
    EXPECT_GT(one.at("equilibrium_s").get<double>(), 0.0);
    EXPECT_GT(one.at("max_penetration_mm").get<double>(), 0.0) << "springs carry the weight";
    EXPECT_LE(one.at("max_penetration_mm").get<double>(), 0.05) << "the tolerance";
    EXPECT_LE(one.at("creep_mm_per_minute").get<double>(), 0.001);
  }
}

TEST_F(StackFiles, StandBesideBulletWithItsSteps) {
  ASSERT_TRUE(std::filesystem::exists(std::filesystem::path(SPRINGTOWER_BINARY_DIR) / "bin" / "peers_bullet"));
  const Json cases = json().at("cases");
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Json& peers = cases.at(i).at("peers");
    ASSERT_EQ(peers.empty(), i % 2 == 1) << "with the first of those that share their preparation";
    double before_mm = 1e9;
    for (const Json& peer : peers) {
      SCOPED_TRACE(peer.dump());
      EXPECT_EQ(peer.at("engine"), "bullet");
      EXPECT_GT(peer.at("cpu_ms_median").get<double>(), 0.0);
      EXPECT_LT(peer.at("penetration_mm").get<double>(), before_mm) << "more steps, less deep";
      before_mm = peer.at("penetration_mm").get<double>();
    }
  }
}

TEST_F(StackFiles, TableHasALineForEachStack) {
  const std::vector<std::string> lines = linesOf(result_.output);
  for (const char* line : {"^wall:6x4 +26 .* meets +[0-9]+ steps, ", "^cubes:6 +21 .* meets +[0-9]+ steps, ",
                           "^bricks:5 +15 .* meets +[0-9]+ steps, "})
    EXPECT_THAT(lines, Contains(ContainsRegex(line)));
  const std::vector<std::string> table = linesOf(contentOf(path("out/stacks.csv")));
  EXPECT_THAT(table, Contains(StartsWith("springtower,wall:6x4,26,implicit,5e-05,2,")));
  EXPECT_THAT(table, Contains(StartsWith("bullet,cubes:6,21,,,1,4,")));
  for (const char* name : {"out/stacks_growth.svg", "out/stacks_growth.png", "out/stacks_growth.pdf"})
    EXPECT_GT(contentOf(path(name)).size(), 1000U) << name;
}

TEST_F(StackFiles, JudgeAgainstWhatIsRequired) {
  // A wall of 20 columns and 12 courses may take 0.4 ms on one thread; the goal is 0.3.
  const auto verdict = [](const Json& one) {
    Json file = json();
    file["cases"] = Json::array({one});
    return printedOf(file);
  };
  EXPECT_THAT(linesOf(verdict(caseOf("wall:20x12", 246, 0.25))), Contains(ContainsRegex("^wall:20x12 .* meets, goal too ")));
  EXPECT_THAT(linesOf(verdict(caseOf("wall:20x12", 246, 0.35))), Contains(ContainsRegex("^wall:20x12 .* meets  ")));
  EXPECT_THAT(linesOf(verdict(caseOf("wall:20x12", 246, 0.45))),
              Contains(ContainsRegex("^wall:20x12 .* misses: ms on 1 thread ")));
  Json deep = caseOf("wall:20x12", 246, 0.25);
  deep["max_penetration_mm"] = 0.06;
  deep["creep_mm_per_minute"] = 0.002;
  EXPECT_THAT(linesOf(verdict(deep)), Contains(ContainsRegex("^wall:20x12 .* misses: depth, creep ")));
  Json late = caseOf("wall:40x25", 1012, 1.0);
  late["equilibrium_s"] = 0.2;
  EXPECT_THAT(linesOf(verdict(late)), Contains(ContainsRegex("^wall:40x25 .* misses: equilibrium ")));
}

// Bullet with the setting that is nearest in depth, as a ratio, among those with which it stands.
TEST_F(StackFiles, CompareWithTheSettingNearestInAccuracy) {
  Json one = caseOf("wall:20x12", 246, 0.25);
  one["max_penetration_mm"] = 0.02;
  const auto bullet = [](int steps, double depth_mm, bool stands) {
    return Json{{"engine", "bullet"},         {"substeps", steps},  {"cpu_ms_median", 1.0 * steps},
                {"penetration_mm", depth_mm}, {"simulated_s", 1.0}, {"stands", stands}};
  };
  one["peers"] = {bullet(4, 0.021, false), bullet(8, 0.07, true), bullet(16, 0.009, true), bullet(32, 0.002, true)};
  Json file = json();
  file["cases"] = Json::array({one});
  EXPECT_THAT(linesOf(printedOf(file)), Contains(ContainsRegex("^wall:20x12 .* 16 steps, 16 ms, 0.009 mm")));
}

// The slope of least squares through logarithms: of a power law its power; of (0, 0), (1, 1), (2, 1) a half.
TEST_F(StackFiles, GrowthIsTheSlopeOfLeastSquares) {
  const auto growth = [](const std::vector<double>& blocks, const auto& ms) {
    Json file = json();
    file["cases"] = Json::array();
    for (std::size_t i = 0; i < blocks.size(); ++i)
      file["cases"].push_back(caseOf(fmt::format("wall:{}x25", i + 1), blocks[i], ms(i)));
    return printedOf(file);
  };
  const std::vector<double> blocks = {250, 1000, 5000};
  EXPECT_THAT(
      growth(blocks, [&](std::size_t i) { return 1e-4 * std::pow(blocks[i], 1.2); }),
      HasSubstr("growth of walls in running bond, 250 to 5000 blocks, 1 thread: exponent 1.20, at most 1.25 allowed: meets\n"));
  EXPECT_THAT(growth(blocks, [&](std::size_t i) { return 1e-4 * std::pow(blocks[i], 1.5); }),
              HasSubstr("exponent 1.50, at most 1.25 allowed: misses\n"));
  EXPECT_THAT(growth({1000, 10000, 100000}, [](std::size_t i) { return i == 0 ? 1.0 : 10.0; }), HasSubstr("exponent 0.50, "));
  EXPECT_THAT(growth({100, 1000}, [](std::size_t) { return 1.0; }), Not(HasSubstr("growth of")))
      << "below 240 blocks none counts";
}

// Without Bullet nothing stands beside; the rest is as it was.
TEST(ProfileStacks, LeavesBulletOutWhenItMayTakeNoTime) {
  const ProgramResult result = profileOf(
      {"--stacks", "wall:3x2", "--samples", "1", "--frames", "3", "--settle", "0.1", "--threads", "1", "--peer-limit", "0"});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_THAT(linesOf(result.output), Contains(AllOf(StartsWith("wall:3x2 "), HasSubstr(" meets "), EndsWith(" -"))));
}

}  // namespace
}  // namespace springtower
