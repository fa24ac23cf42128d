// The program that judges random scenes, as a user runs it.
#include "tests/support/program.h"

#include "tests/support/running_program.h"
#include "tests/support/says.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

namespace springtower {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

const std::string kDiverging = SPRINGTOWER_TEST_DATA_DIR "/random/unstable.toml";

TEST(RandomScenesProgram, RefusesWhatItDoesNotKnow) {
  for (const auto& [arguments, message] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--count", "0"}, "--count"},
           {{"--limit", "nan"}, "--limit"},
           {{"--fault", "beauty"}, "--fault: expected crash, ..., got 'beauty'"},
           {{"--shrink", "/no/such"}, "--shrink: expected a folder that is there, got '/no/such'"},
           {{"--write", "1.5", "a.toml"}, "--write: expected a seed, ..., got '1.5'"},
           {{"--file", "no.toml"}, "no.toml: expected ..., got no such file"}}) {
    const ProgramResult result = runProgram("random_scenes", arguments);
    EXPECT_EQ(result.exitCode, 2) << message;
    EXPECT_THAT(result.error, says(message));
  }
}

TEST(RandomScenesProgram, WritesASceneThatCanBeRun) {
  const ScratchFolder folder;
  const std::string file = folder.file("one.toml");
  ASSERT_EQ(runProgram("random_scenes", {"--write", "11", file}).exitCode, 0);
  EXPECT_THAT(contentOf(file), StartsWith("# seed 11\n"));
  const ProgramResult result = runProgram("springtower", {"run", file, "--seconds", "0.05"});
  EXPECT_EQ(result.exitCode, 0) << result.error;
}

TEST(RandomScenesProgram, FindsThePlantedDivergence) {
  const ProgramResult result = runProgram("random_scenes", {"--file", kDiverging, "--limit", "30", "--with-program"});
  EXPECT_EQ(result.exitCode, 1) << result.error;
  EXPECT_THAT(result.output, HasSubstr("\ndiverged: block "));
  EXPECT_THAT(result.output, HasSubstr("\"program_agrees\": true"));
}

TEST(RandomScenesProgram, ShrinksAFileIntoOneThatStillFails) {
  const ScratchFolder folder;
  const ProgramResult result =
      runProgram("random_scenes", {"--file", kDiverging, "--limit", "30", "--shrink", folder.path().string()});
  EXPECT_EQ(result.exitCode, 1) << result.error;
  const std::string file = folder.file("unstable-diverged.toml");
  EXPECT_THAT(contentOf(file), StartsWith("# unstable, diverged: block "));
  EXPECT_EQ(runProgram("springtower", {"run", file}).exitCode, 3);
}

TEST(RandomScenesProgram, GivesTheSameRecordsWithAnyNumberOfJobs) {
  const ScratchFolder folder;
  std::vector<Json> found;
  for (const std::string jobs : {"1", "2"}) {
    const std::string file = folder.file("found" + jobs + ".json");
    const ProgramResult result = runProgram(
        "random_scenes", {"--from", "11", "--count", "4", "--limit", "100", "--jobs", jobs, "--json", file, "--ignore-times"});
    EXPECT_EQ(result.exitCode, 0) << result.output << result.error;
    EXPECT_THAT(result.output, HasSubstr("4 scenes from seed 11"));
    found.push_back(Json::parse(contentOf(file)).at("records"));
    for (Json& record : found.back()) record.erase("processor_s");
  }
  EXPECT_EQ(found[0].size(), 4U);
  EXPECT_EQ(found[0], found[1]);
}

TEST(RandomScenesProgram, ASignalEndsItWithTheTableOfWhatWasJudged) {
  const ScratchFolder scratch;
  RunningProgram program(
      "random_scenes", {"--from", "1", "--count", "100000", "--jobs", "2", "--limit", "1", "--json", scratch.file("found.json")});
  program.waitForFile(scratch.file("found.json.partial"), 0);
  std::this_thread::sleep_for(std::chrono::seconds(1));
  program.send(SIGINT);
  const ProgramResult result = program.wait();
  EXPECT_EQ(result.exitCode, 130);
  EXPECT_THAT(result.output, ::testing::HasSubstr(" scenes from seed 1,"));
  EXPECT_TRUE(std::filesystem::exists(scratch.file("found.json")));
}

}  // namespace
}  // namespace springtower
