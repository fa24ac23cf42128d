// The viewer without a window: pictures, films, and what it says to bad arguments.
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using ::testing::HasSubstr;

// A PNG's size, from its header.
std::pair<int, int> sizeOf(const std::string& png) {
  EXPECT_TRUE(png.starts_with("\x89PNG"));
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = 256 * value + static_cast<unsigned char>(png.at(at + i));
    return value;
  };
  return {number(16), number(20)};
}

/// The search path for programs, for a while.
class SearchPath {
 public:
  explicit SearchPath(const std::string& path) : before_(std::getenv("PATH")) { setenv("PATH", path.c_str(), 1); }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;
  ~SearchPath() { setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

TEST(ViewerHeadless, WritesPicturesOfTheFramesAskedFor) {
  const ScratchFolder scratch;
  for (const char* overlay : {"wood", "load", "strain", "asleep", "islands", "hints"}) {
    const std::string folder = scratch.file(overlay);
    const ProgramResult result =
        runProgram("springtower-viewer", {"--headless", "--scene", "(111)-(1L1)", "--frames", "5", "--png-every", "2", "--png",
                                          folder, "--size", "160x120", "--overlay", overlay, "--arrows"});
    ASSERT_EQ(result.exitCode, 0) << result.error;
    for (const char* name : {"frame-00002.png", "frame-00004.png", "frame-00005.png"}) {
      EXPECT_EQ(sizeOf(contentOf(std::filesystem::path(folder) / name)), std::pair(160, 120)) << name;
    }
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 3);
  }
  EXPECT_NE(contentOf(scratch.path() / "wood/frame-00005.png"), contentOf(scratch.path() / "load/frame-00005.png"));
}

TEST(ViewerHeadless, AgreesWithTheCommandLineProgram) {
  const ScratchFolder scratch;
  ASSERT_EQ(runProgram("springtower-viewer",
                       {"--headless", "--scene", "(111)-(1L1)", "--frames", "60", "--report", scratch.file("a.json")})
                .exitCode,
            0);
  ASSERT_EQ(runProgram("springtower", {"run", "(111)-(1L1)", "--seconds", "1", "--report", scratch.file("b.json")}).exitCode, 0);
  const auto viewer = nlohmann::json::parse(contentOf(scratch.file("a.json")));
  const auto run = nlohmann::json::parse(contentOf(scratch.file("b.json")));
  EXPECT_EQ(viewer.at("state_hash"), run.at("state_hash"));
}

// A stand-in for ffmpeg that keeps what it is given: every picture has to arrive whole.
TEST(ViewerHeadless, FilmsThroughFfmpeg) {
  const ScratchFolder scratch;
  const std::string tool = scratch.file("ffmpeg");
  std::ofstream(tool) << "#!/bin/sh\nfor last; do :; done\nexec /bin/cat > \"$last\"\n";
  std::filesystem::permissions(tool, std::filesystem::perms::owner_all);
  const SearchPath path(scratch.path().string());
  const std::string film = scratch.file("film.mp4");
  const ProgramResult result =
      runProgram("springtower-viewer", {"--headless", "--scene", "(010)", "--frames", "7", "--video", film, "--size", "64x48"});
  EXPECT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(contentOf(film).size(), 7U * 64U * 48U * 3U);
}

TEST(ViewerHeadless, KeepsWhatWasPlayedWhereAVideoOrPictureFails) {
  const ScratchFolder scratch;
  const std::string tool = scratch.file("ffmpeg");
  std::ofstream(tool) << "#!/bin/sh\n/bin/cat > /dev/null\nexit 1\n";
  std::filesystem::permissions(tool, std::filesystem::perms::owner_all);
  const SearchPath path(scratch.path().string());
  std::filesystem::create_directories(scratch.file("png/frame-00003.png"));
  const std::pair<std::vector<std::string>, std::size_t> failing[] = {{{"--video", scratch.file("film.mp4")}, 5},
                                                                      {{"--png", scratch.file("png")}, 3}};
  for (const auto& [options, frames] : failing) {
    SCOPED_TRACE(options[0]);
    const ScratchFolder out;
    std::vector<std::string> arguments = {"--headless",       "--scene", "(010)",          "--frames",       "5",
                                          "--size",           "64x48",   "--record",       out.file("game"), "--report",
                                          out.file("report"), "--poses", out.file("poses")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProgramResult result = runProgram("springtower-viewer", arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.error, HasSubstr(options[0]));
    EXPECT_EQ(linesOf(contentOf(out.file("game"))).size(), 1 + frames);
    EXPECT_EQ(nlohmann::json::parse(contentOf(out.file("report"))).at("frames"), frames);
    EXPECT_GT(linesOf(contentOf(out.file("poses"))).size(), 1U);
  }
}

// A mouse that plays, words over the picture, the same film every time.
TEST(ViewerHeadless, AMouseMayFollowAScript) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("mouse")) << "1 80 100\n20 80 100 press\n60 200 130\n60 200 130 release\n";
  std::string first;
  for (const char* folder : {"a", "b"}) {
    const ProgramResult result =
        runProgram("springtower-viewer",
                   {"--headless", "--scene", "(111)-(1L1)-(111)-(111)", "--mode", "play", "--mouse", scratch.file("mouse"),
                    "--frames", "60", "--png-every", "60", "--png", scratch.file(folder), "--size", "320x240"});
    ASSERT_EQ(result.exitCode, 0) << result.error;
    const std::string picture = contentOf(std::filesystem::path(scratch.file(folder)) / "frame-00060.png");
    EXPECT_EQ(sizeOf(picture), std::pair(320, 240));
    if (first.empty()) first = picture;
    EXPECT_EQ(picture, first);
  }
}

