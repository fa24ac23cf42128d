#include "tests/support/program.h"
#include "tests/support/says.h"

#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;
using Json = nlohmann::ordered_json;

ProgramResult statics(std::vector<std::string> arguments, std::string_view input = {}) {
  arguments.insert(arguments.begin(), "statics");
  return runProgram("springtower", arguments, input);
}

Json staticsOf(std::vector<std::string> arguments) {
  const ScratchFolder scratch;
  arguments.insert(arguments.end(), {"--report", scratch.file("report.json")});
  const ProgramResult result = statics(arguments);
  EXPECT_EQ(result.exitCode, 0) << result.error;
  return Json::parse(contentOf(scratch.file("report.json")));
}

TEST(StaticsCommand, PrintsVerdictMarginAndATableOfTheBlocks) {
  const ProgramResult result = statics({"(111)-(1L1)-(010)", "--contacts", "--pull", "1:2,+x"});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(result.error, "");
  EXPECT_THAT(result.output, HasSubstr("verdict     stands\n"));
  EXPECT_THAT(result.output, HasSubstr("margin      21.80 deg"));
  EXPECT_THAT(result.output, HasSubstr("loose 0.300 mm"));
  EXPECT_THAT(result.output, HasSubstr("block 1:2 along +x: at most 0.0769 N"));
  EXPECT_THAT(result.output, HasSubstr("    block  weight N    load N       min       max   above            if removed "));
  EXPECT_THAT(result.output, HasSubstr("    upper    lower    normal N  friction N"));
  // 7 blocks and 15 contacts, below the head lines and two empty ones.
  EXPECT_THAT(linesOf(result.output), SizeIs(5 + 2 + 7 + 2 + 15));
}

TEST(StaticsCommand, ReportsAllFiguresAsJson) {
  const Json report = staticsOf({"(111)-(1L1)-(010)", "--pull", "1:2,-x", "--pull", "0,-z"});
  EXPECT_EQ(report.at("stands"), true);
  EXPECT_EQ(report.at("leans"), false);
  EXPECT_EQ(report.at("friction"), 0.4);
  EXPECT_EQ(report.at("forces_are"), "least squares");
  EXPECT_NEAR(report.at("tilt_deg").get<double>(), 21.80, 0.01);
  EXPECT_THAT(report.at("blocks"), SizeIs(7));
  EXPECT_EQ(report.at("blocks").at(4).at("row"), 1);
  EXPECT_EQ(report.at("blocks").at(4).at("loose"), true);
  EXPECT_EQ(report.at("blocks").at(4).at("removal").at("stands"), true);
  EXPECT_THAT(report.at("contacts"), SizeIs(15));
  EXPECT_EQ(report.at("contacts").at(0).at("lower"), "floor");
  double floor = 0.0;
  for (const Json& contact : report.at("contacts")) {
    if (contact.at("lower") == "floor") floor += contact.at("normal_n").get<double>();
  }
  EXPECT_NEAR(floor, 7 * 0.0196 * 9.81, 1e-6);
  EXPECT_EQ(report.at("pulls").at(0).at("block"), 4);
  EXPECT_EQ(report.at("pulls").at(1).at("unlimited"), true);
}

TEST(StaticsCommand, SaysWhenASceneFallsOrLeans) {
  // Two blocks meet at a corner: no gravity within the friction limit brings the upper one's weight there.
  const Json falls = staticsOf({"(001)-(100)"});
  EXPECT_EQ(falls.at("stands"), false);
  EXPECT_TRUE(falls.at("tilt_deg").is_null());
  EXPECT_TRUE(falls.at("forces_are").is_null());
  EXPECT_THAT(statics({"(001)-(100)"}).output, HasSubstr("verdict     falls"));
  // Four blocks on one beside them: their centre is 36.4 mm above its edge and 13.8 mm beside it.
  const Json nearly = staticsOf({"(001)-(010)-(010)-(010)-(010)"});
  EXPECT_EQ(nearly.at("stands"), false);
  EXPECT_NEAR(nearly.at("tilt_deg").get<double>(), -std::atan(13.8 / 36.4) * 57.29578, 0.01);
  EXPECT_NEAR(nearly.at("tilt_direction_deg").get<double>(), 90.0, 0.01);
  const Json leans = staticsOf({"(1L1)-(010)-(010)", "--remove", "0:1"});
  EXPECT_EQ(leans.at("stands"), true);
  EXPECT_EQ(leans.at("leans"), true);
  EXPECT_NEAR(leans.at("settlement_mm").get<double>(), 0.1525, 0.001);
}

