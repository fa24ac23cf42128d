// `springtower run --save` and `--resume`: a run that is broken off and gone on with in another process ends in the bits of one
// that was not.
#include "tests/support/program.h"
#include "tests/support/running_program.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Json = nlohmann::ordered_json;
using Arguments = std::vector<std::string>;

ProgramResult runWith(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.begin(), "run");
  arguments.insert(arguments.end(), more.begin(), more.end());
  return runProgram("springtower", arguments);
}

// The hash at `whole_s`, in one run and in two processes of which the first ends at `half_s`.
void expectTheSameEnd(const Arguments& scene, const std::string& half_s, const std::string& rest_s, const std::string& whole_s) {
  const ScratchFolder scratch;
  const std::string report = scratch.file("report.json");
  const std::string half = scratch.file("half.run");
  ASSERT_EQ(runWith(scene, {"--seconds", whole_s, "--threads", "1", "--report", report}).exitCode, 0);
  const Json whole = Json::parse(contentOf(report));
  ASSERT_EQ(runWith(scene, {"--seconds", half_s, "--threads", "1", "--save", half}).exitCode, 0);
  const ProgramResult rest =
      runProgram("springtower", {"run", "--resume", half, "--seconds", rest_s, "--threads", "2", "--report", report});
  ASSERT_EQ(rest.exitCode, 0) << rest.error;
  const Json resumed = Json::parse(contentOf(report));
  EXPECT_EQ(resumed.at("state_hash"), whole.at("state_hash"));
  EXPECT_EQ(resumed.at("counters"), whole.at("counters"));
  EXPECT_EQ(resumed.at("wakes"), whole.at("wakes"));
  EXPECT_EQ(resumed.at("stands"), whole.at("stands"));
  EXPECT_EQ(resumed.at("fall_time_s"), whole.at("fall_time_s"));
  EXPECT_NEAR(resumed.at("simulated_s").get<double>(), std::stod(rest_s), 1e-6);
  EXPECT_NEAR(resumed.at("resumed_at_s").get<double>(), std::stod(half_s), 1e-6);
  EXPECT_EQ(whole.at("resumed_at_s"), nullptr);
}

class SaveResume : public ::testing::TestWithParam<std::string> {};

// A swaying tower with uneven rows: every method moves it in every frame.
TEST_P(SaveResume, EveryMethodGoesOnBitForBit) {
  expectTheSameEnd({"tower:3", "--heights-sigma", "0.0001", "--gravity-sway", "1:2", "--method", GetParam()}, "0.5", "0.5", "1");
}

INSTANTIATE_TEST_SUITE_P(Methods, SaveResume,
                         ::testing::Values("implicit", "implicit-euler", "implicit-eigen", "semi-implicit-euler", "midpoint",
                                           "runge-kutta-4", "report", "rigid-pgs", "rigid-lcp", "xpbd", "auto"),
                         [](const auto& test) {
                           std::string name = test.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(SaveResumeRun, AFallingTowerGoesOnBitForBit) {
  expectTheSameEnd({"tower:12", "--gravity-tilt", "20"}, "0.4", "0.6", "1");
}

// Saved after the fall: the time of it is kept.
TEST(SaveResumeRun, AFallenTowerStaysFallen) {
  expectTheSameEnd({"tower:6", "--gravity-tilt", "40"}, "1", "0.5", "1.5");
}

// All asleep when it is saved; a swaying gravity wakes them.
TEST(SaveResumeRun, SleepersGoOnBitForBit) {
  expectTheSameEnd({"tower:4"}, "2", "0.5", "2.5");
  expectTheSameEnd({"tower:2", "--gravity-sway", "0.5:0.05"}, "2", "4", "6");
}

TEST(SaveResumeRun, DrivenBlocksFrictionAndForcesGoOnBitForBit) {
  expectTheSameEnd({SPRINGTOWER_SOURCE_DIR "/scenes/annotated.toml"}, "0.5", "1", "1.5");
}

std::string sceneWithMoves(const ScratchFolder& scratch) {
  std::ofstream(scratch.file("moves.toml")) << R"TOML([tower]
code = "(111)-(1L1)-(111)"
[[moves]]
do = "take"
row = 1
position = 2
towards = "+y"
speed_m_s = 0.1
[[moves]]
do = "put"
row = 3
position = 2
)TOML";
  return scratch.file("moves.toml");
}

// In every phase of a move: while the tower settles, the block is drawn, lifted, carried, laid down, at rest.
TEST(SaveResumeRun, AHandGoesOnBitForBit) {
  const ScratchFolder scratch;
  const std::string scene = sceneWithMoves(scratch);
  for (const auto& [half, rest] : {std::pair{"0.5", "3.5"}, {"1", "3"}, {"2", "2"}, {"3", "1"}, {"3.5", "0.5"}})
    expectTheSameEnd({scene}, half, rest, "4");  // it ends of itself at 4.53 s
}

TEST(SaveResumeRun, MovesOfTheFirstProcessAreInTheReportOfTheSecond) {
  const ScratchFolder scratch;
  const std::string scene = sceneWithMoves(scratch);
  const std::string report = scratch.file("r.json");
  ASSERT_EQ(runWith({scene}, {"--seconds", "60", "--report", report}).exitCode, 0);
  const Json whole = Json::parse(contentOf(report)).at("moves");
  ASSERT_EQ(whole.size(), 2U);
  ASSERT_EQ(runWith({scene}, {"--seconds", "3", "--save", scratch.file("half")}).exitCode, 0);
  ASSERT_EQ(runWith({}, {"--resume", scratch.file("half"), "--seconds", "54", "--report", report}).exitCode, 0);
  EXPECT_EQ(Json::parse(contentOf(report)).at("moves"), whole);
}

TEST(SaveResumeRun, GoesOnManyTimesAndIntoItsOwnFile) {
  const ScratchFolder scratch;
  const std::string report = scratch.file("r.json");
  const std::string file = scratch.file("s");
  const Arguments scene = {"tower:5", "--gravity-sway", "1:2"};
  ASSERT_EQ(runWith(scene, {"--seconds", "1", "--report", report}).exitCode, 0);
  const Json whole = Json::parse(contentOf(report));
  ASSERT_EQ(runWith(scene, {"--seconds", "0.25", "--save", file}).exitCode, 0);
  for (int part = 0; part < 3; ++part)
    ASSERT_EQ(runWith({}, {"--resume", file, "--seconds", "0.25", "--save", file, "--report", report}).exitCode, 0);
  EXPECT_EQ(Json::parse(contentOf(report)).at("state_hash"), whole.at("state_hash"));
}

// What a signal has ended goes on as well, from the frame that it ended with.
TEST(SaveResumeRun, ASignalLosesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const ScratchFolder scratch;
    const Arguments scene = {"run", "tower:6", "--gravity-sway", "1:2", "--no-sleep"};
    Arguments endless = scene;
    endless.insert(endless.end(), {"--seconds", "100000", "--poses", scratch.file("p"), "--save", scratch.file("s"), "--report",
                                   scratch.file("r")});
    RunningProgram run("springtower", endless);
    run.waitForFile(scratch.file("p.partial"), 20000);
    run.send(signal);
    EXPECT_EQ(run.wait().exitCode, 128 + signal);
    const auto frames = Json::parse(contentOf(scratch.file("r"))).at("frames").get<int>();
    ASSERT_EQ(runWith({}, {"--resume", scratch.file("s"), "--seconds", "0.5", "--report", scratch.file("r")}).exitCode, 0);
    const Json resumed = Json::parse(contentOf(scratch.file("r")));
    Arguments once = scene;
    once.insert(once.end(), {"--seconds", std::to_string((frames + 30) / 60.0), "--report", scratch.file("r")});
    ASSERT_EQ(runProgram("springtower", once).exitCode, 0);
    EXPECT_EQ(resumed.at("state_hash"), Json::parse(contentOf(scratch.file("r"))).at("state_hash"));
  }
}

