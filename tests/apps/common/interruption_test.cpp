// Signals in the middle of the programs' work: what is done is kept, whole, under its name, and nothing else is left.
#include "tests/apps/common/changed_tolerance.h"
#include "tests/support/running_program.h"
#include "tests/support/says.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace springtower {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;
using Json = nlohmann::ordered_json;

std::set<std::string> filesIn(const ScratchFolder& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) names.insert(entry.path().filename().string());
  return names;
}

// A run without an end in sight, whose poses soon fill more than a buffer.
std::vector<std::string> endlessRun(const ScratchFolder& scratch) {
  return {"run",     "tower:3",         "--seconds",     "1000000", "--no-sleep", "--report",           scratch.file("r.json"),
          "--poses", scratch.file("p"), "--poses-every", "0.1",     "--picture",  scratch.file("a.png")};
}

class InterruptedBy : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Interruption, InterruptedBy, ::testing::Values(SIGINT, SIGTERM));

TEST_P(InterruptedBy, ARunEndsWithAllItsFiles) {
  const ScratchFolder scratch;
  RunningProgram run("springtower", endlessRun(scratch));
  run.waitForFile(scratch.file("p.partial"), 20000);
  run.send(GetParam());
  const ProgramResult result = run.wait();
  EXPECT_EQ(result.exitCode, 128 + GetParam()) << result.error;
  EXPECT_THAT(result.output, HasSubstr("interrupted"));
  EXPECT_THAT(filesIn(scratch), UnorderedElementsAre("r.json", "p", "a.png"));
  const Json report = Json::parse(contentOf(scratch.file("r.json")));
  EXPECT_EQ(report.at("interrupted"), true);
  const double simulated_s = report.at("simulated_s").get<double>();
  EXPECT_NEAR(simulated_s, report.at("frames").get<double>() / 60.0, 1e-6 * simulated_s);
  EXPECT_THAT(contentOf(scratch.file("a.png")), StartsWith("\x89PNG"));
  const std::string poses = contentOf(scratch.file("p"));
  EXPECT_TRUE(poses.ends_with('\n'));
  const std::string last = linesOf(poses).back();
  EXPECT_EQ(std::count(last.begin(), last.end(), ','), 25);
  EXPECT_NEAR(std::stod(last), simulated_s, 0.1) << "one every tenth of a second, up to the end";
}

TEST(Interruption, ARunThatEndsByItselfSaysSo) {
  const ScratchFolder scratch;
  ASSERT_EQ(runProgram("springtower", {"run", "(010)", "--seconds", "0.1", "--report", scratch.file("r")}).exitCode, 0);
  EXPECT_EQ(Json::parse(contentOf(scratch.file("r"))).at("interrupted"), false);
}

// The first frame of such a wall takes minutes, and no frame is broken off by a first signal.
TEST(Interruption, ASecondSignalEndsAtOnce) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("r.json")) << "old";
  // As placed, a pyramid's first frame takes minutes.
  RunningProgram run("springtower", {"run", "pyramid:100", "--prepare-budget", "0", "--report", scratch.file("r.json")});
  run.waitUntil([&] { return std::filesystem::exists(scratch.file("r.json.partial")); });
  std::this_thread::sleep_for(500ms);
  run.send(SIGINT);
  std::this_thread::sleep_for(300ms);
  EXPECT_TRUE(run.isRunning());
  run.send(SIGTERM);
  EXPECT_EQ(run.wait().exitCode, 143);
  EXPECT_EQ(contentOf(scratch.file("r.json")), "old");
}

TEST(Interruption, ASignalEndsTheSearchForTheEquilibrium) {
  const ScratchFolder scratch;
  RunningProgram run("springtower", {"run", "pyramid:100", "--report", scratch.file("r.json")});
  run.waitUntil([&] { return std::filesystem::exists(scratch.file("r.json.partial")); });
  std::this_thread::sleep_for(500ms);
  run.send(SIGINT);
  EXPECT_EQ(run.wait().exitCode, 130);
  const std::string report = contentOf(scratch.file("r.json"));
  EXPECT_THAT(report, HasSubstr("\"interrupted\": true"));
  EXPECT_THAT(report, HasSubstr("\"end\": \"cancelled\""));
  EXPECT_THAT(report, HasSubstr("\"frames\": 0"));
}

