// Commands that measure many cases go on where a signal has ended them, with what is of the same build, machine and options.
#include "tests/apps/common/resume.h"

#include "core/version.h"
#include "tests/support/running_program.h"

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using Json = nlohmann::ordered_json;

Json jsonOf(const std::string& path) {
  return Json::parse(contentOf(path));
}

// As if another build had written it.
void forge(const std::string& path, const std::string& commit = "another") {
  Json json = jsonOf(path);
  json["commit"] = commit;
  std::ofstream(path) << json.dump();
}

// Runs a command until a file is there, and ends it then. Returns the exit code.
int brokenOff(const std::vector<std::string>& arguments, const std::string& file, int signal) {
  RunningProgram program("springtower", arguments);
  program.waitForFile(file);
  program.send(signal);
  return program.wait().exitCode;
}

ProgramResult run(std::vector<std::string> arguments, const std::vector<std::string>& more = {}) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return runProgram("springtower", arguments);
}

TEST(Resume, ProfileKeepsTheScenesThatAreDone) {
  const ScratchFolder scratch;
  const std::string kept = scratch.file("out/profile.unfinished.json");
  const std::vector<std::string> profile = {"profile",   "--scenes", "rest,collapse",    "--rows", "2,6",
                                            "--methods", "implicit", "--settle",         "0.5",    "--samples",
                                            "40",        "--out",    scratch.file("out")};
  ASSERT_EQ(brokenOff(profile, kept, SIGINT), 130);
  const Json then = jsonOf(kept);
  ASSERT_THAT(then.at("cases"), SizeIs(2));
  EXPECT_FALSE(std::filesystem::exists(scratch.file("out/profile.json")));

  if (!wentOn(run(profile))) return;
  const Json now = jsonOf(scratch.file("out/profile.json"));
  ASSERT_THAT(now.at("cases"), SizeIs(4));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(now.at("cases")[i], then.at("cases")[i]) << "not timed again";
  EXPECT_FALSE(std::filesystem::exists(kept));

  std::ofstream(kept) << then.dump();
  forge(kept);
  const ProgramResult stale = run(profile);
  EXPECT_EQ(stale.exitCode, 2);
  EXPECT_THAT(stale.error, HasSubstr("another build"));
  EXPECT_THAT(stale.error, HasSubstr("--no-resume"));
  forge(kept, std::string(kGitCommit) + "-dirty");
  EXPECT_THAT(run(profile).error, HasSubstr("the build that measured them has uncommitted changes"));
  forge(kept, "unknown");
  EXPECT_THAT(run(profile).error, HasSubstr("the build that measured them was built outside a git clone"));
  std::ofstream(kept) << then.dump();
  EXPECT_EQ(run(profile, {"--samples", "1"}).exitCode, 2) << "other limits";
}

TEST(Resume, ValidateKeepsThePartsThatAreDone) {
  const ScratchFolder scratch;
  const std::string kept = scratch.file("out/validation.unfinished.json");
  const std::vector<std::string> validate = {"validate",
                                             "--oracle",
                                             std::string(SPRINGTOWER_TEST_DATA_DIR) + "/oracle",
                                             "--scenes",
                                             std::string(SPRINGTOWER_SOURCE_DIR) + "/scenes",
                                             "--only",
                                             "forces,pull",
                                             "--out",
                                             scratch.file("out")};
  ASSERT_EQ(brokenOff(validate, kept, SIGTERM), 143);
  const Json then = jsonOf(kept);
  ASSERT_THAT(then.at("parts"), SizeIs(1));

  forge(kept);
  EXPECT_EQ(run(validate).exitCode, 2);
  std::ofstream(kept) << then.dump();
  EXPECT_EQ(run(validate, {"--long"}).exitCode, 2) << "the long form is another";

  const ProgramResult again = run(validate);
  if (!wentOn(again)) return;
  const std::vector<std::string> lines = linesOf(again.output);
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(), [](const std::string& line) { return line.ends_with(" s) (kept)"); }), 1)
      << again.output;
  const Json sections = jsonOf(scratch.file("out/validation.json")).at("sections");
  ASSERT_THAT(sections, SizeIs(2));
  EXPECT_EQ(sections[0].at("wall_s"), then.at("parts")[0].at("wall_s")) << "not measured again";
  EXPECT_EQ(sections[0].at("claims"), then.at("parts")[0].at("claims"));
  EXPECT_TRUE(std::filesystem::exists(scratch.file("out/pull.svg")));
  EXPECT_FALSE(std::filesystem::exists(kept));
}

