#include "tests/support/program.h"
#include "tests/support/says.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace springtower {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

ProgramResult run(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "run");
  return runProgram("springtower", arguments);
}

// Runs a scene that must succeed and returns its report.
Json reportOf(std::vector<std::string> arguments) {
  const ScratchFolder scratch;
  arguments.insert(arguments.end(), {"--report", scratch.file("report.json")});
  const ProgramResult result = run(arguments);
  EXPECT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(result.error, "");
  return Json::parse(contentOf(scratch.file("report.json")));
}

struct BadArguments {
  std::string name;
  std::vector<std::string> arguments;
  std::string message;  // part of what must be said
};

class RefusesTest : public ::testing::TestWithParam<BadArguments> {};

TEST_P(RefusesTest, InOneLineWithExitCodeTwo) {
  const ProgramResult result = run(GetParam().arguments);
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.output, "");
  EXPECT_THAT(result.error, StartsWith("springtower: "));
  EXPECT_THAT(result.error, says(GetParam().message));
  // The second line says where to find help.
  EXPECT_THAT(linesOf(result.error), AnyOf(SizeIs(1), SizeIs(2)));
  if (linesOf(result.error).size() == 2) {
    EXPECT_EQ(linesOf(result.error)[1], "Try 'springtower run --help'.");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Run, RefusesTest,
    ::testing::Values(
        BadArguments{"NoScene", {}, "SCENE"}, BadArguments{"MissingFile", {"no-such-scene.toml"}, "no-such-scene.toml"},
        BadArguments{"Folder", {"/"}, "folder"}, BadArguments{"TypoInCode", {"(010)-(0120)"}, "character 10"},
        BadArguments{"NoRows", {"tower:0"}, "tower:0"}, BadArguments{"AbsurdRows", {"tower:1000000000"}, "1 to 2000"},
        BadArguments{"UnknownName", {"castle:3"}, "'castle:3': expected tower:ROWS, ..., got none of them"},
        BadArguments{"WrongSize", {"wall:20"}, "wall:COLUMNSxCOURSES: expected ..., got the size '20'"},
        BadArguments{"SizeOfNone", {"thrown:2"}, "thrown: expected the name alone, got the size '2'"},
        BadArguments{"HeightsOfNoTower",
                     {"wall:3x2", "--heights-sigma", "0.0002"},
                     "expected a tower for a variation of heights, got another scene"},
        BadArguments{"RowsNoNumber", {"tower:ten"}, "ten"}, BadArguments{"TwoScenes", {"tower:1", "tower:2"}, "tower:2"},
        BadArguments{"UnknownOption", {"tower:3", "--colour"}, "--colour"},
        BadArguments{"NoNumber", {"tower:3", "--seconds", "ten"}, "got 'ten'"},
        BadArguments{"NumberWithMore", {"tower:3", "--seconds", "1s"}, "got '1s'"},
        BadArguments{"EmptyNumber", {"tower:3", "--seconds", ""}, "got ''"},
        BadArguments{"NegativeTime", {"tower:3", "--seconds", "-1"}, "got '-1'"},
        BadArguments{"NoTime", {"tower:3", "--seconds", "0"}, "0.001 to"},
        BadArguments{"EndlessTime", {"tower:3", "--seconds", "inf"}, "got 'inf'"},
        BadArguments{"OverflowingTime", {"tower:3", "--seconds", "1e999"}, "got '1e999'"},
        BadArguments{"MissingTime", {"tower:3", "--seconds"}, "--seconds"},
        BadArguments{"NotANumberSigma", {"tower:3", "--heights-sigma", "nan"}, "0 to 0.003 m"},
        BadArguments{"NegativeSigma", {"tower:3", "--mass-sigma", "-1e-3"}, "--mass-sigma"},
        BadArguments{"NegativeGap", {"tower:3", "--start-gap", "-0.1"}, "--start-gap"},
        BadArguments{"NegativeSeed", {"tower:3", "--seed", "-1"}, "--seed"},
        BadArguments{"BrokenSeed", {"tower:3", "--seed", "1.5"}, "whole number"},
        BadArguments{"NoTolerance", {"tower:3", "--tolerance", "0"}, "--tolerance"},
        BadArguments{"NegativeSubsteps", {"tower:3", "--substeps", "-5"}, "--substeps"},
        BadArguments{"AbsurdSubsteps", {"tower:3", "--substeps", "1e9"}, "--substeps"},
        BadArguments{"NoThreads", {"tower:3", "--threads", "0"}, "--threads"},
        BadArguments{"UnknownMethod", {"tower:3", "--method", "magic"}, "semi-implicit-euler"},
        BadArguments{"UnknownInertia", {"tower:3", "--inertia", "none"}, "lumped"},
        BadArguments{"TiltTooFar", {"tower:3", "--gravity-tilt", "200"}, "-180 to 180 deg"},
        BadArguments{"DirectionNoNumber", {"tower:3", "--gravity-direction", "north"}, "north"},
        BadArguments{"SwayWithoutFrequency", {"tower:3", "--gravity-sway", "1"}, "DEG:HZ"},
        BadArguments{"SwayNotANumber", {"tower:3", "--gravity-sway", "1:nan"}, "1:nan"},
        BadArguments{"PosesEveryWithoutPoses", {"tower:3", "--poses-every", "1"}, "--poses"},
        BadArguments{"PosesEveryNever", {"tower:3", "--poses", "p.csv", "--poses-every", "0"}, "--poses-every"},
        BadArguments{"UnwritableReport", {"tower:3", "--report", "/no-such-folder/r.json"}, "/no-such-folder/r.json"},
        BadArguments{"UnwritablePoses", {"tower:3", "--poses", "/no-such-folder/p.csv"}, "--poses"},
        BadArguments{"UnwritablePicture", {"tower:3", "--picture", "/no-such-folder/p.png"}, "--picture"},
        BadArguments{"FolderAsReport", {"tower:3", "--report", "/"}, "folder"},
        BadArguments{"NamelessReport", {"tower:3", "--report", ""}, "--report"},
        BadArguments{"PictureOfAnotherKind", {"tower:3", "--picture", "p.jpg"}, ".png"},
        BadArguments{"OneNameForTwoFiles", {"tower:3", "--report", "a.png", "--picture", "a.png"}, "two names"},
        BadArguments{"OneFileByTwoNames", {"tower:3", "--report", "a", "--poses", "./a"}, "which are one"},
        BadArguments{"NameOfAPartialFile", {"tower:3", "--report", "a", "--poses", "a.partial"}, "other with .partial"},
        BadArguments{"PartialFileOfAName", {"tower:3", "--report", "a.partial", "--poses", "a"}, "other with .partial"}),
    [](const auto& tested) { return tested.param.name; });