TEST(ViewerHeadless, SaysThatFfmpegIsMissing) {
  const ScratchFolder scratch;
  const SearchPath path(scratch.path().string());
  const ProgramResult result =
      runProgram("springtower-viewer", {"--headless", "--scene", "(010)", "--frames", "1", "--video", scratch.file("film.gif")});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, HasSubstr("expected ffmpeg to be installed"));
}

// A tolerance that no scene may have, and one that this scene cannot be stepped with: two steps a frame are fine with the
// implicit method of its file, but not with the explicit one of the recording.
TEST(ViewerHeadless, ARecordingThatCannotBePlayedSaysSoAndFails) {
  const ScratchFolder scratch;
  const std::string scene = scratch.file("scene.toml");
  const std::string recording = scratch.file("r.jsonl");
  std::ofstream(scene) << "[[block]]\ncentre_m = [0, 0, 0.0091]\n[settings]\ntolerance_m = 1e-5\nsubsteps = 2\n";
  const auto write = [&](const std::string& tolerance_m) {
    std::ofstream(recording) << R"({"springtower_recording":1,"scene":")" << scene << R"(","players":0})" << '\n'
                             << R"({"hash":"aa","tuning":{"method":"semi-implicit-euler","sleep":"on","tolerance_m":)"
                             << tolerance_m << R"(,"friction":0.4}})" << '\n';
  };
  write("-1");
  const ProgramResult bad = runProgram("springtower-viewer", {"--headless", "--replay", recording});
  EXPECT_EQ(bad.exitCode, 2);
  EXPECT_THAT(bad.error, says("r.jsonl, line 2: tolerance_m: expected ..., got -1"));
  write("1e-5");
  const std::string report = scratch.file("report.json");
  const ProgramResult refused = runProgram("springtower-viewer", {"--headless", "--replay", recording, "--report", report});
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_THAT(refused.error, says("frame 1 of the recording cannot be played: settings: expected at least ... for tolerance_m = "
                                  "1e-05, or allow_unstable, got substeps = 2"));
  EXPECT_THAT(nlohmann::json::parse(contentOf(report)).at("replay_refused").get<std::string>(), HasSubstr("cannot be played"));
}

TEST(ViewerHeadless, AReplayThatDiffersNamesTheFrame) {
  const ScratchFolder scratch;
  const std::string recording = scratch.file("r.jsonl");
  ASSERT_EQ(
      runProgram("springtower-viewer", {"--headless", "--scene", "(111)", "--frames", "20", "--record", recording}).exitCode, 0);
  EXPECT_EQ(runProgram("springtower-viewer", {"--headless", "--replay", recording}).exitCode, 0);
  std::vector<std::string> lines = linesOf(contentOf(recording));
  ASSERT_EQ(lines.size(), 21U);
  lines[12] = R"({"hash":"0123456789abcdef"})";
  {
    std::ofstream stream(recording);
    for (const std::string& line : lines) stream << line << '\n';
  }
  const ProgramResult result = runProgram("springtower-viewer", {"--headless", "--replay", recording});
  EXPECT_EQ(result.exitCode, 1);
  EXPECT_THAT(result.output, HasSubstr("frame 12"));
}

TEST(ViewerHeadless, BadArgumentsAreNamed) {
  const std::pair<std::vector<std::string>, std::string> bad[] = {
      {{"--headless", "--scene", "none.toml"}, "none.toml"},
      {{"--headless", "--size", "10x10"}, "--size: expected ..., got '10x10'"},
      {{"--headless", "--size", "big"}, "--size"},
      {{"--headless", "--camera", "1:2"}, "--camera"},
      {{"--headless", "--overlay", "heat"}, "--overlay: expected ..., got 'heat'"},
      {{"--headless", "--players", "9"}, "--players"},
      {{"--headless", "--mode", "game"}, "--mode: expected ..., got 'game'"},
      {{"--headless", "--mouse", "/nonexistent"}, "--mouse: /nonexistent: expected ..., got none"},
      {{"--mouse", "x"}, "only with --headless"},
      {{"--headless", "--method", "magic"}, "--method"},
      {{"--headless", "--video", "film.avi"}, ".mp4 or .gif"},
      {{"--headless", "--replay", "/nonexistent"}, "/nonexistent"},
      {{"--headless", "--report", "/no-such-folder/r.json"}, "--report"},
      {{"--headless", "--report", "a", "--poses", "a"}, "--report and --poses: expected ..., got 'a' for both"},
      {{"--headless", "--poses", "a", "--record", "./a"}, "--poses and --record: expected ..., got 'a' and './a'"},
      {{"--png", "x"}, "only with --headless"},
      {{"--colour"}, "--colour"}};
  for (const auto& [arguments, expected] : bad) {
    const ProgramResult result = runProgram("springtower-viewer", arguments);
    EXPECT_EQ(result.exitCode, 2) << expected;
    EXPECT_THAT(result.error, says(expected));
  }
}

TEST(ViewerHeadless, WithoutADisplayTheWindowSaysSo) {
  const char* display = std::getenv("DISPLAY");
  const std::string before = display == nullptr ? "" : display;
  setenv("DISPLAY", ":98765", 1);
  const ProgramResult result = runProgram("springtower-viewer", {});
  if (display == nullptr) {
    unsetenv("DISPLAY");
  } else {
    setenv("DISPLAY", before.c_str(), 1);
  }
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, HasSubstr("--headless"));
}

}  // namespace
}  // namespace springtower