TEST(StaticsCommand, TakesTheOptionsOfARun) {
  EXPECT_NEAR(staticsOf({"(010)", "--mu", "0.2", "--no-removals"}).at("tilt_deg").get<double>(), std::atan(0.2) * 57.29578, 0.01);
  EXPECT_NEAR(staticsOf({"(010)", "--gravity-tilt", "10", "--gravity-direction", "90"}).at("tilt_deg").get<double>(), 11.80,
              0.01);
  EXPECT_FALSE(staticsOf({"(010)", "--no-removals"}).at("blocks").at(0).contains("removal"));
  const Json one = staticsOf({"tower:4", "--heights-sigma", "0.0002", "--mass-sigma", "0.001", "--seed", "1", "--threads", "1"});
  const Json two = staticsOf({"tower:4", "--heights-sigma", "0.0002", "--mass-sigma", "0.001", "--seed", "2"});
  EXPECT_NE(one.at("blocks"), two.at("blocks"));
  const Json again =
      staticsOf({"tower:4", "--heights-sigma", "0.0002", "--mass-sigma", "0.001", "--seed", "1", "--threads", "3"});
  EXPECT_EQ(one.at("blocks"), again.at("blocks"));
  EXPECT_EQ(one.at("contacts"), again.at("contacts"));
  EXPECT_EQ(staticsOf({std::string(SPRINGTOWER_SOURCE_DIR) + "/scenes/report_t1.toml"}).at("stands"), true);
}

struct BadStaticsArguments {
  std::string name;
  std::vector<std::string> arguments;
  std::string message;
};

class StaticsBadArgumentsTest : public ::testing::TestWithParam<BadStaticsArguments> {};

