#include "tests/support/program.h"
#include "tests/support/says.h"

#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using Json = nlohmann::ordered_json;

ProgramResult verdict(std::string_view input, std::vector<std::string> options = {}) {
  options.insert(options.begin(), {"verdict", "-"});
  return runProgram("springtower", options, input);
}

std::vector<Json> objectsOf(const ProgramResult& result) {
  std::vector<Json> objects;
  for (const std::string& line : linesOf(result.output)) objects.push_back(Json::parse(line));
  return objects;
}

// A tower of one row stands; a top block beside its support falls.
constexpr std::string_view kThree =
    "{\"id\":\"stands\",\"config\":\"(111)\",\"expect\":{\"stands\":true,\"clear\":true,\"edge_mm\":13.3}}\n"
    "\n"
    "{\"id\":\"falls\",\"config\":\"(001)-(010)\",\"expect\":{\"stands\":false,\"clear\":true}}\n"
    "{\"id\":\"slides\",\"config\":\"(010)\",\"mu\":0.2,\"gravity_tilt_deg\":15,\"gravity_direction_deg\":90}\n";

TEST(Verdict, SaysForEachLineInOrderWhetherItStands) {
  const ProgramResult result = verdict(kThree);
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(result.error, "");
  const std::vector<Json> lines = objectsOf(result);
  ASSERT_THAT(lines, SizeIs(3));
  EXPECT_EQ(lines[0].at("id"), "stands");
  EXPECT_EQ(lines[0].at("stands"), true);
  EXPECT_EQ(lines[1].at("id"), "falls");
  EXPECT_EQ(lines[1].at("stands"), false);
  EXPECT_EQ(lines[2].at("id"), "slides");
  EXPECT_EQ(lines[2].at("stands"), false);
  EXPECT_EQ(lines[0].at("expect").dump(), "{\"stands\":true,\"clear\":true,\"edge_mm\":13.3}") << "carried along as it came";
  EXPECT_FALSE(lines[2].contains("expect"));
  for (const Json& line : lines) {
    EXPECT_GT(line.at("steps"), 0);
    EXPECT_GT(line.at("time_s"), 0.0);
    EXPECT_LT(line.at("time_s"), 10.0);
    EXPECT_TRUE(line.contains("max_penetration_mm"));
    EXPECT_TRUE(line.contains("creep_mm"));
  }
  EXPECT_GE(lines[0].at("max_penetration_mm"), 0.0);
  EXPECT_GE(lines[0].at("creep_mm"), 0.0);
}

TEST(Verdict, IsTheSameFromAFileForAnyThreadsAndWithoutSleep) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("three.jsonl")) << kThree;
  const std::string one = verdict(kThree, {"--threads", "1"}).output;
  EXPECT_EQ(runProgram("springtower", {"verdict", scratch.file("three.jsonl"), "--threads", "4"}).output, one);
  const std::vector<Json> asleep = objectsOf(verdict(kThree));
  const std::vector<Json> awake = objectsOf(verdict(kThree, {"--no-sleep"}));
  ASSERT_EQ(asleep.size(), awake.size());
  for (std::size_t i = 0; i < awake.size(); ++i) EXPECT_EQ(asleep[i].at("stands"), awake[i].at("stands"));
}

TEST(Verdict, EndsAfterTheSecondsGiven) {
  const std::vector<Json> lines =
      objectsOf(verdict("{\"id\":\"a\",\"config\":\"(111)\"}", {"--seconds", "0.1", "--substeps", "40"}));
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_TRUE(lines[0].at("stands"));
  EXPECT_TRUE(lines[0].at("time_s").is_null()) << "neither fallen nor at rest yet";
  EXPECT_EQ(lines[0].at("steps"), 6 * 40);
}

TEST(Verdict, OffsetsAndLooseBlocksCount) {
  const std::string over =
      "{\"id\":\"a\",\"config\":\"(010)-(010)\",\"offsets_m\":[{\"row\":1,\"position\":2,\"dx\":0.0,\"dy\":0.0%}]}";
  const auto at = [&](const std::string& digits) {
    std::string line = over;
    line.replace(line.find('%'), 1, digits);
    return objectsOf(verdict(line)).at(0).at("stands").get<bool>();
  };
  // The lower block is 26.7 mm wide: the centre of the upper one may stand 13.35 mm aside.
  EXPECT_TRUE(at("11"));
  EXPECT_FALSE(at("16"));
  const std::string loose =
      "{\"id\":\"a\",\"config\":\"(111)-(010)\",\"lower_m\":[{\"row\":0,\"position\":2},{\"row\":0,\"position\":1,\"by\":0.0005}]"
      "}";
  EXPECT_EQ(verdict(loose).exitCode, 0);
}