TEST(Resume, ChartKeepsTheScenesThatAreDone) {
  const ScratchFolder scratch;
  const std::vector<std::string> chart = {
      "chart",    "--quick", "--rows",           "3", "--scenes", "uniform,heights,heavy-light", "--methods",
      "implicit", "--out",   scratch.file("out")};
  ASSERT_EQ(brokenOff(chart, scratch.file("out/chart.json"), SIGINT), 130);
  const Json then = jsonOf(scratch.file("out/chart.json"));
  EXPECT_EQ(then.at("interrupted"), true);
  if (!wentOn(run(chart))) return;
  const Json now = jsonOf(scratch.file("out/chart.json"));
  EXPECT_EQ(now.at("interrupted"), false);
  ASSERT_GT(now.at("cases").size(), then.at("cases").size());
  for (std::size_t i = 0; i < then.at("cases").size(); ++i) EXPECT_EQ(now.at("cases")[i], then.at("cases")[i]);
}

TEST(Resume, MapsKeepTheRowsThatAreDone) {
  const ScratchFolder scratch;
  const std::string kept = scratch.file("out/maps.unfinished.json");
  const std::vector<std::string> maps = {"chart",     "--maps", "--quick", "--methods",        "implicit,report,rigid-pgs",
                                         "--seconds", "4",      "--out",   scratch.file("out")};
  ASSERT_EQ(brokenOff(maps, kept, SIGINT), 130);
  Json then = jsonOf(kept);
  ASSERT_GE(then.at("map_rows").size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(scratch.file("out/maps.csv")));
  forge(kept);
  EXPECT_EQ(run(maps).exitCode, 2) << "another build";

  then["map_rows"][0]["points"][0]["step_s"] = 0.12345;  // so that it can be seen that this row is not measured again
  std::ofstream(kept) << then.dump();
  if (!wentOn(run(maps))) return;
  EXPECT_THAT(contentOf(scratch.file("out/maps.csv")), HasSubstr("0.12345"));
  EXPECT_FALSE(std::filesystem::exists(kept));
}

std::vector<std::string> shortProfile(const ScratchFolder& scratch, const std::string& rows) {
  return {"profile", "--scenes", "rest", "--rows",   rows,  "--methods", "implicit",         "--samples",
          "1",       "--frames", "2",    "--settle", "0.1", "--out",     scratch.file("out")};
}

TEST(Resume, NoResumeBeginsAnew) {
  const ScratchFolder scratch;
  const std::string kept = scratch.file("out/profile.unfinished.json");
  std::filesystem::create_directories(scratch.file("out"));
  const std::vector<std::string> profile = shortProfile(scratch, "1");
  for (const char* flag : {"--no-resume", "--fresh"}) {
    std::ofstream(kept) << "{}";
    EXPECT_EQ(run(profile).exitCode, 2);
    EXPECT_EQ(run(profile, {flag}).exitCode, 0);
    EXPECT_FALSE(std::filesystem::exists(kept));
  }
  std::ofstream(scratch.file("out/validation.unfinished.json")) << "{}";
  const std::vector<std::string> validate = {"validate",
                                             "--only",
                                             "pull",
                                             "--oracle",
                                             std::string(SPRINGTOWER_TEST_DATA_DIR) + "/oracle",
                                             "--scenes",
                                             std::string(SPRINGTOWER_SOURCE_DIR) + "/scenes",
                                             "--out",
                                             scratch.file("out")};
  EXPECT_THAT(run(validate).error, HasSubstr("--no-resume"));
}

// What another run was broken off with is still there after a run of other cases, traced or not.
TEST(Resume, ProfileLeavesTheCasesOfOtherRuns) {
  const ScratchFolder scratch;
  const std::string kept = scratch.file("out/profile.unfinished.json");
  ASSERT_EQ(run(shortProfile(scratch, "1,2")).exitCode, 0);
  const Json others = jsonOf(scratch.file("out/profile.json"));
  std::ofstream(kept) << others.dump();
  if (!wentOn(run(shortProfile(scratch, "3"), {"--trace", scratch.file("trace.json")}))) return;
  ASSERT_THAT(jsonOf(kept).at("cases"), SizeIs(3));
  ASSERT_EQ(run(shortProfile(scratch, "4")).exitCode, 0);
  ASSERT_THAT(jsonOf(kept).at("cases"), SizeIs(4));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(jsonOf(kept).at("cases")[i], others.at("cases")[i]);
  ASSERT_EQ(run(shortProfile(scratch, "1,2,3,4")).exitCode, 0);
  EXPECT_FALSE(std::filesystem::exists(kept)) << "all of them are done";
  EXPECT_EQ(jsonOf(scratch.file("out/profile.json")).at("cases")[0], others.at("cases")[0]) << "not timed again";
}

}  // namespace
}  // namespace springtower