TEST(Program, WithoutACommandNamesTheCommands) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{{}, {"jump"}, {"--colour"}}) {
    const ProgramResult result = runProgram("springtower", arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_THAT(result.error, HasSubstr("run, verdict, profile, statics, chart, validate, scenes and settings"));
    EXPECT_THAT(linesOf(result.error), SizeIs(2));
  }
}

TEST(Program, HelpTeachesWithExamples) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"--help"}, {"run", "--help"}, {"verdict", "-h"}}) {
    const ProgramResult result = runProgram("springtower", arguments);
    EXPECT_EQ(result.exitCode, 0);
    EXPECT_EQ(result.error, "");
    EXPECT_THAT(result.output, HasSubstr("examples:\n  "));
    for (const std::string& line : linesOf(result.output)) EXPECT_LE(line.size(), 130U) << line;
  }
  const std::string help = run({"--help"}).output;
  for (const char* option : {"--seconds", "--method", "--tolerance", "--substeps", "--inertia", "--threads", "--heights-sigma",
                             "--mass-sigma", "--seed", "--start-gap", "--gravity-tilt", "--gravity-direction", "--gravity-sway",
                             "--no-sleep", "--report", "--poses", "--poses-every", "--picture", "--allow-unstable"}) {
    EXPECT_THAT(help, HasSubstr(std::string("  ") + option + " "));
  }
}

