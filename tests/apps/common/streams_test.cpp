// Standard output and standard error that take nothing, and names of files that are no text.
#include "tests/support/running_program.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

const std::string kFull = "/dev/full";

int exitCodeOf(std::string_view program, const std::vector<std::string>& arguments, const Streams& streams) {
  return RunningProgram(program, arguments, streams).wait().exitCode;
}

TEST(Streams, AComplaintThatNobodyHearsIsStillBadInput) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("list.jsonl"))
      << "{\"id\":\"a\",\"config\":\"(111)\",\"expect\":{\"stands\":true,\"clear\":true}}\n";
  for (const std::string& error : {kFull, std::string(kClosed)}) {
    SCOPED_TRACE(error);
    EXPECT_EQ(exitCodeOf("springtower", {"run", "nofile.toml"}, {.error = error}), 2);
    EXPECT_EQ(exitCodeOf("springtower", {"run"}, {.error = error}), 2);
    EXPECT_EQ(exitCodeOf("springtower", {"verdict", scratch.file("list.jsonl"), "--check"}, {.error = error}), 2);
    EXPECT_EQ(exitCodeOf("springtower-viewer", {"--headless", "--scene", "nofile.toml"}, {.error = error}), 2);
    EXPECT_EQ(exitCodeOf("ccd_queries", {"nofile.csv", "--kind", "vf"}, {.error = error}), 2);
  }
}

TEST(Streams, OutputThatNobodyGetsIsBadInput) {
  for (const std::string& output : {kFull, std::string(kClosed)}) {
    SCOPED_TRACE(output);
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {"scenes"}, {"settings", "--all"}, {"--help"}, {"run", "(010)", "--seconds", "0.1"}}) {
      EXPECT_EQ(exitCodeOf("springtower", arguments, {.output = output}), 2) << arguments[0];
      EXPECT_EQ(exitCodeOf("springtower", arguments, {.output = output, .error = output}), 2) << arguments[0];
    }
  }
}

// The table of what was timed until the signal came is lost.
TEST(Streams, OutputThatNobodyGetsIsBadInputAfterASignalAsWell) {
  const ScratchFolder scratch;
  RunningProgram profile("springtower",
                         {"profile", "--scenes", "rest,collapse", "--rows", "1,3", "--methods", "implicit", "--settle", "0.1",
                          "--samples", "1000", "--frames", "10", "--out", scratch.file("out")},
                         {.output = kFull});
  profile.waitForFile(scratch.file("out/profile.unfinished.json"));
  profile.send(SIGINT);
  EXPECT_EQ(profile.wait().exitCode, 2);
}

// The first file that is opened would take the number of a closed standard error, and get what is written there.
TEST(Streams, AClosedOneIsNotMistakenForAFile) {
  const ScratchFolder scratch;
  const std::string closed(kClosed);
  EXPECT_EQ(exitCodeOf("springtower", {"run", "(010)", "--seconds", "0.1", "--report", scratch.file("r")},
                       {.output = closed, .error = closed}),
            2);
  EXPECT_TRUE(Json::accept(contentOf(scratch.file("r"))));
}

TEST(Streams, AClosedInputIsNoEmptyList) {
  RunningProgram verdict("springtower", {"verdict", "-"}, {.input = std::string(kClosed)});
  const ProgramResult result = verdict.wait();
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, ::testing::HasSubstr("standard input: expected a file that can be read, got one that cannot"));
}

// /dev/full takes what is written to it as a full disk does.
TEST(Streams, AFullDiskIsNamedWithTheFileThatFoundItSo) {
  const ScratchFolder scratch;
  const std::string picture = scratch.file("a.png");
  std::filesystem::create_symlink(kFull, picture);
  for (const auto& [option, file] :
       {std::pair<std::string, std::string>{"--picture", picture}, {"--report", kFull}, {"--poses", kFull}}) {
    const ProgramResult result = runProgram("springtower", {"run", "(010)", "--seconds", "0.1", option, file});
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.error,
                ::testing::HasSubstr(option + ": expected a file that can be written, got '" + file + "': writing failed"));
  }
}

TEST(Streams, NamesThatAreNoTextAreNamesAllTheSame) {
  const ScratchFolder scratch;
  const std::string scene = scratch.file("bad\xff.toml");
  std::ofstream(scene) << "[[block]]\ncentre_m = [0.0, 0.0, 0.0091]\n";
  const ProgramResult run = runProgram(
      "springtower", {"run", scene, "--seconds", "0.1", "--report", scratch.file("a\xff"), "--poses", scratch.file("p\xff")});
  EXPECT_EQ(run.exitCode, 0) << run.error;
  EXPECT_THAT(Json::parse(contentOf(scratch.file("a\xff"))).at("scene").get<std::string>(),
              ::testing::HasSubstr("bad\xef\xbf\xbd"));
  const ProgramResult statics = runProgram("springtower", {"statics", scene, "--report", scratch.file("s")});
  EXPECT_EQ(statics.exitCode, 0) << statics.error;
  EXPECT_TRUE(Json::accept(contentOf(scratch.file("s"))));
  const ProgramResult record = runProgram("springtower-viewer", {"--headless", "--scene", scene, "--frames", "10", "--record",
                                                                 scratch.file("game\xff"), "--report", scratch.file("v")});
  EXPECT_EQ(record.exitCode, 0) << record.error;
  EXPECT_TRUE(Json::accept(contentOf(scratch.file("v"))));
  const ProgramResult replay =
      runProgram("springtower-viewer", {"--headless", "--replay", scratch.file("game\xff"), "--report", scratch.file("w")});
  EXPECT_EQ(replay.exitCode, 0) << replay.error;
  EXPECT_EQ(Json::parse(contentOf(scratch.file("w"))).at("state_hash"),
            Json::parse(contentOf(scratch.file("v"))).at("state_hash"));
}

}  // namespace
}  // namespace springtower