TEST(Interruption, AKilledRunLeavesWholeLinesAndTheOldFile) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("p")) << "old";
  {
    RunningProgram run("springtower", endlessRun(scratch));
    run.waitForFile(scratch.file("p.partial"), 20000);
    run.send(SIGKILL);
    EXPECT_EQ(run.wait().exitCode, -SIGKILL);
  }
  EXPECT_EQ(contentOf(scratch.file("p")), "old");
  std::vector<std::string> lines = linesOf(contentOf(scratch.file("p.partial")));
  lines.pop_back();
  EXPECT_GT(lines.size(), 20U);
  for (const std::string& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 25) << line;
  ASSERT_EQ(runProgram("springtower", {"run", "(010)", "--seconds", "0.1", "--poses", scratch.file("p")}).exitCode, 0);
  EXPECT_THAT(linesOf(contentOf(scratch.file("p"))), SizeIs(1 + 7));
  EXPECT_FALSE(std::filesystem::exists(scratch.file("p.partial"))) << "the next run takes its place";
}

TEST(Interruption, TwoProcessesMayWriteTheSameFile) {
  const ScratchFolder scratch;
  RunningProgram first("springtower", endlessRun(scratch));
  first.waitForFile(scratch.file("p.partial"), 20000);
  ASSERT_EQ(runProgram("springtower", {"run", "(010)", "--seconds", "0.1", "--poses", scratch.file("p")}).exitCode, 0);
  EXPECT_THAT(linesOf(contentOf(scratch.file("p"))), SizeIs(1 + 7));
  first.send(SIGTERM);
  EXPECT_EQ(first.wait().exitCode, 143);
  EXPECT_GT(linesOf(contentOf(scratch.file("p"))).size(), 8U) << "the last one that finishes has the name";
  EXPECT_THAT(filesIn(scratch), UnorderedElementsAre("r.json", "p", "a.png"));
}

TEST(Interruption, ASingleSceneOfStaticsEndsWithItsReport) {
  const ScratchFolder scratch;
  RunningProgram statics("springtower", {"statics", "tower:40", "--report", scratch.file("r.json")});
  statics.waitUntil([&] { return std::filesystem::exists(scratch.file("r.json.partial")); });
  statics.send(SIGINT);
  EXPECT_EQ(statics.wait().exitCode, 130);
  EXPECT_EQ(Json::parse(contentOf(scratch.file("r.json"))).at("interrupted"), true);
  EXPECT_THAT(filesIn(scratch), UnorderedElementsAre("r.json"));
}

// A pipe to the program, that lines come through one by one.
class Feed {
 public:
  explicit Feed(const ScratchFolder& scratch) : path_(scratch.file("feed")) {
    if (mkfifo(path_.c_str(), 0600) != 0) throw std::runtime_error("no pipe");
    pipe_ = ::open(path_.c_str(), O_RDWR);  // both ends, so that neither waits for the other
  }
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;
  ~Feed() { end(); }
  [[nodiscard]] const std::string& path() const { return path_; }
  void line(const std::string& text) const {
    const std::string whole = text + "\n";
    EXPECT_EQ(::write(pipe_, whole.data(), whole.size()), static_cast<ssize_t>(whole.size()));
  }
  void end() {
    if (pipe_ >= 0) ::close(pipe_);
    pipe_ = -1;
  }

 private:
  std::string path_;
  int pipe_ = -1;
};

class ListOf : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Interruption, ListOf, ::testing::Values("verdict", "statics"),
                         [](const auto& tested) { return tested.param; });

