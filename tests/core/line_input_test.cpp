#include "core/line_input.h"

#include "core/error.h"
#include "tests/support/program.h"

#include <fstream>
#include <gmock/gmock.h>
#include <sstream>
#include <vector>

namespace springtower {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<std::string> linesIn(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; readLine(stream, line, "text");) lines.push_back(line);
  return lines;
}

TEST(LineInput, ReadsWhatGetlineReads) {
  for (const std::string text : {"", "\n", "a", "a\n", "a\nb", "\n\na\r\n", "a\n\n"}) {
    std::istringstream stream(text);
    std::vector<std::string> expected;
    for (std::string line; std::getline(stream, line);) expected.push_back(line);
    EXPECT_EQ(linesIn(text), expected) << text;
  }
}

TEST(LineInput, RefusesLinesThatAreTooLong) {
  const std::string longest(kMaxLineBytes, 'a');
  EXPECT_THAT(linesIn(longest + "\nb"), ElementsAre(longest, "b"));
  EXPECT_THAT([&] { linesIn(longest + "a"); }, ThrowsMessage<InputError>("text: expected at most 1 MB in a line, got more"));
}

TEST(LineInput, EndsAtOnceForADeviceWithoutLines) {
  LineInput input("/dev/zero");
  std::string line;
  EXPECT_THAT([&] { input.next(line); },
              ThrowsMessage<InputError>(HasSubstr("/dev/zero, line 1: expected at most 1 MB in a line, got more")));
}

TEST(LineInput, CountsLinesAndSeesTheirEnd) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("a")) << "one\ntwo";
  LineInput input(scratch.file("a"));
  std::string line;
  ASSERT_TRUE(input.next(line));
  EXPECT_EQ(input.where(), scratch.file("a") + ", line 1");
  EXPECT_FALSE(input.endedWithFile());
  ASSERT_TRUE(input.next(line));
  EXPECT_EQ(input.number(), 2U);
  EXPECT_TRUE(input.endedWithFile());
  EXPECT_FALSE(input.next(line));
  EXPECT_EQ(input.number(), 2U);
}

TEST(LineInput, RefusesFoldersAndWhatIsNotThere) {
  const ScratchFolder scratch;
  EXPECT_THAT([&] { LineInput input(scratch.path().string()); },
              ThrowsMessage<InputError>(HasSubstr("expected a file, got a folder")));
  EXPECT_THAT([&] { LineInput input(scratch.file("none"), "--peers"); },
              ThrowsMessage<InputError>("--peers: " + scratch.file("none") +
                                        ": expected a file that can be read, got none: No such file or directory"));
}

}  // namespace
}  // namespace springtower