TEST(Program, SaysItsVersion) {
  const ProgramResult result = runProgram("springtower", {"--version"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_THAT(result.output, ::testing::MatchesRegex("springtower [0-9]+\\.[0-9]+\\.[0-9]+ .*\n"));
}

TEST(Program, AFullDiskBehindStandardOutputIsAnError) {
  ASSERT_TRUE(std::ofstream("/dev/full")) << "every Linux has it";
  const std::string list = "{\"id\":\"a\",\"config\":\"(010)\"}\n";
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"run", "tower:1", "--seconds", "0.1"}, {"verdict", "-"}, {"statics", "-"}}) {
    const ProgramResult result = runProgram("springtower", arguments, list, "/dev/full");
    EXPECT_EQ(result.exitCode, 2) << arguments[0];
    EXPECT_EQ(result.error, "springtower: standard output: writing failed\n") << arguments[0];
  }
}

TEST(Program, AFullDiskBehindTheReportIsAnError) {
  ASSERT_TRUE(std::ofstream("/dev/full")) << "every Linux has it";
  const ProgramResult result = run({"tower:1", "--seconds", "0.1", "--report", "/dev/full"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, HasSubstr("--report: expected a file that can be written, got '/dev/full'"));
}

// A run whose poses fill a disk ends there, and what else it was to write is written.
TEST(Program, AFullDiskBehindThePosesCostsNoOtherFile) {
  const ScratchFolder scratch;
  const ProgramResult result = run({"tower:18", "--no-sleep", "--seconds", "100000", "--poses", "/dev/full", "--report",
                                    scratch.file("r.json"), "--save", scratch.file("s"), "--picture", scratch.file("p.png")});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, HasSubstr("--poses: expected a file that can be written, got '/dev/full'"));
  const Json report = Json::parse(contentOf(scratch.file("r.json")));
  EXPECT_EQ(report.at("interrupted"), true);
  EXPECT_LT(report.at("simulated_s").get<double>(), 1e5);
  EXPECT_EQ(runProgram("springtower", {"run", "--resume", scratch.file("s"), "--seconds", "0.1"}).exitCode, 0);
  EXPECT_NE(contentOf(scratch.file("p.png")), "");
}

// A whole number is decimal, whatever zeros it begins with.
TEST(RunCommand, ZerosBeforeANumberChangeNothing) {
  const std::vector<std::string> scene = {"tower:3", "--heights-sigma", "0.0002", "--seconds", "0.1", "--seed"};
  const auto hashOf = [&](const std::string& seed) {
    std::vector<std::string> arguments = scene;
    arguments.push_back(seed);
    return reportOf(arguments).at("state_hash");
  };
  EXPECT_EQ(hashOf("010"), hashOf("10"));
  EXPECT_NE(hashOf("010"), hashOf("8"));
  EXPECT_EQ(hashOf("08"), hashOf("8"));
}

TEST(RunCommand, ReportsEverythingByName) {
  const Json report = reportOf({"tower:1", "--seconds", "0.5", "--threads", "1"});
  for (const char* key : {"version", "scene", "method", "inertia"}) EXPECT_TRUE(report.at(key).is_string()) << key;
  for (const char* key : {"tolerance_m",
                          "stiffness_n_m",
                          "substeps",
                          "threads",
                          "simulated_s",
                          "wall_s",
                          "frames",
                          "steps",
                          "contact_evaluations",
                          "cubic_tests",
                          "max_penetration_all_mm",
                          "bottom_row_compression_mm",
                          "max_strain",
                          "jitter_mm_s",
                          "top_height_error_mm",
                          "energy_start_j",
                          "energy_end_j",
                          "max_energy_rise",
                          "max_force_imbalance",
                          "max_torque_imbalance",
                          "max_outside_cone_n",
                          "asleep_blocks",
                          "awake_blocks",
                          "contacts_born_penetrating"}) {
    EXPECT_TRUE(report.at(key).is_number()) << key;
  }
  for (const char* key : {"fall_time_s", "t_rest_s", "max_penetration_mm", "creep_mm"}) {
    EXPECT_TRUE(report.at(key).is_number() || report.at(key).is_null()) << key;
  }
  for (const char* key : {"median", "p99", "max", "cpu_median"}) EXPECT_GE(report.at("ms_per_frame").at(key), 0.0) << key;
  EXPECT_THAT(report.at("stage_ms"), SizeIs(7));
  EXPECT_TRUE(report.at("stands"));
  EXPECT_TRUE(report.at("fall_time_s").is_null());
  EXPECT_EQ(report.at("scene"), "tower:1");
  EXPECT_EQ(report.at("threads"), 1);
  EXPECT_EQ(report.at("frames"), 30);
  EXPECT_NEAR(report.at("simulated_s").get<double>(), 0.5, 1e-9);
  EXPECT_GE(report.at("steps"), 30);
  EXPECT_EQ(report.at("asleep_blocks").get<int>() + report.at("awake_blocks").get<int>(), 3);
  EXPECT_THAT(report.at("state_hash").get<std::string>(), ::testing::MatchesRegex("[0-9a-f]{16}"));
}

