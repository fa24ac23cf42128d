// springtower chart, run as a user would.
#include "core/scene/scene.h"
#include "tests/apps/common/resume.h"
#include "tests/support/program.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace springtower {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

ProgramResult chart(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "chart");
  return runProgram("springtower", arguments);
}

void expectRefusal(const std::vector<std::string>& arguments, const std::string& message) {
  const ProgramResult result = chart(arguments);
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, StartsWith("springtower: "));
  EXPECT_THAT(result.error, HasSubstr(message));
}

TEST(Chart, RefusesWhatItDoesNotKnow) {
  expectRefusal({"--scenes", "uniform,flood"}, "'flood'");
  expectRefusal({"--methods", "magic"}, "'magic'");
  expectRefusal({"--rows", "1"}, "2 to 200");
  expectRefusal({"--out", "/dev/null"}, "--out");
  expectRefusal({"--out", "/proc"}, "--out: expected a file that can be written, got '/proc/");
  expectRefusal({"--no-time-limit", "--quick"}, "--quick");
}

// Former names of options are refused beside the same options as those of today, and beside these.
TEST(Chart, TakesTheFormerNamesOfOptions) {
  expectRefusal({"--long", "--quick"}, "--quick");
  expectRefusal({"--long", "--maps"}, "--maps");
  expectRefusal({"--long", "--no-time-limit"}, "--no-time-limit");
  expectRefusal({"--fresh", "--no-resume"}, "--no-resume");
  expectRefusal({"--long", "--scenes", "flood"}, "'flood'");
}

TEST(Chart, MapsTakeMethodsByEitherName) {
  expectRefusal({"--maps", "--methods", "bdf2-eigen"}, "'bdf2-eigen'");
  expectRefusal({"--maps", "--methods", "bdf2,magic"}, "'magic'");
}

TEST(Chart, RefusesPeersWithoutTheirColumns) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("peers.csv")) << "engine,rows\nBox,18\n";
  expectRefusal({"--peers", scratch.file("peers.csv"), "--out", scratch.file("out")}, "expected a column 'version', got none");
}

// A small chart that all tests below read.
class ChartFiles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<ScratchFolder>();
    result_ = chart(arguments());
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { ASSERT_EQ(result_.exitCode, 0) << result_.error; }

  static std::vector<std::string> arguments() {
    return {"--quick",
            "--rows",
            "3",
            "--scenes",
            "uniform,spin",
            "--methods",
            "bdf2,implicit,rigid-pgs",  // two names of one method: its cases are measured once
            "--case-limit",             // a slow machine, or a sanitizer, shall see the same cases
            "30",
            "--peers",
            std::string(SPRINGTOWER_SOURCE_DIR) + "/bench/data/peers/records.csv",
            "--out",
            path("out")};
  }
  static std::string path(const std::string& name) { return folder_->file(name); }
  static Json json() { return Json::parse(contentOf(path("out/chart.json"))); }

  inline static std::unique_ptr<ScratchFolder> folder_;
  inline static ProgramResult result_;
};

TEST_F(ChartFiles, HoldEveryCaseWithItsFigures) {
  const Json file = json();
  ASSERT_EQ(file.at("cases").size(), 8U);  // two scenes, two methods, two settings each
  for (const Json& one : file.at("cases")) {
    SCOPED_TRACE(one.dump());
    EXPECT_GT(one.at("cpu_ms_per_frame").get<double>(), 0.0);
    const bool tower = one.at("scene") == "uniform";
    for (const char* key : {"penetration_mm", "compression_mm", "creep_mm", "jitter_mm_s", "imbalance"})
      EXPECT_EQ(one.at(key).is_number(), tower) << key;
    EXPECT_EQ(one.at("max_strain").is_number(), tower && one.at("method") == "implicit") << "rigid blocks have no springs";
    EXPECT_GE(one.at("frames").get<int>(), 1);
    EXPECT_GE(one.at("samples").get<int>(), 1);
    EXPECT_EQ(one.at("error_mm").is_number(), !tower);
    if (!tower) continue;
    EXPECT_LT(one.at("imbalance").get<double>(), 1e-3) << "of a block's weight";
    const double sunk = one.at("compression_mm").get<double>() / (1e3 * kBlockHeight_m);
    if (one.at("method") == "rigid-pgs") {
      EXPECT_GT(one.at("energy_error").get<double>(), 0.2 * sunk) << "what rigid blocks lose as they sink into each other";
    } else {
      EXPECT_LT(one.at("energy_error").get<double>(), 1e-9) << "springs start in equilibrium";
    }
    EXPECT_EQ(one.at("outcome"), "right") << one.at("note");
    EXPECT_LT(one.at("penetration_mm").get<double>(), 1.0);
    EXPECT_LT(one.at("creep_mm").get<double>(), 1.0);
  }
}

