// springtower profile of falls, run as a user would.
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace springtower {
namespace {

using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

ProgramResult profileFalls(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "profile");
  return runProgram("springtower", arguments);
}

TEST(ProfileFalls, RefusesWhatItDoesNotKnowAndWritesNothing) {
  const ScratchFolder scratch;
  const std::vector<std::pair<std::string, std::string>> refused = {
      {"castle:3",
       "--falls: expected topple:ROWS of 1 to 2000, towers:TOWERS of 1 to 1000, shot:ROWS of 1 to 2000, "
       "heap:BLOCKS of 1 to 20000, pile:ROWS of 1 to 100, rain:BLOCKS of 1 to 20000, got 'castle:3'"},
      {"heap", "--falls: expected ..., got 'heap'"},
      {"heap:0", "--falls: expected ..., got 'heap:0'"},
      {"heap:3x4", "--falls: expected ..., got 'heap:3x4'"},
      {"pile:101", "--falls: expected ..., got 'pile:101'"}};
  for (const auto& [fall, message] : refused) {
    const ProgramResult result = profileFalls({"--falls", fall, "--out", scratch.file("out")});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_THAT(result.error, says(message));
    EXPECT_FALSE(std::filesystem::exists(scratch.file("out")));
  }
}

// A small heap and a low tower that is hit, that all tests below read.
class FallFiles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    result_ = profileFalls({"--falls", "shot:4,heap:6", "--samples", "1", "--peer-limit", "1", "--out", path("out")});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { ASSERT_EQ(result_.exitCode, 0) << result_.error; }

  static std::string path(const std::string& name) { return folder_->file(name); }
  static Json json() { return Json::parse(contentOf(path("out/profile.json"))); }

  // What is printed of one case: a tower of 18 rows that is hit, with these figures in place of its own.
  static std::vector<std::string> printedOf(const Json& figures) {
    Json file = json();
    Json one = file.at("cases").at(0);
    one["fall"] = "shot:18";
    one["bytes_per_block"]["all"] = 4000.0;
    one.merge_patch(figures);
    file["cases"] = Json::array({one});
    std::ofstream(path("made.json")) << file;
    const ProgramResult again = profileFalls({"--from", path("made.json"), "--out", path("made")});
    EXPECT_EQ(again.exitCode, 0) << again.error;
    return linesOf(again.output);
  }

  inline static std::unique_ptr<ScratchFolder> folder_;
  inline static ProgramResult result_;
};

TEST_F(FallFiles, AreTimedWholeOnOneThreadAndTwo) {
  const Json cases = json().at("cases");
  ASSERT_EQ(cases.size(), 4U);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const Json& one = cases.at(i);
    SCOPED_TRACE(one.dump());
    EXPECT_EQ(one.at("scene"), i < 2 ? "hit" : "heaps");
    EXPECT_EQ(one.at("fall"), i < 2 ? "shot:4" : "heap:6");
    EXPECT_EQ(one.at("blocks"), i < 2 ? 13 : 6);
    EXPECT_EQ(one.at("threads"), 1 + i % 2);
    EXPECT_EQ(one.at("frames"), 180) << "three seconds";
    EXPECT_GT(one.at("max_penetration_mm").get<double>(), 0.0);
    EXPECT_LT(one.at("max_penetration_mm").get<double>(), 1.0);
    EXPECT_LT(one.at("energy_rise").get<double>(), 1e-4);
    EXPECT_EQ(one.at("peers").empty(), i % 2 == 1) << "with the first of those that share their preparation";
  }
}

TEST_F(FallFiles, StandBesideBulletWithItsSteps) {
  ASSERT_TRUE(std::filesystem::exists(std::filesystem::path(SPRINGTOWER_BINARY_DIR) / "bin" / "peers_bullet"));
  int steps = 2;
  const Json report = json();
  for (const Json& peer : report.at("cases").at(0).at("peers")) {
    SCOPED_TRACE(peer.dump());
    EXPECT_EQ(peer.at("engine"), "bullet");
    EXPECT_EQ(peer.at("substeps").get<int>(), steps *= 2);
    EXPECT_GT(peer.at("cpu_ms_median").get<double>(), 0.0);
    EXPECT_GE(peer.at("cpu_ms_max").get<double>(), peer.at("cpu_ms_median").get<double>());
  }
}

TEST_F(FallFiles, TableHasALineForEachFall) {
  EXPECT_THAT(linesOf(result_.output), Contains(ContainsRegex("^shot:4 +13 .* [0-9]+ steps, ")));
  EXPECT_THAT(linesOf(result_.output), Contains(ContainsRegex("^heap:6 +6 .* [0-9]+ steps, ")));
  const std::vector<std::string> table = linesOf(contentOf(path("out/falls.csv")));
  EXPECT_THAT(table, Contains(StartsWith("springtower,shot:4,13,implicit,5e-05,2,")));
  EXPECT_THAT(table, Contains(StartsWith("bullet,heap:6,6,,,1,4,")));
  for (const char* name : {"out/depth_shot_4.svg", "out/depth_heap_6.png", "out/depth_heap_6.pdf"})
    EXPECT_GT(contentOf(path(name)).size(), 1000U) << name;
}

// A tower of 18 rows that is hit may take 1.3 ms in the median and 2.9 in the worst frame, and get 0.5 mm deep.
TEST_F(FallFiles, JudgeAgainstWhatIsRequired) {
  const auto figures = [](double median, double worst, double depth_mm, double rise) {
    return Json{{"cpu_ms", {{"median", median}, {"p99", worst}, {"max", worst}}},
                {"max_penetration_mm", depth_mm},
                {"energy_rise", rise}};
  };
  EXPECT_THAT(printedOf(figures(0.7, 1.9, 0.4, 1e-6)), Contains(ContainsRegex("^shot:18 .* meets, goal too ")));
  EXPECT_THAT(printedOf(figures(1.2, 1.9, 0.4, 1e-6)), Contains(ContainsRegex("^shot:18 .* meets  ")));
  EXPECT_THAT(printedOf(figures(1.4, 3.0, 0.6, 2e-4)),
              Contains(ContainsRegex("^shot:18 .* misses: median, worst, depth, energy  ")));
  Json large = figures(0.7, 1.9, 0.4, 1e-6);
  large["bytes_per_block"] = {{"all", 9000.0}};
  EXPECT_THAT(printedOf(large), Contains(ContainsRegex("^shot:18 .* misses: memory  ")));
}

}  // namespace
}  // namespace springtower