TEST(RunCommand, OptionsReachTheSimulation) {
  const Json fine = reportOf({"tower:1", "--seconds", "0.05", "--tolerance", "2e-5", "--inertia", "lumped", "--no-sleep"});
  EXPECT_DOUBLE_EQ(fine.at("tolerance_m"), 2e-5);
  EXPECT_EQ(fine.at("inertia"), "lumped");
  EXPECT_EQ(fine.at("sleep"), "off");
  const Json coarse = reportOf({"tower:1", "--seconds", "0.05", "--substeps", "50", "--method", "runge-kutta-4"});
  EXPECT_EQ(coarse.at("method"), "runge-kutta-4");
  EXPECT_EQ(coarse.at("steps"), 150);
  EXPECT_EQ(coarse.at("substeps"), 50);
}

// An option that was called otherwise stands in the help as what it is called now, and apart under its former name; it works by
// either name, not by both.
TEST(RunCommand, TakesTheFormerNameOfAnOption) {
  const std::vector<std::string> misfit = {"tower:3",     "--seconds", "0.02",       "--method", "semi-implicit-euler",
                                           "--tolerance", "1e-6",      "--substeps", "2"};
  const auto with = [&](std::initializer_list<std::string> flags) {
    std::vector<std::string> arguments = misfit;
    arguments.insert(arguments.end(), flags);
    return run(arguments);
  };
  EXPECT_THAT(with({}).error, HasSubstr("or allow_unstable"));
  EXPECT_EQ(with({"--allow-unstable"}).exitCode, 0);
  EXPECT_EQ(with({"--force-unstable"}).exitCode, 0);
  const ProgramResult both = with({"--allow-unstable", "--force-unstable"});
  EXPECT_EQ(both.exitCode, 2);
  EXPECT_THAT(both.error, ::testing::AllOf(HasSubstr("--allow-unstable"), HasSubstr("--force-unstable")));
  const std::string help = run({"--help"}).output;
  EXPECT_THAT(help, HasSubstr("formerly --force-unstable"));
  EXPECT_GT(help.find("  --force-unstable "), help.find("Former names:"));
}

TEST(RunCommand, WritesOneNameOfAMethodWhateverNameIsGiven) {
  EXPECT_EQ(reportOf({"(010)", "--seconds", "0.02", "--method", "bdf2"}).at("method"), "implicit");
  EXPECT_EQ(reportOf({"(010)", "--seconds", "0.02", "--method", "bdf2-eigen"}).at("method"), "implicit-eigen");
  EXPECT_EQ(reportOf({"(010)", "--seconds", "0.02", "--method", "legacy-2003"}).at("method"), "report");
}

TEST(RunCommand, TiltedGravitySlidesABlockAway) {
  const Json report = reportOf({"(010)", "--seconds", "1", "--gravity-tilt", "30", "--gravity-direction", "90"});
  EXPECT_FALSE(report.at("stands"));
  EXPECT_THAT(report.at("fall").get<std::string>(), HasSubstr("block 0"));
  EXPECT_GT(report.at("fall_time_s"), 0.0);
  EXPECT_LT(report.at("fall_time_s"), 0.5);
}

