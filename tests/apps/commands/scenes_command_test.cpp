#include "scenarios/registry.h"
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace springtower {
namespace {

using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(ScenesCommand, ListsEveryNameWithItsSizesAndWhatItIs) {
  const ProgramResult result = runProgram("springtower", {"scenes"});
  ASSERT_EQ(result.exitCode, 0) << result.error;
  EXPECT_EQ(result.error, "");
  const std::vector<std::string> lines = linesOf(result.output);
  EXPECT_THAT(lines, SizeIs(1 + scenarios().size()));
  for (const std::string& line : lines) EXPECT_LE(line.size(), 130U) << line;
  for (const Scenario& scenario : scenarios()) EXPECT_THAT(result.output, HasSubstr(std::string(scenario.what)));
  EXPECT_THAT(lines, Contains(ContainsRegex("^tower:ROWS .* 18; 1 to 2000 rows$")));
  EXPECT_THAT(lines, Contains(ContainsRegex("^wall:COLUMNSxCOURSES .* 20x12; 1 to 4000 columns, 1 to 100 courses$")));
  EXPECT_THAT(lines, Contains(ContainsRegex("^thrown .* has none$")));
}

TEST(ScenesCommand, TakesNoArguments) {
  const ProgramResult result = runProgram("springtower", {"scenes", "tower"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_THAT(result.error, HasSubstr("tower"));
  EXPECT_THAT(linesOf(result.error), SizeIs(2));
}

TEST(ScenesCommand, ItsNamesAreTakenByTheOtherCommands) {
  const ProgramResult statics = runProgram("springtower", {"statics", "wall:3x2", "--no-removals"});
  EXPECT_EQ(statics.exitCode, 0) << statics.error;
  EXPECT_THAT(statics.output, HasSubstr("verdict     stands\n"));
  const ProgramResult run = runProgram("springtower", {"run", "dropped-flat", "--seconds", "0.1"});
  EXPECT_EQ(run.exitCode, 0) << run.error;
  const ProgramResult unknown = runProgram("springtower", {"statics", "castle"});
  EXPECT_EQ(unknown.exitCode, 2);
  EXPECT_THAT(unknown.error, says("'castle': expected tower:ROWS, ..., got none of them"));
  EXPECT_THAT(linesOf(unknown.error), SizeIs(1));
}

}  // namespace
}  // namespace springtower
