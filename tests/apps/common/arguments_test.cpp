// Command lines that no program can parse.
#include "apps/common/arguments.h"

#include "tests/support/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace springtower {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Arguments, LettersApart) {
  EXPECT_EQ(lettersApart("", ""), 0);
  EXPECT_EQ(lettersApart("", "abc"), 3);
  EXPECT_EQ(lettersApart("method", "metod"), 1);
  EXPECT_EQ(lettersApart("method", "emthod"), 1) << "neighbours swapped";
  EXPECT_EQ(lettersApart("kitten", "sitting"), 3);
  EXPECT_EQ(lettersApart("abc", "abc"), 0);
}

std::string firstLine(std::string_view program, const std::vector<std::string>& arguments) {
  const ProgramResult result = runProgram(program, arguments);
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_EQ(result.output, "");
  return linesOf(result.error).front();
}

TEST(Arguments, UnknownOnesAreNamedInTheirOrder) {
  EXPECT_EQ(firstLine("springtower", {"run", "(010)", "--qqqq", "--zzzz", "third"}),
            "springtower: expected arguments that --help lists, got the unknown arguments '--qqqq', '--zzzz', 'third'");
  EXPECT_THAT(firstLine("ccd_queries", {"a.csv", "--kind", "vf", "one", "two"}), HasSubstr("one, two"));
}

TEST(Arguments, UnknownOnesComeWithWhatTheyMayHaveMeant) {
  EXPECT_EQ(firstLine("springtower", {"run", "(010)", "--metod", "implicit"}),
            "springtower: expected arguments that --help lists, got the unknown arguments '--metod' (did you mean --method?), "
            "'implicit'");
  EXPECT_THAT(firstLine("springtower", {"run", "(010)", "--metod=implicit"}), HasSubstr("(did you mean --method?)"));
  EXPECT_THAT(firstLine("springtower", {"run", "(010)", "--tol", "1"}), HasSubstr("(did you mean --tolerance?)"));
  EXPECT_THAT(firstLine("springtower", {"rum", "(010)"}), HasSubstr("'rum' (did you mean run?)"));
  EXPECT_THAT(firstLine("springtower-viewer", {"--headles"}), HasSubstr("'--headles' (did you mean --headless?)"));
  EXPECT_THAT(firstLine("random_scenes", {"--cuont", "3"}), HasSubstr("'--cuont' (did you mean --count?)"));
  EXPECT_THAT(firstLine("springtower", {"verdict", "--chek"}), HasSubstr("'--chek' (did you mean --check?)"))
      << "not that FILE is missing";
}

TEST(Arguments, UnknownOnesThatAreNearNothingHaveNoHint) {
  EXPECT_EQ(firstLine("springtower", {"run", "(010)", "--xyzzy\n"}),
            "springtower: expected arguments that --help lists, got the unknown argument '--xyzzy\\x0a'");
  EXPECT_THAT(firstLine("springtower", {}),
              AllOf(StartsWith("springtower: expected a command among run, "), EndsWith(", got none")));
}

TEST(Arguments, MissingOnesAndThoseThatDoNotGoTogetherSayWhatIsExpected) {
  EXPECT_EQ(firstLine("springtower", {"verdict"}), "springtower: expected FILE, got none");
  EXPECT_EQ(firstLine("springtower", {"run", "(010)", "--seconds"}), "springtower: --seconds: expected S, got none");
  EXPECT_EQ(firstLine("springtower", {"run", "(010)", "--seconds", "1", "--seconds", "2"}),
            "springtower: --seconds: expected at most 1, got 2");
  EXPECT_EQ(firstLine("springtower", {"run", "(010)", "--forces"}), "springtower: --forces: expected --report as well, got none");
  EXPECT_EQ(firstLine("springtower", {"profile", "--quick", "--full"}), "springtower: expected --full or --quick, got both");
}

}  // namespace
}  // namespace springtower