TEST(RunCommand, PrintsATable) {
  const ProgramResult result = run({"tower:1", "--seconds", "0.1"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.error, "") << "no progress where there is no terminal";
  EXPECT_THAT(result.output, StartsWith("tower:1, 3 blocks\n"));
  for (const char* name : {"stands", "penetration", "creep", "frame"}) EXPECT_THAT(result.output, HasSubstr(name));
  for (const char* name : {"height error against rigid stack  ", "max energy gain in a frame  "}) {
    EXPECT_THAT(result.output, HasSubstr(std::string("  ") + name)) << "a name and its figure are apart";
  }
}

TEST(RunCommand, WritesPosesInOrder) {
  const ScratchFolder scratch;
  const std::string file = scratch.file("poses.csv");
  const ProgramResult result = run({"(010)-(010)", "--seconds", "0.5", "--poses", file, "--poses-every", "0.2"});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const std::vector<std::string> lines = linesOf(contentOf(file));
  ASSERT_THAT(lines, SizeIs(1 + 3 * 2));
  EXPECT_EQ(lines[0], "time_s,block,x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3,x4,y4,z4,x5,y5,z5,x6,y6,z6,x7,y7,z7");
  for (std::size_t i = 1; i < lines.size(); ++i) {
    std::istringstream stream(lines[i]);
    std::vector<double> values;
    for (std::string value; std::getline(stream, value, ',');) values.push_back(std::stod(value));
    ASSERT_THAT(values, SizeIs(26));
    const std::size_t block = (i - 1) % 2;
    const std::size_t written = (i - 1) / 2;
    EXPECT_DOUBLE_EQ(values[0], 0.2 * static_cast<double>(written));
    EXPECT_EQ(values[1], static_cast<double>(block));
    // Corner bits x = 1, y = 2, z = 4 are the block's own axes; the second row is turned by a quarter, so its x is the world's y.
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const double x = (corner & 1U) != 0U ? 0.0405 : -0.0405;
      const double y = (corner & 2U) != 0U ? 0.01335 : -0.01335;
      const double z = ((corner & 4U) != 0U ? 0.0182 : 0.0) + 0.0182 * static_cast<double>(block);
      EXPECT_NEAR(values[2 + 3 * corner], block == 0 ? x : -y, 1e-4);
      EXPECT_NEAR(values[3 + 3 * corner], block == 0 ? y : x, 1e-4);
      EXPECT_NEAR(values[4 + 3 * corner], z, 1e-4);
    }
  }
}

TEST(RunCommand, WritesPosesOfEveryFrameUnlessToldOtherwise) {
  const ScratchFolder scratch;
  ASSERT_EQ(run({"(010)", "--seconds", "0.5", "--poses", scratch.file("poses.csv")}).exitCode, 0);
  EXPECT_THAT(linesOf(contentOf(scratch.file("poses.csv"))), SizeIs(1 + 31));
}

TEST(RunCommand, LeavesNoPartialFilesAndReplacesOldOnes) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("report.json")) << "old";
  ASSERT_EQ(run({"tower:1", "--seconds", "0.1", "--report", scratch.file("report.json")}).exitCode, 0);
  EXPECT_TRUE(Json::accept(contentOf(scratch.file("report.json"))));
  ASSERT_EQ(run({"tower:1", "--report", scratch.file("report.json"), "--poses", "/no-such-folder/p"}).exitCode, 2);
  EXPECT_TRUE(Json::accept(contentOf(scratch.file("report.json")))) << "a run that did not begin must not touch the old report";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch.path()), {}), 1);
}

