#include "core/byte_stream.h"

#include "core/error.h"
#include "core/version.h"
#include "tests/support/program.h"
#include "tests/support/says.h"

#include <cmath>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace springtower {

namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

enum class ByteColour : std::uint8_t { red, green };

}  // namespace

struct ByteSample {
  double number = 0.0;
  std::vector<std::array<float, 3>> list;
  std::optional<std::string> text;
  bool flag = false;
  std::vector<double> space;
};

template <class Stream>
void fieldsOf(Stream& stream, ByteSample& sample) {
  auto& [number, list, text, flag, space] = sample;
  stream(number, list, text, flag, sizeOf(space));
}

namespace {

template <class Value>
std::string bytesOf(const Value& value) {
  ByteWriter writer;
  writer(value);
  return writer.bytes();
}

template <class Value>
Value roundTrip(const Value& value) {
  const std::string bytes = bytesOf(value);
  ByteReader reader(bytes, "bytes");
  Value read{};
  reader(read);
  reader.end();
  return read;
}

TEST(ByteStream, KeepsEveryBit) {
  for (const double value : {0.0, -0.0, 0.1, 1e-320, -std::numeric_limits<double>::infinity(), std::nan("7")})
    EXPECT_EQ(bytesOf(roundTrip(value)), bytesOf(value));
  EXPECT_EQ(roundTrip(std::vector<std::string>{"", "two words", std::string("\0", 1)}),
            (std::vector<std::string>{"", "two words", std::string("\0", 1)}));
  EXPECT_EQ(roundTrip(std::optional<ByteColour>()), std::nullopt);
  EXPECT_EQ(roundTrip(std::optional(ByteColour::green)), ByteColour::green);
  EXPECT_EQ(roundTrip(Eigen::Vector3d(1.0, 2.0, 3.0)), Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST(ByteStream, OfWorkingSpaceOnlyTheSizeIsKept) {
  const ByteSample read = roundTrip(ByteSample{2.5, {{1.0F, 2.0F, 3.0F}}, "text", true, {7.0, 8.0}});
  EXPECT_EQ(read.number, 2.5);
  EXPECT_EQ(read.list, (std::vector<std::array<float, 3>>{{1.0F, 2.0F, 3.0F}}));
  EXPECT_EQ(read.text, "text");
  EXPECT_TRUE(read.flag);
  EXPECT_EQ(read.space, (std::vector{0.0, 0.0}));
}

TEST(ByteStream, RefusesWhatEndsEarlyOrLate) {
  const std::string bytes = bytesOf(ByteSample{2.5, {{1.0F, 2.0F, 3.0F}}, "text", true, {7.0}});
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader reader(std::string_view(bytes).substr(0, size), "the source");
    ByteSample sample;
    EXPECT_THAT([&] { reader(sample); }, ThrowsMessage<InputError>(says("the source: expected ..., got "))) << size;
  }
  ByteReader reader("12", "the source");
  std::int8_t first = 0;
  reader(first);
  EXPECT_THAT([&] { reader.end(); }, ThrowsMessage<InputError>(HasSubstr("expected nothing behind the end, got 1 bytes")));
}

// A length that no bytes follow is refused before memory is taken for it.
TEST(ByteStream, RefusesListsLongerThanTheBytes) {
  const std::string bytes = bytesOf(std::uint64_t{1} << 60U);
  ByteReader reader(bytes, "the source");
  std::vector<double> list;
  EXPECT_THAT([&] { reader(list); },
              ThrowsMessage<InputError>(says("expected a list that fits in ..., got one of 1152921504606846976")));
}

TEST(Seal, OpensToWhatItHolds) {
  for (const std::string& payload : {std::string(), std::string("\0 any bytes \xff", 13)}) {
    const Unsealed opened = unsealed(SealKind::run, sealed(SealKind::run, payload), "source");
    EXPECT_EQ(opened.payload, payload);
    EXPECT_EQ(opened.commit, kGitCommit);
  }
}

TEST(Seal, RefusesWhatIsCutOrGoesOn) {
  const std::string bytes = sealed(SealKind::run, "payload");
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(unsealed(SealKind::run, bytes.substr(0, size), "source"), InputError) << size;
  EXPECT_THAT(
      [&] { unsealed(SealKind::run, bytes.substr(0, bytes.size() - 1), "the source"); },
      ThrowsMessage<InputError>(says("the source: expected ..., got " + std::to_string(bytes.size() - 1) + " bytes, cut off")));
  EXPECT_THAT([&] { unsealed(SealKind::run, bytes + "more", "source"); },
              ThrowsMessage<InputError>(HasSubstr("expected nothing behind the end, got 4 bytes")));
}

TEST(Seal, RefusesEveryChangedBit) {
  const std::string bytes = sealed(SealKind::run, "payload");
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      std::string changed = bytes;
      changed[at] = static_cast<char>(static_cast<unsigned char>(changed[at]) ^ (1U << bit));
      EXPECT_THROW(unsealed(SealKind::run, changed, "source"), InputError) << at;
    }
  }
}