TEST_P(ListOf, TowersIsAnsweredLineByLineAndKeepsThoseOnASignal) {
  const ScratchFolder scratch;
  const Feed feed(scratch);
  RunningProgram list("springtower", {GetParam(), "-", "--threads", "2"}, {.input = feed.path()});
  feed.line("{\"id\":\"a\",\"config\":\"(111)\"}");
  list.waitUntil([&] { return linesOf(list.output()).size() == 1; });
  feed.line("{\"id\":\"b\",\"config\":\"(010)\"}");
  list.waitUntil([&] { return linesOf(list.output()).size() == 2; });
  list.send(SIGINT);  // while it waits for more
  const ProgramResult result = list.wait();
  EXPECT_EQ(result.exitCode, 130) << result.error;
  EXPECT_EQ(Json::parse(linesOf(result.output).at(1)).at("id"), "b");
}

TEST_P(ListOf, TowersStopsAtABadLineWhenThoseBeforeItAreDone) {
  const std::string lines =
      "{\"id\":\"a\",\"config\":\"(111)\"}\n{\"id\":\"b\",\"config\":\"(010)\"}\nno "
      "json\n{\"id\":\"d\",\"config\":\"(010)\"}\n";
  for (const char* threads : {"1", "3"}) {
    const ProgramResult result = runProgram("springtower", {GetParam(), "-", "--threads", threads}, lines);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(linesOf(result.output), SizeIs(2)) << result.output;
    EXPECT_THAT(result.error, says("standard input: line 3: expected ..., got 'no json'"));
  }
}

// A list of four lines of which two are bad, without an end at the first of these.
ProgramResult goneOn(const std::string& command, const std::string& list, const char* threads) {
  ProgramResult result = runProgram("springtower", {command, list, "--keep-going", "--threads", threads});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, HasSubstr("2 of 4 lines were bad"));
  return result;
}

std::vector<std::string> idsOf(const ProgramResult& result) {
  std::vector<std::string> ids;
  for (const std::string& line : linesOf(result.output)) ids.push_back(Json::parse(line).at("id").get<std::string>());
  return ids;
}

TEST_P(ListOf, TowersGoesOnAfterBadLinesWhenToldTo) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("list.jsonl")) << "{\"id\":\"a\",\"config\":\"(111)\"}\nno json\n\n"
                                               "{\"id\":\"a\",\"config\":\"(010)\"}\n{\"id\":\"d\",\"config\":\"(010)\"}";
  for (const char* threads : {"1", "3"}) {
    const ProgramResult result = goneOn(GetParam(), scratch.file("list.jsonl"), threads);
    EXPECT_EQ(idsOf(result), std::vector<std::string>({"a", "d"})) << result.output;
    EXPECT_THAT(result.error, says("list.jsonl: line 2: expected ..., got 'no json'"));
    EXPECT_THAT(result.error, says("list.jsonl: line 4: id: expected ..., got 'a' for the second time"));
  }
}

// A long line is one bad line, of which no more is kept than shows that; without a line end nothing comes behind it.
TEST_P(ListOf, TowersGoesOnAfterALongLineWhenToldTo) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("list.jsonl")) << "{\"id\":\"a\",\"config\":\"(111)\"}\n"
                                            << std::string(std::size_t{3} << 19U, ' ')
                                            << "\n{\"id\":\"b\",\"config\":\"(010)\"}\n"
                                            << std::string((std::size_t{1} << 20U) + 1, ' ') << '\n';
  for (const char* threads : {"1", "3"}) {
    const ProgramResult result = goneOn(GetParam(), scratch.file("list.jsonl"), threads);
    EXPECT_EQ(idsOf(result), std::vector<std::string>({"a", "b"})) << result.output;
    EXPECT_THAT(result.error, HasSubstr("list.jsonl: line 2: expected at most 1 MB in a line, got more"));
    EXPECT_THAT(result.error, HasSubstr("list.jsonl: line 4: expected at most 1 MB in a line, got more"));
  }
}

TEST(Interruption, AListWithoutLineEndsIsNotReadForEver) {
  const ProgramResult endless = runProgram("springtower", {"verdict", "/dev/zero", "--keep-going"});
  EXPECT_EQ(endless.exitCode, 2);
  EXPECT_THAT(endless.error, HasSubstr("/dev/zero: line 1: expected its end within 64 MB, got none"));
}