TEST(RunCommand, WritesToADevice) {
  const ProgramResult result = run({"tower:1", "--seconds", "0.1", "--report", "/dev/stderr"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_TRUE(Json::accept(result.error)) << result.error;
}

// Width and height of a PNG (big-endian after the header's name), {0, 0} when it is none.
std::array<std::uint32_t, 2> sizeOfPng(const std::string& content) {
  if (content.size() < 24 || content.substr(1, 3) != "PNG" || content.substr(12, 4) != "IHDR") return {0, 0};
  std::array<std::uint32_t, 2> size{};
  for (std::size_t i = 0; i < 8; ++i) size[i / 4] = (size[i / 4] << 8U) | static_cast<unsigned char>(content[16 + i]);
  return size;
}

TEST(RunCommand, DrawsAPicture) {
  const ScratchFolder scratch;
  ASSERT_EQ(run({"tower:3", "--seconds", "0.1", "--picture", scratch.file("a.png")}).exitCode, 0);
  ASSERT_EQ(run({"(010)", "--seconds", "0.1", "--picture", scratch.file("b.png")}).exitCode, 0);
  const std::string tower = contentOf(scratch.file("a.png"));
  const auto [width, height] = sizeOfPng(tower);
  EXPECT_GE(width, 500U);
  EXPECT_GE(height, 500U);
  EXPECT_NEAR(static_cast<double>(width) * height, 1e6, 1e4);
  EXPECT_GT(tower.size(), 20000U) << "an empty picture of this size compresses to less";
  EXPECT_NE(tower, contentOf(scratch.file("b.png")));
}

TEST(RunCommand, ReadsSceneFiles) {
  const ScratchFolder scratch;
  const std::string file = scratch.file("scene.toml");
  std::ofstream(file) << "name = \"a lone block\"\nseconds = 0.25\n[[block]]\ncentre_m = [0.0, 0.0, 0.0091]\n";
  const Json report = reportOf({file});
  EXPECT_EQ(report.at("scene"), "a lone block");
  EXPECT_EQ(report.at("frames"), 15);
  EXPECT_EQ(reportOf({file, "--seconds", "0.5"}).at("frames"), 30) << "the command line decides";
  std::ofstream(file) << "seconds = [";
  EXPECT_EQ(run({file}).exitCode, 2);
}

TEST(RunCommand, DivergenceHasItsOwnExitCodeAndKeepsThePoses) {
  const ScratchFolder scratch;
  const ProgramResult result =
      run({"tower:6", "--seconds", "10", "--method", "semi-implicit-euler", "--tolerance", "1e-6", "--substeps", "2",
           "--allow-unstable", "--poses", scratch.file("poses.csv"), "--report", scratch.file("report.json")});
  EXPECT_EQ(result.exitCode, 3) << result.error;
  EXPECT_THAT(result.error, ::testing::MatchesRegex("springtower: .*block [0-9]+.* [0-9.e-]+ s.*\n"));
  EXPECT_THAT(linesOf(contentOf(scratch.file("poses.csv"))), SizeIs(::testing::Ge(19U)));
  EXPECT_FALSE(std::filesystem::exists(scratch.file("report.json")));
}

// Poses that cannot be written do not hide what has happened.
TEST(RunCommand, DivergenceIsSaidWhereThePosesCannotBeWritten) {
  const ProgramResult result = run({"tower:6", "--seconds", "10", "--method", "semi-implicit-euler", "--tolerance", "1e-6",
                                    "--substeps", "2", "--allow-unstable", "--poses", "/dev/full"});
  EXPECT_EQ(result.exitCode, 3) << result.error;
  EXPECT_THAT(result.error, HasSubstr("diverged"));
  EXPECT_THAT(result.error, HasSubstr("--poses: expected a file that can be written, got '/dev/full'"));
}

// After the line of each move a table says how far every other block moved in it, as the report does; the block in the hand has
// a dash.
TEST(RunMoves, PrintsHowFarEachOtherBlockMoved) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("take.toml")) << "[tower]\nrows = 5\n[[moves]]\ndo = \"take\"\nrow = 3\nposition = 2\n"
                                              "towards = \"+y\"\n";
  const ProgramResult result = run({scratch.file("take.toml"), "--report", scratch.file("report.json")});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const Json moved = Json::parse(contentOf(scratch.file("report.json"))).at("moves").at(0).at("moved_mm");
  ASSERT_EQ(moved.size(), 15U);
  std::vector<std::string> cells;
  for (const std::string& line : linesOf(result.output)) {
    if (!line.starts_with("  step 1")) continue;
    std::istringstream words(line);
    std::string word;
    words >> word >> word;
    while (words >> word) cells.push_back(word);
  }
  ASSERT_EQ(cells.size(), 15U);
  constexpr std::size_t kTaken = 10;
  for (std::size_t b = 0; b < cells.size(); ++b) {
    if (b == kTaken) {
      EXPECT_EQ(cells[b], "-");
    } else {
      EXPECT_NEAR(std::stod(cells[b]), moved.at(b).get<double>(), 5e-5) << b;
    }
  }
}

}  // namespace
}  // namespace springtower