TEST_P(StaticsBadArgumentsTest, AreNamed) {
  const ProgramResult result = statics(GetParam().arguments);
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.output, "");
  EXPECT_THAT(result.error, says(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    StaticsCommand, StaticsBadArgumentsTest,
    ::testing::Values(BadStaticsArguments{"NoScene", {}, "expected SCENE, got none"},
                      BadStaticsArguments{"Typo", {"(012)"}, "character 4"},
                      BadStaticsArguments{"Friction", {"(010)", "--mu", "-1"}, "--mu"},
                      BadStaticsArguments{"RemoveAbsent", {"(010)", "--remove", "0:1"}, "--remove: expected ..., got '0:1'"},
                      BadStaticsArguments{"RemoveTwice", {"(111)", "--remove", "0:1", "--remove", "0"}, "got '0' twice"},
                      BadStaticsArguments{
                          "RemoveAll", {"(010)", "--remove", "0"}, "expected 1 to 1000 blocks for statics, got 0"},
                      BadStaticsArguments{"PullWithoutAxis", {"(010)", "--pull", "0"}, "--pull: expected BLOCK,AXIS..., got '0'"},
                      BadStaticsArguments{"PullAxis", {"(010)", "--pull", "0,up"}, "expected the axis ..., got 'up'"},
                      BadStaticsArguments{"PullBlock", {"(010)", "--pull", "7,x"}, "--pull: expected ..., got '7'"},
                      BadStaticsArguments{"TooMany", {"tower:400"}, "expected 1 to 1000 blocks for statics, got 1200"},
                      BadStaticsArguments{"CheckOfAScene", {"(010)", "--check"}, "--check: expected ..., got the scene"},
                      BadStaticsArguments{"OptionOfAList", {"-", "--mu", "0.3"}, "--mu: expected ..., got it with a list"},
                      BadStaticsArguments{"NoFile", {"/does/not/exist.jsonl"}, "a file that can be read"},
                      BadStaticsArguments{"Report", {"(010)", "--report", "/does/not/exist.json"}, "--report"}),
    [](const auto& test) { return test.param.name; });

constexpr std::string_view kList =
    "{\"id\":\"a\",\"config\":\"(111)\",\"expect\":{\"stands\":true,\"clear\":true,\"tilt_deg\":21.8}}\n"
    "\n"
    "{\"id\":\"b\",\"config\":\"(001)-(010)\",\"expect\":{\"stands\":false,\"clear\":true}}\n"
    "{\"id\":\"c\",\"config\":\"(111)-(111)\",\"remove\":[{\"row\":0,\"position\":1},{\"row\":0,\"position\":2}],"
    "\"stands_after\":[true,true,false]}\n";

TEST(StaticsList, AnswersLineByLineInOrder) {
  const ProgramResult result = statics({"-"}, kList);
  ASSERT_EQ(result.exitCode, 0) << result.error;
  const std::vector<std::string> lines = linesOf(result.output);
  ASSERT_THAT(lines, SizeIs(3));
  EXPECT_EQ(Json::parse(lines[0]).at("id"), "a");
  EXPECT_EQ(Json::parse(lines[0]).at("stands"), true);
  EXPECT_NEAR(Json::parse(lines[0]).at("tilt_deg").get<double>(), 21.8, 0.01);
  EXPECT_EQ(Json::parse(lines[1]).at("stands"), false);
  EXPECT_EQ(Json::parse(lines[2]).at("stands_after").dump(), "[true,true,false]");
  EXPECT_EQ(statics({"-", "--threads", "1"}, kList).output, result.output);
}

TEST(StaticsList, CheckComparesVerdictsStatesAndTilts) {
  const ProgramResult agrees = statics({"-", "--check"}, kList);
  EXPECT_EQ(agrees.exitCode, 0) << agrees.error;
  EXPECT_THAT(agrees.error, HasSubstr("states of sequences             3        3        0"));
  const auto changed = [](std::string_view from, std::string_view to) {
    std::string list(kList);
    list.replace(list.find(from), from.size(), to);
    return statics({"-", "--check"}, list);
  };
  EXPECT_EQ(changed("21.8", "21.95").exitCode, 1);
  EXPECT_THAT(changed("21.8", "21.95").error, HasSubstr("line 1: a differs by 0.1"));
  EXPECT_EQ(changed("\"stands\":false", "\"stands\":true").exitCode, 1);
  EXPECT_EQ(changed("true,false]", "true,true]").exitCode, 1);
  EXPECT_THAT(changed("true,false]", "true,true]").error, HasSubstr("line 4: c differs after 2 removals"));
  EXPECT_EQ(statics({"-", "--check"}, "{\"id\":\"a\",\"config\":\"(111)\"}").exitCode, 2) << "nothing to compare with";
}

TEST(StaticsList, NamesTheLineThatIsBroken) {
  const auto broken = [](const std::string& line) { return statics({"-"}, "\n" + line + "\n").error; };
  EXPECT_THAT(broken("not json"), says("line 2: expected ..., got 'not json'"));
  EXPECT_THAT(broken("{\"id\":\"a\",\"config\":\"(010)\",\"remove\":7}"), says("line 2: remove: expected ..., got '7'"));
  EXPECT_THAT(broken("{\"id\":\"a\",\"config\":\"(010)\",\"remove\":[{\"row\":0,\"position\":1}]}"), HasSubstr("still there"));
  EXPECT_THAT(broken("{\"id\":\"a\",\"config\":\"(010)\",\"remove\":[],\"stands_after\":[]}"),
              says("stands_after: expected ..., got "));
  EXPECT_THAT(broken("{\"id\":\"a\",\"config\":\"(010)\",\"stands_after\":[true]}"), HasSubstr("without remove"));
  EXPECT_THAT(broken("{\"id\":\"a\",\"config\":\"(010)\",\"remove\":[],\"remove\":[]}"),
              says("line 2: expected each key once, got 'remove' for the second time"));
  EXPECT_THAT(
      broken("{\"id\":\"a\",\"config\":\"(010)\",\"remove\":" + std::string(200000, '[') + std::string(200000, ']') + "}"),
      HasSubstr("line 2: in 'remove': expected at most 32 levels of nesting, got more"));
}

TEST(StaticsList, ABadLineLeavesItsIdToOthers) {
  const ProgramResult result = statics({"-", "--keep-going"},
                                       "{\"id\":\"a\",\"config\":\"(010)\",\"remove\":7}\n"
                                       "{\"id\":\"a\",\"config\":\"(010)\"}\n");
  EXPECT_THAT(linesOf(result.output), SizeIs(1)) << result.error;
  EXPECT_THAT(result.error, HasSubstr("1 of 2 lines was bad"));
}

// The oracle was made by a program of its own. All its clear verdicts, and its tilts: of towers that stand within 0.1 degrees.
class StaticsOracleTest : public ::testing::TestWithParam<std::string> {};

TEST_P(StaticsOracleTest, AgreesOnEveryClearLine) {
  const ProgramResult result = statics({std::string(SPRINGTOWER_TEST_DATA_DIR) + "/oracle/" + GetParam(), "--check"});
  EXPECT_EQ(result.exitCode, 0) << result.error;
  // What --check says is not taken on trust.
  std::size_t judged = 0;
  for (const std::string& text : linesOf(result.output)) {
    const Json line = Json::parse(text);
    const Json& expect = line.at("expect");
    if (!expect.at("clear").get<bool>()) continue;
    ++judged;
    EXPECT_EQ(line.at("stands"), expect.at("stands")) << text;
    if (!expect.at("stands").get<bool>()) continue;
    EXPECT_EQ(line.at("leans"), false) << text;
    EXPECT_NEAR(line.at("tilt_deg").get<double>(), expect.at("tilt_deg").get<double>(), 0.1) << text;
  }
  EXPECT_GE(judged, 59U);
}

INSTANTIATE_TEST_SUITE_P(Statics, StaticsOracleTest, ::testing::Values("small.jsonl", "shift.jsonl", "loose.jsonl", "r18.jsonl"),
                         [](const auto& test) { return test.param.substr(0, test.param.find('.')); });

TEST(StaticsOracle, AgreesOnEveryStateOfTheRemovals) {
  const std::string path = std::string(SPRINGTOWER_TEST_DATA_DIR) + "/oracle/removal.jsonl";
  const ProgramResult result = statics({path, "--check"});
  EXPECT_EQ(result.exitCode, 0) << result.error;
  const std::vector<std::string> asked = linesOf(contentOf(path));
  const std::vector<std::string> answered = linesOf(result.output);
  ASSERT_EQ(asked.size(), answered.size());
  ASSERT_THAT(asked, SizeIs(10));
  for (std::size_t i = 0; i < asked.size(); ++i) {
    EXPECT_EQ(Json::parse(asked[i]).at("stands_after"), Json::parse(answered[i]).at("stands_after"));
  }
}

}  // namespace
}  // namespace springtower