// The bad line is found by its job, while another thread waits for a line that does not come.
TEST(Interruption, ABadLineIsReportedWhileTheNextIsWaitedFor) {
  const ScratchFolder scratch;
  const Feed feed(scratch);
  RunningProgram list(
      "springtower",
      {"verdict", "-", "--threads", "2", "--method", "semi-implicit-euler", "--substeps", "1", "--tolerance", "1e-5"},
      {.input = feed.path()});
  feed.line("{\"id\":\"a\",\"config\":\"(111)\"}");
  const ProgramResult result = list.wait();
  EXPECT_EQ(result.exitCode, 2) << result.error;
  EXPECT_THAT(result.error, HasSubstr("standard input: line 1"));
}

TEST(Interruption, OneSignalEndsAListThatNobodyWrites) {
  const ScratchFolder scratch;
  ASSERT_EQ(mkfifo(scratch.file("list.jsonl").c_str(), 0600), 0);
  RunningProgram list("springtower", {"statics", scratch.file("list.jsonl")});
  std::this_thread::sleep_for(300ms);
  EXPECT_TRUE(list.isRunning()) << "it waits for who writes";
  list.send(SIGINT);
  EXPECT_EQ(list.wait().exitCode, 130);
}

TEST(Interruption, AListThatIsWrittenLateIsAnswered) {
  const ScratchFolder scratch;
  ASSERT_EQ(mkfifo(scratch.file("list.jsonl").c_str(), 0600), 0);
  RunningProgram list("springtower", {"statics", scratch.file("list.jsonl")});
  std::this_thread::sleep_for(300ms);
  std::ofstream(scratch.file("list.jsonl")) << "{\"id\":\"a\",\"config\":\"(111)\"}\n";
  const ProgramResult result = list.wait();
  EXPECT_EQ(result.exitCode, 0) << result.error;
  EXPECT_THAT(linesOf(result.output), SizeIs(1));
}

// 12 rows by fine explicit steps take seconds; the first line is done long before.
TEST(Interruption, AVerdictUnderWayIsNotPrinted) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("list.jsonl"))
      << "{\"id\":\"a\",\"config\":\"(001)-(010)\"}\n"
         "{\"id\":\"b\",\"config\":\"(111)-(111)-(111)-(111)-(111)-(111)-(111)-(111)-(111)-(111)-(111)-(111)\"}\n"
         "{\"id\":\"c\",\"config\":\"(001)-(010)\"}\n";
  RunningProgram list("springtower", {"verdict", scratch.file("list.jsonl"), "--threads", "2", "--method", "semi-implicit-euler",
                                      "--tolerance", "1e-6", "--no-sleep"});
  list.waitUntil([&] { return !linesOf(list.output()).empty(); });
  list.send(SIGTERM);
  const ProgramResult result = list.wait();
  EXPECT_EQ(result.exitCode, 143) << result.error;
  EXPECT_THAT(linesOf(result.output), SizeIs(1)) << "the beginning of the answers, without gaps";
}

TEST(Interruption, ARecordingIsKeptAndCanBeReplayed) {
  const ScratchFolder scratch;
  const std::vector<std::string> play = {"--headless", "--scene",
                                         "tower:3",    "--frames",
                                         "10000000",   "--no-sleep",
                                         "--record",   scratch.file("game"),
                                         "--report",   scratch.file("r.json")};
  {
    RunningProgram viewer("springtower-viewer", play);
    viewer.waitForFile(scratch.file("game.partial"), 10000);
    viewer.send(SIGTERM);
    const ProgramResult result = viewer.wait();
    EXPECT_EQ(result.exitCode, 143) << result.error;
  }
  EXPECT_THAT(filesIn(scratch), UnorderedElementsAre("game", "r.json"));
  const Json report = Json::parse(contentOf(scratch.file("r.json")));
  EXPECT_EQ(report.at("interrupted"), true);
  EXPECT_THAT(linesOf(contentOf(scratch.file("game"))), SizeIs(1 + report.at("frames").get<std::size_t>()));
  EXPECT_EQ(runProgram("springtower-viewer", {"--headless", "--replay", scratch.file("game")}).exitCode, 0);
}

