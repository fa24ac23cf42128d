#include "core/output_file.h"

#include "core/error.h"
#include "core/limits.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace springtower {
namespace {

constexpr std::chrono::seconds kFlushEvery{1};

// Opens a file for its lock, which only one process holds; -1 where another one does, or the file cannot be opened or locked
// (errno says why). Its content stays as it is; an empty file that cannot be locked at all, as on some network drives, is
// removed: nobody would write it or take it away.
int lockedFile(const std::string& name) {
  while (true) {
    const int file = open(name.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (file < 0) return -1;
    struct stat opened {};
    struct stat named {};
    const bool isRegular = fstat(file, &opened) == 0 && S_ISREG(opened.st_mode);
    if (!isRegular || flock(file, LOCK_EX | LOCK_NB) != 0) {
      const int why = errno;
      if (isRegular && why != EWOULDBLOCK && opened.st_size == 0) unlink(name.c_str());
      close(file);
      errno = why;
      return -1;
    }
    // Between opening and locking the process that held it may have given the file its final name.
    if (stat(name.c_str(), &named) == 0 && named.st_ino == opened.st_ino && named.st_dev == opened.st_dev) return file;
    close(file);
  }
}

}  // namespace

std::string withoutDanglingLinks(std::string path) {
  namespace fs = std::filesystem;
  constexpr int kMostLinks = 40;  // as Linux follows
  for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(path)) && !fs::exists(path); ++i) {
    path = (fs::path(path).parent_path() / fs::read_symlink(path)).string();
  }
  return path;
}

OutputFile::OutputFile(std::string path, std::string option) : path_(std::move(path)), option_(std::move(option)) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (path_.empty()) fail("an empty name");
  if (status.type() == fs::file_type::none) fail(error.message());  // links that lead round in a circle, for one
  if (fs::is_directory(status)) fail("it is a folder");
  if (fs::exists(status)) {
    if (access(path_.c_str(), W_OK) != 0) fail(std::strerror(errno));
    // A link stays a link: what it points to is replaced.
    if (fs::is_regular_file(status)) path_ = fs::canonical(path_, error).string();
  } else if (status.type() == fs::file_type::not_found) {
    path_ = withoutDanglingLinks(std::move(path_));
  }
  flushed_ = std::chrono::steady_clock::now();
  if (!fs::exists(status) || fs::is_regular_file(status)) {
    const std::string partial = path_ + ".partial";
    lock_ = lockedFile(partial);
    if (lock_ >= 0 && openPartial(partial)) return;
    const int why = errno;
    unlock();
    if (openPartial(fmt::format("{}-{}", partial, getpid()))) return;
    // The folder takes no new files, but one that is there may be written: it keeps its content until the new one is whole.
    if (fs::exists(status) && openTemporary()) return;
    if (!fs::exists(status)) fail(std::strerror(why));
  }
  stream_.open(path_, std::ios::binary);
  if (!stream_.is_open()) fail(std::strerror(errno));
}

OutputFile::~OutputFile() {
  stream_.close();
  if (!partial_.empty() && !isKept_) std::remove(partial_.c_str());
  unlock();
}

bool OutputFile::openPartial(const std::string& name) {
  stream_.open(name, std::ios::binary | std::ios::trunc);
  if (!stream_.is_open()) return false;
  partial_ = name;
  return true;
}

bool OutputFile::openTemporary() {
  std::error_code error;
  std::string name = (std::filesystem::temp_directory_path(error) / "springtower-XXXXXX").string();
  if (error) return false;
  const int file = mkstemp(name.data());
  if (file < 0) return false;
  close(file);
  temporary_ = openPartial(name);
  if (!temporary_) std::remove(name.c_str());
  return temporary_;
}

// Of two processes that copy at the same time the second one waits: the file is one's or the other's.
bool OutputFile::copyTemporary() const {
  std::ifstream from(partial_, std::ios::binary);
  if (!from.is_open()) return false;
  const int lock = open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  if (lock < 0) return false;
  bool good = flock(lock, LOCK_EX) == 0;
  if (good) {
    std::ofstream to(path_, std::ios::binary | std::ios::trunc);
    if (from.peek() != std::ifstream::traits_type::eof()) to << from.rdbuf();
    to.close();
    good = !to.fail() && !from.bad();
  }
  const int why = errno;
  close(lock);
  errno = why;
  return good;
}

void OutputFile::unlock() {
  if (lock_ >= 0) close(lock_);
  lock_ = -1;
}

void OutputFile::flushEverySecond() {
  const auto now = std::chrono::steady_clock::now();
  if (now - flushed_ < kFlushEvery) return;
  flushed_ = now;
  if (!stream_.flush()) failAsFull();
  isFlushed_ = isFlushed_ || stream_.tellp() > 0;
}

void OutputFile::cutTo(std::uintmax_t bytes) {
  std::error_code error;
  if (!stream_.flush()) failAsFull();
  std::filesystem::resize_file(partial_, bytes, error);
  if (error || !stream_.seekp(static_cast<std::streamoff>(bytes))) failAsFull();
}

std::string OutputFile::keep() {
  if (!isFlushed_ || partial_.empty()) return {};
  isKept_ = true;
  return partial_;
}

void OutputFile::commit() {
  stream_.close();
  if (stream_.fail()) failAsFull();
  if (partial_.empty()) return;
  if (temporary_ ? copyTemporary() : std::rename(partial_.c_str(), path_.c_str()) == 0) {
    if (temporary_) std::remove(partial_.c_str());
    partial_.clear();
    unlock();
    return;
  }
  const std::string why = std::strerror(errno);
  isKept_ = true;  // the only whole copy
  std::error_code error;
  if (!std::filesystem::exists(partial_, error)) fail(why);
  fail(fmt::format("{}; what was written is in {}", why, inQuotes(partial_)));
}

// What was flushed before is all that there is of an hour's recording; its last line perhaps in part.
void OutputFile::failAsFull() {
  const std::string full = "writing failed; is the disk full?";
  const std::string kept = keep();
  fail(kept.empty() ? full : fmt::format("{} What was written until then is in {}", full, inQuotes(kept)));
}

void OutputFile::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: expected a file that can be written, got {}: {}", option_, inQuotes(path_), what));
}

}  // namespace springtower