TEST_F(ChartFiles, TableSaysWhereItComesFrom) {
  const std::vector<std::string> lines = linesOf(contentOf(path("out/chart.csv")));
  ASSERT_EQ(lines.size(), 9U) << "no peers at 3 rows";
  for (const char* column : {"measured,", "cpu_ms_per_frame", "commit,compiler,flags,cpu,date"})
    EXPECT_THAT(lines[0], HasSubstr(column));
  const std::string commit = json().at("commit");
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_THAT(lines[i], StartsWith("here,"));
    EXPECT_THAT(lines[i], HasSubstr("," + commit + ","));
  }
}

TEST_F(ChartFiles, IndexNamesEveryChart) {
  const std::string index = contentOf(path("out/index.md"));
  EXPECT_THAT(index, HasSubstr("| uniform |"));
  std::size_t charts = 0;
  for (const auto& entry : std::filesystem::directory_iterator(path("out"))) {
    if (entry.path().extension() != ".svg") continue;
    ++charts;
    EXPECT_THAT(index, HasSubstr(entry.path().filename().string()));
    const std::filesystem::path picture = std::filesystem::path(entry.path()).replace_extension(".png");
    EXPECT_THAT(contentOf(picture), HasSubstr("PNG"));
    EXPECT_GT(contentOf(entry.path()).size(), 10000U);
  }
  EXPECT_EQ(charts, 9U);  // seven measures of the tower; the energy of the block that flies, and its error
}

// A finer step is nearer to the converged run of its own model.
TEST_F(ChartFiles, ErrorAgainstAConvergedRunFallsWithTheStep) {
  const Json file = json();
  double coarse_mm = 0.0;
  for (const Json& one : file.at("cases")) {
    if (one.at("scene") != "spin" || one.at("method") != "rigid-pgs") continue;
    const auto error_mm = one.at("error_mm").get<double>();
    if (coarse_mm > 0.0) {
      EXPECT_LT(error_mm, 0.5 * coarse_mm) << "four times the steps of a method of first order";
    }
    coarse_mm = error_mm;
  }
  EXPECT_GT(coarse_mm, 0.0);
}

std::string withoutDates(const std::string& text) {
  std::string cut;
  for (const std::string& line : linesOf(text)) cut += line.substr(0, line.rfind(',')) + "\n";
  return cut;
}

// Of a run that was broken off the scenes that were done stay, to the last digit of their timings.
TEST_F(ChartFiles, AnotherRunGoesOnFromThem) {
  const std::string before = withoutDates(contentOf(path("out/chart.csv")));
  Json broken = json();
  std::erase_if(broken.at("cases").get_ref<Json::array_t&>(), [](const Json& one) { return one.at("scene") == "spin"; });
  ASSERT_EQ(broken.at("cases").size(), 4U);
  const std::string whole = contentOf(path("out/chart.json"));
  std::ofstream(path("out/chart.json")) << broken.dump();
  if (!wentOn(chart(arguments()))) {
    std::ofstream(path("out/chart.json")) << whole;  // for the tests that follow
    return;
  }
  const std::string after = withoutDates(contentOf(path("out/chart.csv")));
  EXPECT_EQ(linesOf(after).size(), 9U);
  for (const std::string& line : linesOf(before)) {
    if (!line.starts_with("here,uniform")) continue;
    EXPECT_THAT(after, HasSubstr(line + "\n"));
  }
}