TEST(Seal, RefusesOtherFilesByWhatTheyAre) {
  EXPECT_THAT([&] { unsealed(SealKind::run, sealed(SealKind::world, ""), "the source"); },
              ThrowsMessage<InputError>(says("the source: expected a saved run, ..., got a world's snapshot")));
  EXPECT_THAT([&] { unsealed(SealKind::run, "name = \"a scene\"\n", "the source"); },
              ThrowsMessage<InputError>(HasSubstr("got another kind of file")));
  EXPECT_THAT([&] { unsealed(SealKind::run, "springtower-r", "the source"); },
              ThrowsMessage<InputError>(HasSubstr("got a beginning that is cut off")));
  std::string newer = sealed(SealKind::run, "");
  newer[16] = 9;
  EXPECT_THAT([&] { unsealed(SealKind::run, newer, "the source"); },
              ThrowsMessage<InputError>(HasSubstr("expected format 4, got 9")));
}

// Of an endless file nothing is read but the beginning.
TEST(Seal, RefusesFilesThatAreNone) {
  const ScratchFolder scratch;
  EXPECT_THAT([&] { unsealedFile(SealKind::run, scratch.file("none"), "the source"); },
              ThrowsMessage<InputError>(
                  HasSubstr("the source: expected a file that springtower has written, got none that can be read")));
  EXPECT_THROW(unsealedFile(SealKind::run, scratch.path().string(), "source"), InputError);
  EXPECT_THROW(unsealedFile(SealKind::run, "/dev/zero", "source"), InputError);
  EXPECT_THAT([&] { unsealedFile(SealKind::run, "/dev/null", "the source"); },
              ThrowsMessage<InputError>(HasSubstr("got nothing")));
  std::ofstream(scratch.file("whole"), std::ios::binary) << sealed(SealKind::run, "payload");
  EXPECT_EQ(unsealedFile(SealKind::run, scratch.file("whole"), "source").payload, "payload");
}

// What begins as a saved run and never ends does not fill the memory.
TEST(Seal, ReadsAPipeWithinBounds) {
  const ScratchFolder scratch;
  const std::string path = scratch.file("pipe");
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  const auto handler = std::signal(SIGPIPE, SIG_IGN);
  std::thread endless([&path] {
    const int pipe = open(path.c_str(), O_WRONLY);
    const std::string run = sealed(SealKind::run, "payload");
    const std::string zeros(std::size_t{1} << 16U, '\0');
    for (ssize_t written = write(pipe, run.data(), run.size()); written >= 0;) written = write(pipe, zeros.data(), zeros.size());
    close(pipe);
  });
  EXPECT_THAT([&] { unsealedFile(SealKind::run, path, "the source"); },
              ThrowsMessage<InputError>(HasSubstr("the source: expected at most 256 MB, or a file, got more through a pipe")));
  endless.join();
  std::signal(SIGPIPE, handler);
}

}  // namespace
}  // namespace springtower
