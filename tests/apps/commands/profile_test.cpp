// springtower profile, run as a user would.
#include "apps/viewer/session/session.h"
#include "scenarios/recorded/recorded_game.h"
#include "tests/support/program.h"

#include <algorithm>
#include <cairo.h>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace springtower {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

ProgramResult profile(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "profile");
  return runProgram("springtower", arguments);
}

struct BadProfileArguments {
  std::string name;
  std::vector<std::string> arguments;
  std::string message;  // part of what must be said
};

class ProfileRefusesTest : public ::testing::TestWithParam<BadProfileArguments> {};

TEST_P(ProfileRefusesTest, WithExitCodeTwo) {
  const ProgramResult result = profile(GetParam().arguments);
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.output, "");
  EXPECT_THAT(result.error, StartsWith("springtower: "));
  EXPECT_THAT(result.error, HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Profile, ProfileRefusesTest,
    ::testing::Values(BadProfileArguments{"UnknownScene", {"--scenes", "rest,flood"}, "'flood'"},
                      BadProfileArguments{"UnknownMethod", {"--methods", "magic"}, "'magic'"},
                      BadProfileArguments{"RowsThatAreNoNumbers", {"--rows", "3,six"}, "'six'"},
                      BadProfileArguments{"HalfARow", {"--rows", "3.5"}, "whole numbers"},
                      BadProfileArguments{"NoRows", {"--rows", "0"}, "1 to 2000"},
                      BadProfileArguments{"NegativeTolerance", {"--tolerances", "-1e-5"}, "--tolerances"},
                      BadProfileArguments{"NoThreads", {"--threads", "0"}, "--threads"},
                      BadProfileArguments{"TooFewFrames", {"--frames", "1"}, "--frames"},
                      BadProfileArguments{"OutIsAFile", {"--quick", "--out", "/dev/null"}, "--out"},
                      BadProfileArguments{"FromWithoutOut", {"--from", "x.json"}, "--out"},
                      BadProfileArguments{"FromNothing", {"--from", "no-such-file.json", "--out", "/tmp"}, "no-such-file.json"}),
    [](const auto& bad) { return bad.param.name; });

TEST(Profile, RefusesAnotherFileThanAProfile) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("other.json")) << R"({"version": "1"})";
  const ProgramResult result = profile({"--from", scratch.file("other.json"), "--out", scratch.file("out")});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, HasSubstr("other.json"));
}

TEST(Profile, HelpTeaches) {
  const ProgramResult result = profile({"--help"});
  EXPECT_EQ(result.exitCode, 0);
  for (const char* word : {"--trace", "pull-sleep", "game (a recorded game", "examples", "ui.perfetto.dev", "CPU time"}) {
    EXPECT_THAT(result.output, HasSubstr(word));
  }
}

// A small profile that all tests below read.
class ProfileFiles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    result_ =
        profile({"--rows", "3,6", "--scenes", "rest,pull,asleep", "--methods", "semi-implicit-euler", "--tolerances", "1e-3",
                 "--samples", "2", "--frames", "5", "--settle", "0.5", "--out", path("out"), "--trace", path("trace.json")});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { ASSERT_EQ(result_.exitCode, 0) << result_.error; }

  static std::string path(const std::string& name) { return folder_->file(name); }
  static Json json() { return Json::parse(contentOf(path("out/profile.json"))); }

  inline static std::unique_ptr<ScratchFolder> folder_;
  inline static ProgramResult result_;
};

TEST_F(ProfileFiles, SayWhatWasMeasuredOnWhat) {
  const Json file = json();
  for (const char* key : {"version", "commit", "compiler", "flags", "cpu", "date"}) {
    EXPECT_NE(file.at(key).get<std::string>(), "") << key;
  }
  EXPECT_EQ(file.at("cases").size(), 6U);
  for (const Json& one : file.at("cases")) {
    SCOPED_TRACE(one.dump());
    ASSERT_TRUE(one.at("failure").is_null());
    EXPECT_EQ(one.at("frames"), 5);
    EXPECT_EQ(one.at("samples"), 2);
    const Json& times = one.at("cpu_ms");
    EXPECT_GT(times.at("median").get<double>(), 0.0);
    EXPECT_LE(times.at("median").get<double>(), times.at("p99").get<double>());
    EXPECT_LE(times.at("p99").get<double>(), times.at("max").get<double>());
    EXPECT_NEAR(one.at("frames_per_second").get<double>() * times.at("median").get<double>(), 1000.0, 1e-6);
    EXPECT_EQ(one.at("blocks"), 3 * one.at("rows").get<int>() * one.at("towers").get<int>());
    EXPECT_EQ(one.at("counters_per_frame").at("frames"), 1.0);
    EXPECT_LE(one.at("max_penetration_mm").get<double>(), 4.0);
  }
}

