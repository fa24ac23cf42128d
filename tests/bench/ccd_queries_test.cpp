#include "narrowphase/exact/query_set.h"
#include "tests/support/program.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace springtower {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

const std::string kSets = SPRINGTOWER_TEST_DATA_DIR "/ccd/";

ProgramResult ccdQueries(const std::vector<std::string>& arguments) {
  return runProgram("ccd_queries", arguments);
}

// The whole numbers of the first table that is printed, by the names of their columns.
std::map<std::string, int> figuresOf(const ProgramResult& result) {
  const std::vector<std::string> lines = linesOf(result.output);
  std::map<std::string, int> figures;
  if (lines.size() < 2) return figures;
  std::istringstream names(lines[0]);
  std::istringstream values(lines[1]);
  for (int column = 0; column < 6; ++column) {
    std::string name;
    names >> name;
    values >> figures[name];
  }
  return figures;
}

// The fields of a line; an empty last one counts.
std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line + ',');
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

struct Set {
  std::string name;
  std::string file;
  std::string kind;
  int queries;
  int meeting;
};

class CcdQueriesTest : public ::testing::TestWithParam<Set> {};

TEST_P(CcdQueriesTest, MissesNothingAndAnswersEveryQueryOnALineOfItsOwn) {
  const Set& set = GetParam();
  const ScratchFolder scratch;
  const std::string out = scratch.file("answers.csv");
  const ProgramResult result = ccdQueries({kSets + set.file, "--kind", set.kind, "--out", out});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(result.error, "");
  const std::map<std::string, int> expected = {
      {"queries", set.queries}, {"meeting", set.meeting}, {"missed", 0}, {"late", 0}, {"false", 0}, {"far", 0}};
  EXPECT_EQ(figuresOf(result), expected) << result.output;

  // What the table says is not taken on trust.
  const std::vector<CollisionQuery> queries = readCollisionQueries(kSets + set.file);
  const std::vector<std::string> lines = linesOf(contentOf(out));
  ASSERT_THAT(lines, SizeIs(queries.size() + 1));
  EXPECT_EQ(lines[0], "id,hit,toi");
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const std::vector<std::string> fields = fieldsOf(lines[i + 1]);
    ASSERT_THAT(fields, SizeIs(3)) << lines[i + 1];
    EXPECT_EQ(fields[0], queries[i].id) << "in the order of the set";
    EXPECT_EQ(fields[1], queries[i].exact.hit ? "1" : "0") << lines[i + 1];
    if (!queries[i].exact.hit) {
      EXPECT_EQ(fields[2], "") << lines[i + 1];
    } else {
      EXPECT_LE(std::stod(fields[2]), std::nextafter(queries[i].exact.time, 2.0)) << lines[i + 1];
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CcdQueries, CcdQueriesTest,
                         ::testing::Values(Set{"SyntheticPointTriangle", "synthetic-sim/vf.csv", "vf", 1910, 124},
                                           Set{"SyntheticEdgeEdge", "synthetic-sim/ee.csv", "ee", 2396, 225},
                                           Set{"DegeneratePointTriangle", "degenerate/vf.csv", "vf", 401, 241},
                                           Set{"DegenerateEdgeEdge", "degenerate/ee.csv", "ee", 449, 267}),
                         [](const auto& tested) { return tested.param.name; });

const std::string kHeader =
    "id,set,src,family,gt,toi,min_dist,gt_f32,a0x,a0y,a0z,b0x,b0y,b0z,c0x,c0y,c0z,d0x,d0y,d0z,a1x,a1y,a1z,b1x,b1y,b1z,c1x,c1y,"
    "c1z,d1x,d1y,d1z\n";

// A point falls from `height` to as far below a triangle at rest: they meet at half time.
std::string falling(const std::string& id, const std::string& truth, const std::string& sideways = "0.25") {
  const std::string triangle = "0,0,0,1,0,0,0,1,0";
  return fmt::format("{0},set,src,family,{1},0,{2},0.25,0.5,{3},{2},0.25,-0.5,{3}\n", id, truth, sideways, triangle);
}

TEST(CcdQueries, CountWhatDiffersFromTheTruthOfTheSet) {
  const ScratchFolder scratch;
  const std::string set = scratch.file("set.csv");
  std::ofstream(set) << kHeader << falling("right", "1,0.5,0") << falling("beside", "0,,4", "5")
                     << falling("said to meet", "1,0.5,0", "5") << falling("said to meet before", "1,0.25,0")
                     << falling("said to pass near", "0,,0") << falling("said to pass far away", "0,,3");
  const ProgramResult result = ccdQueries({set, "--kind", "vf"});
  EXPECT_EQ(result.exitCode, 0) << result.error;
  const std::map<std::string, int> expected = {{"queries", 6}, {"meeting", 3}, {"missed", 1},
                                               {"late", 1},    {"false", 2},   {"far", 1}};
  EXPECT_EQ(figuresOf(result), expected) << result.output;
}

TEST(CcdQueries, TakeAPointAndATriangleForOtherThingsThanTwoEdges) {
  const ScratchFolder scratch;
  const std::string set = scratch.file("set.csv");
  std::ofstream(set) << kHeader << falling("falling", "1,0.5,0");
  EXPECT_EQ(figuresOf(ccdQueries({set, "--kind", "vf"})).at("missed"), 0);
  EXPECT_EQ(figuresOf(ccdQueries({set, "--kind", "ee"})).at("missed"), 1) << "the edges a-b and c-d pass each other";
}

struct BadCall {
  std::string name;
  std::vector<std::string> arguments;
  std::string message;
};

class CcdQueriesRefuseTest : public ::testing::TestWithParam<BadCall> {};

TEST_P(CcdQueriesRefuseTest, InOneLineWithExitCodeTwo) {
  const ProgramResult result = ccdQueries(GetParam().arguments);
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.output, "");
  EXPECT_THAT(result.error, AllOf(StartsWith("ccd_queries: "), HasSubstr(GetParam().message)));
  EXPECT_THAT(linesOf(result.error), SizeIs(1));
}

