#include "core/output_file.h"

#include "core/error.h"
#include "tests/support/program.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <optional>
#include <sys/resource.h>
#include <thread>

namespace springtower {
namespace {

std::ptrdiff_t filesIn(const ScratchFolder& folder) {
  return std::distance(std::filesystem::directory_iterator(folder.path()), {});
}

TEST(OutputFile, HasItsNameWhenItIsWhole) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("a")) << "old";
  {
    OutputFile file(scratch.file("a"), "--out");
    file.stream() << "new";
    EXPECT_EQ(contentOf(scratch.file("a")), "old");
    EXPECT_TRUE(std::filesystem::exists(scratch.file("a.partial")));
    file.commit();
    EXPECT_EQ(contentOf(scratch.file("a")), "new");
  }
  { OutputFile(scratch.file("a"), "--out").stream() << "never committed"; }
  EXPECT_EQ(contentOf(scratch.file("a")), "new");
  EXPECT_EQ(filesIn(scratch), 1);
}

// A link stays one, whether what it leads to is there yet or not.
TEST(OutputFile, FollowsLinks) {
  const ScratchFolder scratch;
  std::filesystem::create_directory(scratch.file("folder"));
  std::ofstream(scratch.file("folder/old")) << "old";
  std::filesystem::create_symlink("folder/old", scratch.file("to-old"));
  std::filesystem::create_symlink("folder/new", scratch.file("to-new"));
  std::filesystem::create_symlink(scratch.file("to-new"), scratch.file("to-link"));
  std::filesystem::create_symlink("nowhere/new", scratch.file("to-nowhere"));
  std::filesystem::create_symlink("loop", scratch.file("loop"));
  for (const char* name : {"to-old", "to-link"}) {
    OutputFile file(scratch.file(name), "--out");
    file.stream() << "new";
    file.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(scratch.file(name))) << name;
    EXPECT_EQ(contentOf(scratch.file(name)), "new") << name;
  }
  EXPECT_TRUE(std::filesystem::is_symlink(scratch.file("to-new")));
  EXPECT_EQ(contentOf(scratch.file("folder/new")), "new");
  EXPECT_THROW(OutputFile(scratch.file("to-nowhere"), "--out"), InputError);
  EXPECT_THROW(OutputFile(scratch.file("loop"), "--out"), InputError);
  EXPECT_EQ(filesIn(scratch), 6) << "nothing is left behind";
}

TEST(OutputFile, IsFlushedAfterASecond) {
  const ScratchFolder scratch;
  OutputFile file(scratch.file("a"), "--out");
  file.stream() << "a line\n";
  file.flushEverySecond();
  EXPECT_EQ(contentOf(scratch.file("a.partial")), "") << "not at every call";
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  file.flushEverySecond();
  EXPECT_EQ(contentOf(scratch.file("a.partial")), "a line\n");
}

// Each has a file of its own, whole in the end, and the last one that finishes has the name.
TEST(OutputFile, IsWrittenByTwoAtOnce) {
  const ScratchFolder scratch;
  std::optional<OutputFile> first(std::in_place, scratch.file("a"), "--out");
  std::optional<OutputFile> second(std::in_place, scratch.file("a"), "--out");
  EXPECT_NE(first->writtenPath(), second->writtenPath());
  first->stream() << "the first one's";
  second->stream() << "the second one's";
  second->commit();
  EXPECT_EQ(contentOf(scratch.file("a")), "the second one's");
  second.reset();
  first->commit();
  first.reset();
  EXPECT_EQ(contentOf(scratch.file("a")), "the first one's");
  EXPECT_EQ(filesIn(scratch), 1);
}

TEST(OutputFile, TakesThePlaceOfWhatAKilledProcessLeft) {
  const ScratchFolder scratch;
  std::ofstream(scratch.file("a.partial")) << "what was longer than what comes";
  OutputFile file(scratch.file("a"), "--out");
  EXPECT_EQ(file.writtenPath(), scratch.file("a.partial"));
  file.stream() << "new";
  file.commit();
  EXPECT_EQ(contentOf(scratch.file("a")), "new");
  EXPECT_EQ(filesIn(scratch), 1);
}

// A folder took its name meanwhile.
TEST(OutputFile, StaysWhereItCannotGetItsName) {
  const ScratchFolder scratch;
  {
    OutputFile file(scratch.file("a"), "--out");
    file.stream() << "hours of work";
    std::filesystem::create_directory(scratch.file("a"));
    try {
      file.commit();
      ADD_FAILURE() << "it was given the name of a folder";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr("what was written is in '" + scratch.file("a.partial") + "'"));
    }
  }
  EXPECT_EQ(contentOf(scratch.file("a.partial")), "hours of work");
}