TEST_F(ProfileFiles, MeasureTheSceneTheyName) {
  int pulled = 0;
  const Json file = json();
  for (const Json& one : file.at("cases")) {
    SCOPED_TRACE(one.dump());
    const bool asleep = one.at("scene") == "asleep";
    const double evaluations = one.at("counters_per_frame").at("contact_evaluations").get<double>();
    EXPECT_EQ(evaluations == 0.0, asleep);
    double stages = 0.0;
    for (const Json& stage : one.at("stage_ms")) stages += stage.get<double>();
    EXPECT_EQ(stages == 0.0, asleep);
    if (one.at("scene") == "rest") {
      EXPECT_EQ(one.at("prepared_s"), 0.5);
      EXPECT_EQ(one.at("stands"), true);
      // Springs are evaluated once a step in this method.
      EXPECT_EQ(one.at("counters_per_frame").at("spring_evaluations").get<double>(),
                28.0 * one.at("blocks").get<double>() * one.at("substeps").get<double>());
    }
    if (one.at("scene") == "pull") {
      ++pulled;
      EXPECT_GT(one.at("prepared_s").get<double>(), 0.5);
      EXPECT_EQ(one.at("stands"), true);
    }
  }
  EXPECT_EQ(pulled, 2);
}

TEST_F(ProfileFiles, CsvHasAllCasesAndColumns) {
  const std::vector<std::string> lines = linesOf(contentOf(path("out/profile.csv")));
  ASSERT_EQ(lines.size(), 7U);
  // Commas outside quotes.
  const auto columns = [](const std::string& line) {
    bool inside = false;
    return std::count_if(line.begin(), line.end(), [&](char c) {
      if (c == '"') inside = !inside;
      return c == ',' && !inside;
    });
  };
  for (const std::string& line : lines) EXPECT_EQ(columns(line), columns(lines[0])) << line;
  for (const char* name : {"commit", "compiler", "flags", "cpu", "islands_and_sleep_ms", "contact_bytes_per_block"}) {
    EXPECT_THAT(lines[0], HasSubstr(name));
  }
}

TEST_F(ProfileFiles, CullingStandsBesideTheReports) {
  const std::vector<std::string> lines = linesOf(contentOf(path("out/culling.csv")));
  // 153 pairs of 18 blocks, 336 pairs of features each; the report's 102816 counts them twice.
  EXPECT_THAT(lines, Contains(::testing::ContainsRegex("^rest,6,18,.*,no tests,51408,51408,")));
}

TEST_F(ProfileFiles, TraceHasStagesInsideFrames) {
  const Json trace = Json::parse(contentOf(path("trace.json")));
  EXPECT_NE(trace.at("otherData").at("commit").get<std::string>(), "");
  std::size_t frames = 0;
  std::size_t stages = 0;
  Json frame;
  for (const Json& event : trace.at("traceEvents")) {
    if (event.at("ph") != "X") continue;
    if (event.at("name") == "frame") {
      frame = event;
      ++frames;
      continue;
    }
    ++stages;
    ASSERT_FALSE(frame.is_null());
    EXPECT_EQ(event.at("tid"), frame.at("tid"));
    const double start = event.at("ts").get<double>();
    const double frameStart = frame.at("ts").get<double>();
    EXPECT_GE(start, frameStart);
    EXPECT_LE(start + event.at("dur").get<double>(), frameStart + frame.at("dur").get<double>() + 1e-3);
  }
  EXPECT_EQ(frames, 30U);
  EXPECT_GE(stages, 5U * 20U);
}