TEST(Verdict, CheckComparesWithWhatIsExpected) {
  const ProgramResult agrees = verdict(kThree, {"--check"});
  EXPECT_EQ(agrees.exitCode, 0);
  EXPECT_THAT(objectsOf(agrees), SizeIs(3));
  EXPECT_THAT(agrees.error, HasSubstr("stands          1        1        0"));
  EXPECT_THAT(agrees.error, HasSubstr("falls           1        1        0"));

  std::string wrong(kThree);
  wrong.replace(wrong.find("false"), 5, "true");
  const ProgramResult differs = verdict(wrong, {"--check"});
  EXPECT_EQ(differs.exitCode, 1);
  EXPECT_THAT(objectsOf(differs), SizeIs(3));
  EXPECT_THAT(differs.error, HasSubstr("line 3: falls falls, expected that it stands"));

  std::string unclear(wrong);
  unclear.replace(unclear.rfind("\"clear\":true"), 12, "\"clear\":false");
  EXPECT_EQ(verdict(unclear, {"--check"}).exitCode, 0) << "what is not clear is not judged";
  EXPECT_EQ(verdict("{\"id\":\"a\",\"config\":\"(111)\"}", {"--check"}).exitCode, 2) << "nothing to compare with";
}

TEST(Verdict, OfATowerThatDivergesHasEveryKeyAndSaysWhen) {
  const std::string tower = "{\"id\":\"a\",\"config\":\"(111)-(111)-(111)\",\"expect\":{\"stands\":true}}";
  const ProgramResult result =
      verdict(tower, {"--method", "semi-implicit-euler", "--tolerance", "1e-6", "--substeps", "2", "--allow-unstable"});
  EXPECT_EQ(result.exitCode, 3);
  EXPECT_THAT(linesOf(result.error), SizeIs(1));
  const std::vector<Json> lines = objectsOf(result);
  ASSERT_THAT(lines, SizeIs(1));
  const Json& line = lines[0];
  EXPECT_TRUE(line.at("stands").is_null());
  const double time_s = line.at("time_s").get<double>();
  EXPECT_GT(time_s, 0.0);
  EXPECT_THAT(line.at("diverged").get<std::string>(), HasSubstr(fmt::format("{:.6f} s", time_s)));
  const double framesBegun = std::ceil(60.0 * time_s - 1e-6);  // the last of them is the one in which it diverged
  EXPECT_EQ(line.at("steps"), 2 * static_cast<int>(framesBegun - 1.0)) << "two in each whole frame";
  EXPECT_TRUE(line.at("max_penetration_mm").is_null());
  EXPECT_TRUE(line.at("creep_mm").is_null());
  EXPECT_EQ(line.at("expect").at("stands"), true);
}

TEST(Verdict, CarriesAlongAnExpectationThatIsDeepButNotAbsurdlySo) {
  const std::string deep = std::string(31, '[') + std::string(31, ']');
  const ProgramResult result = verdict("{\"id\":\"a\",\"config\":\"(010)\",\"expect\":" + deep + "}");
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(objectsOf(result).at(0).at("expect").dump(), deep);
}

TEST(Verdict, OfNothingIsNothing) {
  const ProgramResult result = verdict("");
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_EQ(result.output, "");
  EXPECT_THAT(result.error, testing::HasSubstr("expected at least one line, got none")) << "as if nothing was wrong";
}

struct BadLine {
  std::string name;
  std::string line;
  std::string message;
};

// Far deeper than a stack holds.
std::string nested(const std::string& open, const std::string& close) {
  std::string text;
  for (int level = 0; level < 100000; ++level) text += open;
  text += '1';
  for (int level = 0; level < 100000; ++level) text += close;
  return text;
}

class BrokenLineTest : public ::testing::TestWithParam<BadLine> {};

TEST_P(BrokenLineTest, IsNamedByItsNumber) {
  const std::string input =
      "{\"id\":\"first\",\"config\":\"(010)\"}\n\n" + GetParam().line + "\n{\"id\":\"last\",\"config\":\"(111)\"}\n";
  const ProgramResult result = verdict(input);
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(objectsOf(result), SizeIs(1)) << "the line before it, and none after";
  EXPECT_THAT(result.error, HasSubstr("standard input: line 3: "));
  EXPECT_THAT(result.error, says(GetParam().message));
  EXPECT_THAT(linesOf(result.error), SizeIs(1));
}