TEST_F(ChartFiles, StayWhenOneSceneIsAskedFor) {
  std::vector<std::string> one = arguments();
  std::replace(one.begin(), one.end(), std::string("uniform,spin"), std::string("spin"));
  const std::string before = withoutDates(contentOf(path("out/chart.csv")));
  wentOn(chart(one));
  EXPECT_EQ(withoutDates(contentOf(path("out/chart.csv"))), before) << "as well where it is refused";
}

TEST_F(ChartFiles, AreNotOverwrittenByARunWithOtherLimits) {
  std::vector<std::string> other = arguments();
  std::replace(other.begin(), other.end(), std::string("3"), std::string("4"));
  const std::string before = contentOf(path("out/chart.json"));
  const ProgramResult refused = chart(other);
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_THAT(refused.error, HasSubstr("--no-resume"));
  EXPECT_EQ(contentOf(path("out/chart.json")), before);
  other.emplace_back("--fresh");
  EXPECT_EQ(chart(other).exitCode, 0);
}

// Where blocks move, cases are timed over the same frames. The choice of method `auto` stands in the index, judged.
TEST(Chart, TimesMotionAlikeAndJudgesTheChoiceOfAuto) {
  const ScratchFolder scratch;
  const ProgramResult result = chart({"--quick", "--auto", "--scenes", "slide,thrown", "--methods", "auto,implicit,rigid-pgs",
                                      "--case-limit", "30", "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const Json file = Json::parse(contentOf(scratch.file("out/chart.json")));
  for (const Json& one : file.at("cases")) {
    SCOPED_TRACE(one.dump());
    EXPECT_EQ(one.at("frames"), 20);
    EXPECT_EQ(one.at("outcome"), "right");
  }
  const std::string index = contentOf(scratch.file("out/index.md"));
  EXPECT_THAT(index, HasSubstr("| slide | took implicit"));
  EXPECT_THAT(index, HasSubstr("| thrown | took rigid-pgs"));
  EXPECT_THAT(index, ::testing::AnyOf(HasSubstr("| pass |"), HasSubstr("| **fail** |")));
}

// A frame cannot be broken off, and one of a tall tower may take a quarter of an hour by pivoting: a few rows show it beforehand.
TEST(Chart, ForeseesWhichTallTowersTakeTooLong) {
  const ScratchFolder scratch;
  const ProgramResult result = chart({"--quick", "--auto", "--scenes", "tall", "--methods", "implicit,rigid-lcp", "--seconds",
                                      "1", "--case-limit", "3", "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const Json file = Json::parse(contentOf(scratch.file("out/chart.json")));
  int foreseen = 0;
  for (const Json& one : file.at("cases")) {
    SCOPED_TRACE(one.dump());
    const bool tooLong = one.at("note").get<std::string>().find("foreseen: a frame of 6 rows") != std::string::npos;
    EXPECT_EQ(tooLong, one.at("method") == "rigid-lcp");
    if (!tooLong) continue;
    EXPECT_EQ(one.at("outcome"), "timed out");
    ++foreseen;
  }
  EXPECT_GE(foreseen, 1);
}

// Other engines run beside ours. The packages that tests need have both of them (packages.txt).
TEST(Chart, RunsOtherEnginesAndCarriesOverThoseMeasuredElsewhere) {
  const std::filesystem::path programs = std::filesystem::path(SPRINGTOWER_BINARY_DIR) / "bin";
  for (const char* engine : {"peers_bullet", "peers_ode"}) ASSERT_TRUE(exists(programs / engine)) << engine << " was not built";
  const ScratchFolder scratch;
  const std::string records = scratch.file("records.csv");
  std::ofstream(records) << "engine,version,settings,scene,rows,threads,stands_60_s,worst_penetration_mm,top_height_error_mm,"
                            "creep_mm,jitter_mm_s,ms_per_frame,ratio_to_bullet_16_substeps\n"
                            "Other,1,default,uniform,3,1,yes,0.1,-0.3,0,0,1000,0.5\n";
  const ProgramResult result = chart({"--quick", "--rows", "3", "--scenes", "uniform,pull,drop", "--methods", "bullet,ode",
                                      "--peers", records, "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  double bullet_ms = 0.0;
  int right = 0;
  int pulled = 0;
  const Json file = Json::parse(contentOf(scratch.file("out/chart.json")));
  for (const Json& one : file.at("cases")) {
    SCOPED_TRACE(one.dump());
    EXPECT_GT(one.at("cpu_ms_per_frame").get<double>(), 0.0);
    EXPECT_LT(one.at("penetration_mm").get<double>(), 20.0);
    if (one.at("outcome") == "right") ++right;
    if (one.at("scene") == "pull") ++pulled;
    if (one.at("scene") == "uniform") {
      EXPECT_GT(one.at("imbalance").get<double>(), 0.0) << "they are never quite at rest";
    }
    if (one.at("method") == "bullet" && one.at("value") == 16.0 && one.at("scene") == "uniform")
      bullet_ms = one.at("cpu_ms_per_frame").get<double>();
  }
  EXPECT_EQ(pulled, 4) << "two settings of each";
  EXPECT_GE(right, 4) << "three rows stand with any engine that takes 16 steps";
  const std::vector<std::string> lines = linesOf(contentOf(scratch.file("out/chart.csv")));
  EXPECT_THAT(lines.back(), StartsWith("elsewhere,uniform,3,\"Other\","));
  ASSERT_GT(bullet_ms, 0.0);
  std::istringstream carried(lines.back().substr(lines.back().find(",,,,,,") + 6));
  double ms = 0.0;
  carried >> ms;
  EXPECT_NEAR(ms, 0.5 * bullet_ms, 1e-3 * bullet_ms);
}

// Walls and pyramids, beside them what other engines took elsewhere: of these sizes, as it was recorded.
TEST(Chart, DrawsAWallAndAPyramidBesideRecordedPoints) {
  const ScratchFolder scratch;
  const std::string records = std::string(SPRINGTOWER_SOURCE_DIR) + "/bench/data/peers/stacks.csv";
  const ProgramResult result = chart({"--quick", "--scenes", "wall,pyramid", "--methods", "implicit,bullet", "--peers", records,
                                      "--case-limit", "30", "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const Json file = Json::parse(contentOf(scratch.file("out/chart.json")));
  ASSERT_EQ(file.at("cases").size(), 8U) << "two scenes, two tolerances, and two settings of Bullet";
  for (const Json& one : file.at("cases")) {
    SCOPED_TRACE(one.dump());
    if (one.at("method") != "implicit") continue;
    EXPECT_EQ(one.at("outcome"), "right");
    EXPECT_LE(one.at("penetration_mm").get<double>(), 1e3 * one.at("value").get<double>());
    EXPECT_LE(one.at("creep_mm").get<double>(), 1e-5);
  }
  const std::string table = contentOf(scratch.file("out/chart.csv"));
  EXPECT_THAT(table, HasSubstr("here,wall,10x6,implicit,tolerance_m,5e-05,"));
  EXPECT_THAT(table, HasSubstr("here,pyramid,10,bullet,substeps,16,"));
  // Box3D with 32 substeps took 0.7386 ms for a pyramid of ten rows, 0.024 mm deep.
  EXPECT_THAT(linesOf(table), ::testing::Contains(::testing::ContainsRegex(
                                  "^elsewhere,pyramid,10,\"Box3D\",settings,\"[^\"]*substeps 32\",.*,0.7386,[^,]*,0.024,")));
  EXPECT_THAT(table, ::testing::Not(HasSubstr("elsewhere,wall"))) << "none of ten columns and six courses";
  for (const char* name : {"wall_penetration_mm.svg", "pyramid_penetration_mm.png", "pyramid_penetration_mm.pdf"})
    EXPECT_GT(contentOf(scratch.file("out") + "/" + name).size(), 1000U) << name;
}

// Falls, beside them what other engines took elsewhere: the deepest of the whole fall, the median of the frames and the worst.
TEST(Chart, DrawsFallsBesideRecordedPoints) {
  const ScratchFolder scratch;
  const std::string records = std::string(SPRINGTOWER_SOURCE_DIR) + "/bench/data/peers/falls.csv";
  const ProgramResult result =
      chart({"--quick", "--rows", "18", "--seconds", "0.5", "--scenes", "collapse,shot,heap-200", "--methods", "implicit,bullet",
             "--peers", records, "--case-limit", "60", "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const Json file = Json::parse(contentOf(scratch.file("out/chart.json")));
  ASSERT_EQ(file.at("cases").size(), 12U) << "three falls, two tolerances, and two settings of Bullet";
  for (const Json& one : file.at("cases")) {
    SCOPED_TRACE(one.dump());
    EXPECT_EQ(one.at("outcome"), "right");
    EXPECT_EQ(one.at("frames"), 20) << "of all methods the same";
    EXPECT_GE(one.at("cpu_ms_worst_frame").get<double>(), one.at("cpu_ms_per_frame").get<double>());
    if (one.at("method") == "implicit") {
      EXPECT_LT(one.at("penetration_mm").get<double>(), 1.5);
    }
    EXPECT_TRUE(one.at("creep_mm").is_null()) << "nothing rests";
  }
  const std::vector<std::string> table = linesOf(contentOf(scratch.file("out/chart.csv")));
  const auto recorded = [&](const std::string& scene, const std::string& settings, const std::string& figures) {
    EXPECT_THAT(table, ::testing::Contains(::testing::ContainsRegex("^elsewhere," + scene + ",settings,\"[^\"]*" + settings +
                                                                    "\",.*," + figures + ",elsewhere,,,,$")))
        << scene << ", " << settings;
  };
  // Median (ms a frame, then s a second), depth, and the worst frame; where that was the first, no other is known.
  recorded("heap-200,200,\"Box3D\"", "8 steps x 4 substeps", "3.8517,0.231102,6.2226,,,,,,,,5.1953");
  recorded("collapse,18,\"Jolt\"", "steps 8", "0.8148,0.048888,2.0501,,,,,,,,2.2982");
  recorded("shot,18,\"Jolt\"", "steps 4", "0.864,0.05184,3.3639,,,,,,,,");
  for (const char* name :
       {"collapse_penetration_mm.svg", "shot_penetration_mm.png", "heap_200_penetration_mm.pdf",
        "collapse_penetration_mm_worst.svg", "shot_penetration_mm_worst.png", "heap_200_penetration_mm_worst.pdf"})
    EXPECT_GT(contentOf(scratch.file("out") + "/" + name).size(), 1000U) << name;
  const std::string index = contentOf(scratch.file("out/index.md"));
  EXPECT_THAT(index, HasSubstr("](heap_200_penetration_mm_worst.png)"));
  EXPECT_THAT(index, ::testing::Not(HasSubstr("| heap-200 | implicit"))) << "a fall is held to no tolerance at rest";
}

// All that a chart is drawn with.
std::set<std::string> coloursOf(const std::string& svg) {
  std::set<std::string> colours;
  const std::string text = contentOf(svg);
  for (std::size_t at = text.find("rgb("); at != std::string::npos; at = text.find("rgb(", at + 1))
    colours.insert(text.substr(at, text.find(')', at) - at));
  return colours;
}

// Of the first engine the worst frame but the first is not known. That must not give its colour to the second.
TEST(Chart, AnEngineHasOneColourInAllChartsOfAScene) {
  const ScratchFolder scratch;
  const std::string head =
      "engine,version,settings,scene,threads,median_ms,worst_ms,penetration_end_mm,penetration_max_mm,verdict\n";
  const std::string first = "First,1,a,shot:2,1,1,,0.1,2,moves\n";
  std::ofstream(scratch.file("first.csv")) << head << first;
  std::ofstream(scratch.file("both.csv")) << head << first << "Second,1,a,shot:2,1,1,2,0.1,3,moves\n";
  for (const std::string name : {"first", "both"}) {
    const ProgramResult result = chart({"--quick", "--rows", "2", "--seconds", "0.2", "--scenes", "shot", "--methods",
                                        "rigid-pgs", "--peers", scratch.file(name + ".csv"), "--out", scratch.file(name)});
    ASSERT_EQ(result.exitCode, 0) << result.error;
  }
  const std::set<std::string> without = coloursOf(scratch.file("first/shot_penetration_mm_worst.svg"));
  const std::set<std::string> worst = coloursOf(scratch.file("both/shot_penetration_mm_worst.svg"));
  int ofFirst = 0;
  for (const std::string& colour : coloursOf(scratch.file("first/shot_penetration_mm.svg"))) {
    if (without.contains(colour)) continue;
    ++ofFirst;
    EXPECT_FALSE(worst.contains(colour)) << colour;
  }
  EXPECT_EQ(ofFirst, 1);
  EXPECT_EQ(worst.size(), without.size() + 1) << "that of the second";
}

// Of other scenes, sizes and numbers of threads nothing is drawn, and the file is named.
TEST(Chart, LeavesOutRecordsOfScenesThatItDoesNotDraw) {
  const ScratchFolder scratch;
  const std::string head =
      "engine,version,settings,scene,threads,median_ms,worst_ms,penetration_end_mm,penetration_max_mm,verdict\n";
  std::ofstream(scratch.file("peers.csv")) << head
                                           << "Box,1,a,flood:200,1,1,2,3,4,moves\n"
                                              "Box,1,a,heap:1000,1,1,2,3,4,moves\n"
                                              "Box,1,a,shot:18,1,1,2,3,4,moves\n"
                                              "Box,1,a,heap:200,2,1,2,3,4,moves\n";
  const ProgramResult result = chart({"--quick", "--scenes", "spin", "--methods", "rigid-pgs", "--peers",
                                      scratch.file("peers.csv"), "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_THAT(result.output, HasSubstr("peers.csv: no figures for 6 rows"));
  EXPECT_THAT(contentOf(scratch.file("out/chart.csv")), ::testing::Not(HasSubstr("elsewhere")));
}

// A quick chart of all scenes takes less than a minute (test apps.QuickChart), so falls of hundreds of blocks have to be named.
TEST(Chart, QuickLeavesOutFallsOfHundredsOfBlocks) {
  const ScratchFolder scratch;
  const ProgramResult result =
      chart({"--quick", "--rows", "2", "--seconds", "0.2", "--methods", "rigid-pgs", "--out", scratch.file("out")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  std::set<std::string> scenes;
  const Json file = Json::parse(contentOf(scratch.file("out/chart.json")));
  for (const Json& one : file.at("cases")) scenes.insert(one.at("scene"));
  EXPECT_EQ(scenes, (std::set<std::string>{"uniform", "heights", "pull", "drop", "collapse", "spin", "heavy-light", "wall",
                                           "pyramid", "shot"}));
}

TEST(Chart, RefusesRecordsOfFallsWithoutTheirColumns) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("peers.csv"))
      << "engine,version,settings,scene,threads,median_ms,penetration_end_mm,verdict\nBox,1,a,heap:200,1,1,0.1,moves\n";
  expectRefusal({"--peers", scratch.file("peers.csv"), "--out", scratch.file("out")},
                "expected a column 'penetration_max_mm', got none");
}

TEST(Chart, RefusesRecordsOfStacksWithoutTheirColumns) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("peers.csv"))
      << "engine,version,settings,scene,threads,penetration_end_mm\nBox,1,a,cubes:40,1,0.1\n";
  expectRefusal({"--peers", scratch.file("peers.csv"), "--out", scratch.file("out")}, "expected a column 'median_ms', got none");
  std::ofstream(scratch.file("short.csv"))
      << "engine,version,settings,scene,threads,median_ms,penetration_end_mm,verdict\nBox,1,a,cubes:40,1\n";
  expectRefusal({"--peers", scratch.file("short.csv"), "--out", scratch.file("out")}, "expected 8 fields, got 5");
}

}  // namespace
}  // namespace springtower