TEST_F(ProfileFiles, ChartsAreDrawnAgainToTheByte) {
  std::size_t charts = 0;
  for (const char* again : {"again", "once_more"}) {
    ASSERT_EQ(profile({"--from", path("out/profile.json"), "--out", path(again)}).exitCode, 0);
    for (const auto& entry : std::filesystem::directory_iterator(path("out"))) {
      const std::string name = entry.path().filename().string();
      if (name == "profile.json") continue;
      EXPECT_TRUE(contentOf(entry.path()) == contentOf(path(again) + "/" + name)) << name;
      charts += name.ends_with(".svg") || name.ends_with(".png") || name.ends_with(".pdf") ? 1U : 0U;
    }
  }
  EXPECT_GE(charts, 2U * 3U * 7U);
}

// Width and height in a PNG's header, pixels.
std::pair<std::uint32_t, std::uint32_t> pngSize(const std::string& content) {
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = (value << 8U) | static_cast<unsigned char>(content[at + i]);
    return value;
  };
  return {number(16), number(20)};
}

TEST_F(ProfileFiles, ChartsAreWholeFiles) {
  for (const auto& entry : std::filesystem::directory_iterator(path("out"))) {
    if (entry.path().extension() != ".svg") continue;
    SCOPED_TRACE(entry.path());
    const std::string svg = contentOf(entry.path());
    EXPECT_THAT(svg, StartsWith("<?xml"));
    EXPECT_NE(svg.find("</svg>"), std::string::npos);
    const std::string png = contentOf(std::filesystem::path(entry.path()).replace_extension(".png"));
    ASSERT_GT(png.size(), 1000U);
    EXPECT_EQ(png.substr(1, 3), "PNG");
    EXPECT_EQ(png.substr(png.size() - 8, 4), "IEND");
    const auto [width, height] = pngSize(png);
    const std::string pdf = contentOf(std::filesystem::path(entry.path()).replace_extension(".pdf"));
    EXPECT_THAT(pdf, StartsWith("%PDF"));
    EXPECT_NE(pdf.find("%%EOF"), std::string::npos);
    EXPECT_NE(svg.find("width=\"" + std::to_string(width / 3) + "pt\" height=\"" + std::to_string(height / 3) + "pt\""),
              std::string::npos);
  }
}

// Colour of a pixel of a PNG, 0xRRGGBB.
std::uint32_t pixelOf(const std::string& file, int x, int y) {
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> image(
      cairo_image_surface_create_from_png(file.c_str()), cairo_surface_destroy);
  EXPECT_EQ(cairo_surface_status(image.get()), CAIRO_STATUS_SUCCESS);
  std::uint32_t pixel = 0;
  const unsigned char* data = cairo_image_surface_get_data(image.get());
  std::memcpy(&pixel, data + y * cairo_image_surface_get_stride(image.get()) + 4 * x, sizeof pixel);
  return pixel & 0xffffffU;
}

TEST_F(ProfileFiles, PointsStandWhereTheyBelong) {
  // 100 frames a second at 10 rows, 1000 at 20: axes from 0 to 20 and, logarithmic, from 10 to 1000.
  Json file = json();
  Json first = file.at("cases").at(0);
  Json second = first;
  first["rows"] = 10;
  second["rows"] = 20;
  first["cpu_ms"]["median"] = 10.0;
  second["cpu_ms"]["median"] = 1.0;
  file["cases"] = {first, second};
  std::ofstream(path("made.json")) << file;
  ASSERT_EQ(profile({"--from", path("made.json"), "--out", path("made")}).exitCode, 0);
  // The plane begins at (64, 52) points and is 460 by 300 large; three pixels a point.
  const auto at = [&](double x, double y) {
    return pixelOf(path("made/rows_rest.png"), static_cast<int>(std::lround(3.0 * (64.0 + 460.0 * x))),
                   static_cast<int>(std::lround(3.0 * (52.0 + 300.0 * (1.0 - y)))));
  };
  constexpr std::uint32_t kFirstColour = 0x0072b2;
  constexpr std::uint32_t kWhite = 0xffffff;
  EXPECT_EQ(at(0.5, 0.5), kFirstColour);
  EXPECT_EQ(at(1.0, 1.0), kFirstColour);
  EXPECT_EQ(at(0.75, 0.75), kFirstColour);  // the line between them
  EXPECT_EQ(at(0.6, 0.92), kWhite);
  EXPECT_EQ(at(0.3, 0.45), kWhite);
}

