#include "core/whole_file.h"

#include "core/error.h"
#include "tests/support/program.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

using testing::ThrowsMessage;

TEST(WholeFile, HasEveryByteUpToItsLimit) {
  const ScratchFolder scratch;
  const std::string bytes = std::string("a\0\r\n\xff", 5) + std::string(200000, 'b');
  std::ofstream(scratch.file("a"), std::ios::binary) << bytes;
  EXPECT_EQ(wholeFile(scratch.file("a"), "it"), bytes);
  EXPECT_EQ(wholeFile(scratch.file("a"), "it", bytes.size()), bytes);
  EXPECT_THAT([&] { wholeFile(scratch.file("a"), "it", bytes.size() - 1); },
              ThrowsMessage<InputError>("it: expected at most 200004 bytes, got more"));
  std::ofstream(scratch.file("empty"));
  EXPECT_EQ(wholeFile(scratch.file("empty"), "it"), "");
}

TEST(WholeFile, IsNoFolderDeviceOrMissingFile) {
  const ScratchFolder scratch;
  EXPECT_THAT([&] { wholeFile(scratch.path().string(), "it"); }, ThrowsMessage<InputError>("it: expected a file, got a folder"));
  EXPECT_THAT([&] { wholeFile("/dev/zero", "it", kMaxResultsBytes); },
              ThrowsMessage<InputError>("it: expected at most 16777216 bytes, got more"));
  EXPECT_THAT([&] { wholeFile(scratch.file("none"), "it"); },
              ThrowsMessage<InputError>("it: expected a file that can be read, got one that cannot"));
}

}  // namespace
}  // namespace springtower