const std::string kSmallSet = kSets + "degenerate/vf.csv";

INSTANTIATE_TEST_SUITE_P(
    CcdQueries, CcdQueriesRefuseTest,
    ::testing::Values(
        BadCall{"NoFile", {}, "FILE"}, BadCall{"NoKind", {kSmallSet}, "--kind"},
        BadCall{"UnknownKind", {kSmallSet, "--kind", "ve"}, "--kind"},
        BadCall{"UnknownOption", {kSmallSet, "--kind", "vf", "--colour"}, "--colour"},
        BadCall{
            "MissingFile", {"no-such-file.csv", "--kind", "vf"}, "no-such-file.csv: expected a file that can be read, got none"},
        BadCall{"Folder", {kSets, "--kind", "vf"}, kSets},
        BadCall{"OutWithoutName",
                {kSmallSet, "--kind", "vf", "--out", ""},
                "--out: expected a file that can be written, got '': an empty name"},
        BadCall{"OutIsAFolder", {kSmallSet, "--kind", "vf", "--out", "/"}, "--out: expected a file that can be written, got '/'"},
        BadCall{"OutInNoFolder", {kSmallSet, "--kind", "vf", "--out", "/no/such/answers.csv"}, "/no/such/answers.csv"},
        BadCall{"FullDisk",
                {kSmallSet, "--kind", "vf", "--out", "/dev/full"},
                "--out: expected a file that can be written, got '/dev/full'"}),
    [](const auto& tested) { return tested.param.name; });

TEST(CcdQueries, NameTheLineThatIsBrokenAndLeaveAnOlderFileAlone) {
  const ScratchFolder scratch;
  const std::string set = scratch.file("set.csv");
  const std::string out = scratch.file("answers.csv");
  std::ofstream(set) << kHeader << falling("right", "1,0.5,0") << falling("wrong", "1,half,0");
  std::ofstream(out) << "older\n";
  const ProgramResult result = ccdQueries({set, "--kind", "vf", "--out", out});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(result.error, fmt::format("ccd_queries: {}, line 3: expected a number from 0 to 1 in column toi, got 'half'\n", set));
  EXPECT_EQ(contentOf(out), "older\n");
}

TEST(CcdQueries, LeaveNoPartialFileBesideTheirAnswers) {
  const ScratchFolder scratch;
  const ScratchFolder answers;
  const std::string set = scratch.file("set.csv");
  std::ofstream(set) << kHeader << falling("right", "1,0.5,0");
  ASSERT_EQ(ccdQueries({set, "--kind", "vf", "--out", answers.file("answers.csv")}).exitCode, 0);
  EXPECT_THAT(contentOf(answers.file("answers.csv")), StartsWith("id,hit,toi\nright,1,0.4999"));
  EXPECT_THAT(std::vector<std::filesystem::path>(std::filesystem::directory_iterator(answers.path()), {}), SizeIs(1));
}

TEST(CcdQueries, AFullDiskBehindStandardOutputIsAnError) {
  const ProgramResult result = runProgram("ccd_queries", {kSmallSet, "--kind", "vf"}, {}, "/dev/full");
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.error, "ccd_queries: standard output: writing failed\n");
}

TEST(CcdQueries, HelpTeachesWithExamples) {
  const ProgramResult result = ccdQueries({"--help"});
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_THAT(result.error, IsEmpty());
  EXPECT_THAT(result.output, HasSubstr("examples:\n  ccd_queries "));
}

}  // namespace
}  // namespace springtower