TEST(Interruption, ASignalEndsTheSearchOfTheViewerToo) {
  const ScratchFolder scratch;
  RunningProgram viewer("springtower-viewer", {"--headless", "--scene", "pyramid:100", "--report", scratch.file("r.json"),
                                               "--record", scratch.file("game")});
  viewer.waitUntil([&] { return std::filesystem::exists(scratch.file("game.partial")); });
  std::this_thread::sleep_for(500ms);
  viewer.send(SIGTERM);
  const ProgramResult result = viewer.wait();
  EXPECT_EQ(result.exitCode, 143) << result.error;
  const Json report = Json::parse(contentOf(scratch.file("r.json")));
  EXPECT_EQ(report.at("interrupted"), true);
  EXPECT_EQ(report.at("frames"), 0);
}

// Another tolerance is another simulation, which searches for its own equilibrium in the middle of a game.
TEST(Interruption, ASignalEndsTheSearchThatAnotherToleranceBeginsWith) {
  const ScratchFolder scratch;
  const std::string game = scratch.file("game");
  writeChangeOfTolerance(game);
  RunningProgram viewer("springtower-viewer", {"--headless", "--replay", game, "--report", scratch.file("r.json"), "--png",
                                               scratch.file("pictures"), "--size", "64x64"});
  viewer.waitForFile(scratch.file("pictures/frame-00001.png"), 1);
  std::this_thread::sleep_for(200ms);
  viewer.send(SIGTERM);
  const ProgramResult result = viewer.wait();
  EXPECT_EQ(result.exitCode, 143) << result.error;
  const Json report = Json::parse(contentOf(scratch.file("r.json")));
  EXPECT_EQ(report.at("interrupted"), true);
  EXPECT_EQ(report.at("frames"), 1) << "the frame whose search was ended is not stepped";
  EXPECT_EQ(report.at("frames_stepped"), 1);
  EXPECT_TRUE(report.at("replay_differs_in_frame").is_null());
  const ProgramResult whole = runProgram(
      "springtower-viewer", {"--headless", "--scene", "pyramid:80", "--frames", "1", "--report", scratch.file("whole.json")});
  EXPECT_EQ(whole.exitCode, 0) << whole.error;
  EXPECT_EQ(report.at("state_hash"), Json::parse(contentOf(scratch.file("whole.json"))).at("state_hash"));
}

TEST(Interruption, AKilledViewerLeavesARecordingThatCanBeReplayed) {
  const ScratchFolder scratch;
  const std::string partial = scratch.file("game.partial");
  {
    RunningProgram viewer("springtower-viewer", {"--headless", "--scene", "tower:3", "--frames", "10000000", "--no-sleep",
                                                 "--record", scratch.file("game")});
    viewer.waitForFile(partial, 10000);
    viewer.send(SIGKILL);
    EXPECT_EQ(viewer.wait().exitCode, -SIGKILL);
  }
  const std::string text = contentOf(partial);
  const std::vector<std::string> lines = linesOf(text);
  const std::string where = "line " + std::to_string(lines.size());
  std::ofstream(partial, std::ios::binary) << text.substr(0, text.rfind('{') + 5);
  const ProgramResult replay =
      runProgram("springtower-viewer", {"--headless", "--replay", partial, "--report", scratch.file("r.json")});
  EXPECT_EQ(replay.exitCode, 0) << replay.error;
  EXPECT_THAT(replay.error, HasSubstr(where + ": the line is cut off; the " + std::to_string(lines.size() - 2) + " frames"));
  EXPECT_EQ(Json::parse(contentOf(scratch.file("r.json"))).at("frames"), lines.size() - 2);
}

}  // namespace
}  // namespace springtower