// A search for the equilibrium that is ended leaves the blocks as placed. A run that went on from there would be another one.
TEST(SaveResumeRun, NothingIsSavedOfARunThatHasNotBegun) {
  const ScratchFolder scratch;
  const std::string file = scratch.file("s");
  RunningProgram run("springtower", {"run", "pyramid:100", "--save", file});
  run.waitUntil([&] { return std::filesystem::exists(file + ".partial"); });
  run.send(SIGINT);
  const ProgramResult result = run.wait();
  EXPECT_EQ(result.exitCode, 130);
  EXPECT_EQ(result.error, "springtower: --save: nothing is saved of a run that was ended before its first frame\n");
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_FALSE(std::filesystem::exists(file + ".partial"));
}

void expectRefused(const ProgramResult& result, const std::string& message) {
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.output, "");
  EXPECT_THAT(result.error, StartsWith("springtower: "));
  EXPECT_THAT(result.error, HasSubstr(message));
}

TEST(SaveResumeRun, BadFilesAreNamedAndRefused) {
  const ScratchFolder scratch;
  const std::string good = scratch.file("good");
  const std::string bad = scratch.file("bad");
  ASSERT_EQ(runWith({"(010)"}, {"--seconds", "0.1", "--save", good}).exitCode, 0);
  const std::string bytes = contentOf(good);
  const auto expectBad = [&](const std::string& content, const std::string& message) {
    std::ofstream(bad, std::ios::binary) << content;
    const ProgramResult result = runWith({}, {"--resume", bad});
    expectRefused(result, message);
    EXPECT_THAT(result.error, HasSubstr(bad));
  };
  expectBad("", "expected a saved run, as springtower run --save writes it, got nothing");
  expectBad("[tower]\nrows = 3\n", "got another kind of file");
  expectBad(bytes.substr(0, bytes.size() / 2), "cut off");
  expectBad(bytes + "x", "expected nothing behind the end, got 1 bytes");
  std::string changed = bytes;
  changed[bytes.size() / 2] = static_cast<char>(changed[bytes.size() / 2] ^ 1);
  expectBad(changed, "got other bytes than were written");
  expectRefused(runWith({}, {"--resume", scratch.file("none")}),
                "expected a file that springtower has written, got none that can be read");
  expectRefused(runWith({}, {"--resume", scratch.path().string()}), "--resume");
}

TEST(SaveResumeRun, WhatWouldChangeTheRunIsRefused) {
  const ScratchFolder scratch;
  const std::string file = scratch.file("s");
  ASSERT_EQ(runWith({"(010)"}, {"--seconds", "0.1", "--save", file}).exitCode, 0);
  for (const Arguments& other : {Arguments{"(010)"},
                                 {"--method", "xpbd"},
                                 {"--no-sleep"},
                                 {"--tolerance", "1e-5"},
                                 {"--seed", "2"},
                                 {"--gravity-tilt", "3"},
                                 {"--prepare-budget", "1"}})
    expectRefused(runWith({"--resume", file}, other), "got both");
  expectRefused(runWith({}, {"--seconds", "1"}), "expected SCENE or --resume, got neither");
  expectRefused(runWith({"(010)"}, {"--save", file, "--report", file}), "got '" + file + "' for both");
  expectRefused(runWith({"(010)"}, {"--save", scratch.file("no/such/folder")}), "--save");
}

}  // namespace
}  // namespace springtower