// Whatever has no line ends is refused before it fills the memory.
TEST(Verdict, ALineOfMoreThanAMegabyteIsRefused) {
  const ProgramResult result = runProgram("springtower", {"verdict", "/dev/zero"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, HasSubstr("/dev/zero: line 1: expected at most 1 MB in a line, got more"));
  EXPECT_THAT(verdict(std::string((1U << 20U) + 1, ' ') + "\n").error, HasSubstr("expected at most 1 MB in a line"));
  EXPECT_EQ(verdict(std::string(1U << 20U, ' ') + "\n{\"id\":\"a\",\"config\":\"(010)\"}\n").exitCode, 0) << "as long as may be";
}

INSTANTIATE_TEST_SUITE_P(
    Verdict, BrokenLineTest,
    ::testing::Values(
        BadLine{"NoJson", "not json", "got 'not json'"}, BadLine{"HalfJson", "{\"id\":\"a\"", "JSON object"},
        BadLine{"TwoObjects", "{\"id\":\"a\",\"config\":\"(010)\"} {}", "JSON object"},
        BadLine{"NoObject", "[1, 2]", "an object"}, BadLine{"NoId", "{\"config\":\"(010)\"}", "expected the key id, got none"},
        BadLine{"NoConfig", "{\"id\":\"a\"}", "expected the key config, got none"},
        BadLine{"IdNoText", "{\"id\":7,\"config\":\"(010)\"}", "id: expected ..., got '7'"},
        BadLine{"IdTwice", "{\"id\":\"first\",\"config\":\"(010)\"}", "second time"},
        BadLine{"Typo", "{\"id\":\"a\",\"config\":\"(010)-(0120)\"}", "character 10"},
        BadLine{"UnknownKey", "{\"id\":\"a\",\"config\":\"(010)\",\"colour\":1}", "unknown key 'colour'"},
        BadLine{"Removal", "{\"id\":\"a\",\"config\":\"(010)\",\"remove\":[]}", "unknown key 'remove'"},
        BadLine{"NegativeFriction", "{\"id\":\"a\",\"config\":\"(010)\",\"mu\":-0.1}", "mu: expected ..., got '-0.1'"},
        BadLine{"FrictionNoNumber", "{\"id\":\"a\",\"config\":\"(010)\",\"mu\":\"rough\"}", "0 to 10"},
        BadLine{"OverflowingFriction", "{\"id\":\"a\",\"config\":\"(010)\",\"mu\":1e999}", "JSON object"},
        BadLine{"TiltTooFar", "{\"id\":\"a\",\"config\":\"(010)\",\"gravity_tilt_deg\":999}", "gravity_tilt_deg"},
        BadLine{"OffsetsNoList", "{\"id\":\"a\",\"config\":\"(010)\",\"offsets_m\":{}}", "a list"},
        BadLine{"OffsetWithoutRow", "{\"id\":\"a\",\"config\":\"(010)\",\"offsets_m\":[{\"position\":2}]}",
                "offsets_m[0]: expected the key row, got none"},
        BadLine{"OffsetOfAbsentBlock",
                "{\"id\":\"a\",\"config\":\"(010)\",\"offsets_m\":[{\"row\":0,\"position\":1,\"dx\":0.001}]}",
                "row 0, position 1"},
        BadLine{"PositionNoWholeNumber", "{\"id\":\"a\",\"config\":\"(010)\",\"offsets_m\":[{\"row\":0,\"position\":1.5}]}",
                "1 to 3"},
        BadLine{"AbsurdlyLow", "{\"id\":\"a\",\"config\":\"(010)\",\"lower_m\":[{\"row\":0,\"position\":2,\"by\":1}]}",
                "lower_m[0]: by"},
        BadLine{"LoweredAbsentBlock", "{\"id\":\"a\",\"config\":\"(010)\",\"lower_m\":[{\"row\":0,\"position\":1}]}",
                "line 3: lower_m: (010): loose block at row 0, position 1"},
        BadLine{"OffsetIntoItsNeighbour",
                "{\"id\":\"a\",\"config\":\"(111)\",\"offsets_m\":[{\"row\":0,\"position\":1,\"dy\":0.01}],"
                "\"lower_m\":[{\"row\":0,\"position\":1}]}",
                "line 3: offsets_m: (111): block 0 (row 0, position 1) and block 1 (row 0, position 2): expected a start"},
        BadLine{"NestedLine", nested("[", "]"), "line 3: expected at most 32 levels of nesting, got more"},
        BadLine{"NestedExpectation", "{\"id\":\"a\",\"config\":\"(010)\",\"expect\":" + nested("[", "]") + "}",
                "line 3: in 'expect': expected at most 32 levels of nesting, got more"},
        BadLine{"NestedObjects", "{\"id\":\"a\",\"config\":\"(010)\",\"expect\":" + nested("{\"a\":", "}") + "}",
                "line 3: in 'expect': expected at most 32 levels of nesting, got more"},
        BadLine{"KeyTwice", "{\"id\":\"a\",\"config\":\"(010)\",\"mu\":0.1,\"mu\":0.2}",
                "line 3: expected each key once, got 'mu' for the second time"},
        BadLine{"KeyTwiceInAList",
                "{\"id\":\"a\",\"config\":\"(010)\",\"offsets_m\":[{\"row\":0,\"position\":2},"
                "{\"row\":0,\"position\":2,\"row\":0}]}",
                "line 3: in 'offsets_m': expected each key once, got 'row' for the second time"}),
    [](const auto& tested) { return tested.param.name; });

TEST(Verdict, NeedsAFileThatCanBeRead) {
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"verdict"}, {"verdict", "no-such-file.jsonl"}, {"verdict", "/"}}) {
    const ProgramResult result = runProgram("springtower", arguments);
    EXPECT_EQ(result.exitCode, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_THAT(result.error, ::testing::StartsWith("springtower: "));
  }
}

}  // namespace
}  // namespace springtower