// Names of more than 255 bytes are none: NAME.partial cannot be made, as in a folder that takes no new files.
TEST(OutputFile, KeepsTheOldFileWhereNoNewOneCanBeMadeBesideIt) {
  const ScratchFolder scratch;
  const std::string name = scratch.file(std::string(250, 'a'));
  EXPECT_THROW(OutputFile(name, "--out"), InputError) << "there is none to replace";
  std::ofstream(name) << "old";
  {
    OutputFile file(name, "--out");
    file.stream() << "never committed" << std::flush;
    EXPECT_TRUE(std::filesystem::exists(file.writtenPath()));
  }
  EXPECT_EQ(contentOf(name), "old");
  for (const std::string& text : {std::string("newer than old"), std::string("new"), std::string()}) {
    OutputFile file(name, "--out");
    file.stream() << text;
    const std::string written = file.writtenPath();
    file.commit();
    EXPECT_EQ(contentOf(name), text);
    EXPECT_FALSE(std::filesystem::exists(written));
  }
  std::ofstream(name) << "old";
  OutputFile lost(name, "--out");
  lost.stream() << "new";
  std::filesystem::remove(lost.writtenPath());
  EXPECT_THROW(lost.commit(), InputError) << "somebody has cleared the folder for temporary files";
  EXPECT_EQ(contentOf(name), "old");
  EXPECT_EQ(filesIn(scratch), 1);
}

TEST(OutputFile, CanBeCut) {
  const ScratchFolder scratch;
  OutputFile file(scratch.file("a"), "--out");
  file.stream() << "one two three";
  ASSERT_TRUE(file.canCut());
  file.cutTo(4);
  EXPECT_EQ(contentOf(scratch.file("a.partial")), "one ");
  file.stream() << "more";
  file.commit();
  EXPECT_EQ(contentOf(scratch.file("a")), "one more");
}

TEST(OutputFile, SaysSoonThatTheDiskIsFull) {
  OutputFile file("/dev/full", "--out");
  EXPECT_FALSE(file.canCut());
  std::this_thread::sleep_for(std::chrono::milliseconds(1050));
  file.stream() << "a line";
  EXPECT_THROW(file.flushEverySecond(), InputError);
}

// A limit on the size of files in this process, as a disk that is full; the usual one again in the end.
class SizeLimit {
 public:
  explicit SizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &usual_);
    const rlimit limit{std::min(bytes, usual_.rlim_max), usual_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;
  ~SizeLimit() {
    setrlimit(RLIMIT_FSIZE, &usual_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit usual_{};
  void (*handler_)(int);
};

template <class Action>
std::string complaintOf(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(OutputFile, KeepsWhatWasFlushedBeforeTheDiskWasFull) {
  const ScratchFolder scratch;
  std::string cut;
  std::string first;
  std::string again;
  std::string unflushed;
  {
    OutputFile file(scratch.file("a"), "--out");
    OutputFile other(scratch.file("b"), "--out");
    OutputFile cutFile(scratch.file("c"), "--out");
    std::this_thread::sleep_for(std::chrono::milliseconds(1050));
    for (OutputFile* of : {&file, &cutFile}) {
      of->stream() << "a line\n";
      of->flushEverySecond();
    }
    const SizeLimit limit(10);
    for (OutputFile* of : {&file, &other, &cutFile}) of->stream() << "another line\n";
    cut = complaintOf([&] { cutFile.cutTo(3); });
    first = complaintOf([&] { file.commit(); });
    again = complaintOf([&] { file.commit(); });
    unflushed = complaintOf([&] { other.commit(); });
  }
  EXPECT_THAT(cut, testing::HasSubstr("is in '" + scratch.file("c.partial") + "'"));
  EXPECT_THAT(first, testing::HasSubstr("is in '" + scratch.file("a.partial") + "'"));
  EXPECT_EQ(again, first);
  EXPECT_THAT(unflushed, testing::EndsWith("is the disk full?"));
  EXPECT_EQ(contentOf(scratch.file("a.partial")).substr(0, 7), "a line\n");
  EXPECT_EQ(contentOf(scratch.file("c.partial")).substr(0, 7), "a line\n");
  EXPECT_EQ(filesIn(scratch), 2) << "of the other nothing is left";
}

TEST(OutputFile, IsKeptWhereAProgramSaysSo) {
  const ScratchFolder scratch;
  {
    OutputFile file(scratch.file("a"), "--out");
    file.stream() << "a line\n";
    EXPECT_EQ(file.keep(), "") << "nothing has been flushed";
    std::this_thread::sleep_for(std::chrono::milliseconds(1050));
    file.flushEverySecond();
    EXPECT_EQ(file.keep(), scratch.file("a.partial"));
  }
  EXPECT_EQ(contentOf(scratch.file("a.partial")), "a line\n");
}

}  // namespace
}  // namespace springtower