// Scenes of their own size, and one that falls: within the frames of the options, however long a slow machine takes.
TEST(Profile, TowersAndACollapse) {
  const ProgramResult result = profile({"--rows",       "9",    "--scenes",       "collapse,towers",
                                        "--towers",     "1,2",  "--methods",      "semi-implicit-euler",
                                        "--tolerances", "1e-3", "--samples",      "1",
                                        "--frames",     "30",   "--settle",       "0.1",
                                        "--threads",    "1,2",  "--sample-limit", "600"});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const std::vector<std::string> lines = linesOf(result.output);
  EXPECT_THAT(lines, Contains(::testing::ContainsRegex("^collapse +9 +27 .* 1 .*fallen")));
  EXPECT_THAT(lines, Contains(::testing::ContainsRegex("^collapse +9 +27 .* 2 .*fallen")));
  EXPECT_THAT(lines, Contains(::testing::ContainsRegex("^towers +1x18 +54 ")));
  EXPECT_THAT(lines, Contains(::testing::ContainsRegex("^towers +2x18 +108 ")));
}

// All of its frames, each with the steps and contacts that it has in the viewer.
TEST(Profile, TheRecordedGameIsPlayedAsTheViewerPlaysIt) {
  const ScratchFolder scratch;
  const ProgramResult result = profile({"--scenes", "game", "--samples", "1", "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_THAT(linesOf(result.output), Contains(::testing::ContainsRegex("^game +18 +54 implicit ")));
  EXPECT_TRUE(std::filesystem::exists(scratch.file("out/frames_game.svg")));
  const Json cases = Json::parse(contentOf(scratch.file("out/profile.json"))).at("cases");
  ASSERT_EQ(cases.size(), 1U);
  const Json& one = cases.at(0);
  const Recording& game = recordedGame();
  EXPECT_EQ(one.at("frames"), game.frames.size());
  EXPECT_EQ(one.at("tolerance_m"), game.frames.front().input.tuning.tolerance_m);

  Session session(sceneOf(game.choice), game.choice.players);
  prepareStart(session);
  const Counters before = session.simulation.counters;
  for (const LoggedFrame& frame : game.frames) step(session, frame.input);
  const Counters& after = session.simulation.counters;
  const auto expectCounted = [&](const char* name, std::uint64_t count) {
    const double played = one.at("counters_per_frame").at(name).get<double>() * static_cast<double>(game.frames.size());
    EXPECT_NEAR(played, static_cast<double>(count), 0.1) << name;
  };
  expectCounted("steps", after.steps - before.steps);
  expectCounted("contact_evaluations", after.contactEvaluations - before.contactEvaluations);
  expectCounted("contacts_born", after.contactsCreated - before.contactsCreated);
}

// A stack of 108 blocks a row that lands: as deep and as many steps with two threads as with one, from the same state.
TEST(Profile, APileLandsOnAnyThreads) {
  const ScratchFolder scratch;
  const ProgramResult result =
      profile({"--rows", "2", "--scenes", "pile", "--methods", "implicit", "--tolerances", "2e-4", "--samples", "1", "--frames",
               "3", "--threads", "1,2", "--sample-limit", "600", "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const Json cases = Json::parse(contentOf(scratch.file("out/profile.json"))).at("cases");
  for (const char* key : {"prepared_s", "bottom_row_compression_mm"}) EXPECT_EQ(cases.at(0).at(key), cases.at(1).at(key)) << key;
  std::vector<std::pair<std::string, std::string>> stepsAndDepth;
  for (const std::string& line : linesOf(result.output)) {
    std::istringstream words(line);
    const std::vector<std::string> columns{std::istream_iterator<std::string>(words), {}};
    if (columns.size() < 14 || columns[0] != "pile" || columns[2] != "216") continue;
    stepsAndDepth.emplace_back(columns[6], columns[13]);
  }
  ASSERT_EQ(stepsAndDepth.size(), 2U) << result.output;
  EXPECT_EQ(stepsAndDepth[0], stepsAndDepth[1]);
  EXPECT_GT(std::stod(stepsAndDepth[0].first), 4.0) << "it lands";
}

TEST_F(ProfileFiles, FailureIsAResult) {
  Json file = json();
  file["cases"][0]["failure"] = "block 3 diverged";
  std::ofstream(path("failed.json")) << file;
  const ProgramResult again = profile({"--from", path("failed.json"), "--out", path("failed")});
  EXPECT_EQ(again.exitCode, 0);
  EXPECT_THAT(again.output, HasSubstr("block 3 diverged"));
}

}  // namespace
}  // namespace springtower
