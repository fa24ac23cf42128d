#include "apps/common/line_reader.h"

#include "apps/common/interruption.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/line_input.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

namespace springtower {
namespace {

constexpr int kLookUp_ms = 100;  // the signal may have come to another thread, which does not interrupt poll here
constexpr std::size_t kChunk = 1U << 16U;
// Of a line that is left out: more has no line ends, such as a device.
constexpr std::size_t kMaxSkippedBytes = std::size_t{64} << 20U;

}  // namespace

LineReader::LineReader(const std::string& path) : source_(path == "-" ? "standard input" : onOneLine(path)) {
  // A named pipe that nobody writes yet is opened all the same and waited for in `fill`, where a signal is seen: poll finds its
  // end only once somebody has written it.
  file_ = path == "-" ? fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0) : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file_ < 0) throw InputError(fmt::format("{}: expected a file that can be read, got one that cannot", source_));
}

LineReader::~LineReader() {
  close(file_);
}

bool LineReader::next(std::string& line, const std::function<bool()>& stop) {
  if (refused_ && !skip(stop)) return false;
  ++number_;
  std::size_t searched = begin_;
  std::size_t end = buffer_.find('\n', searched);
  while (end == std::string::npos) {
    if (buffer_.size() - begin_ > kMaxLineBytes) refuse();
    buffer_.erase(0, begin_);
    begin_ = 0;
    searched = buffer_.size();
    if (!fill(stop)) break;
    end = buffer_.find('\n', searched);
  }
  if (!ended_ && end == std::string::npos) return false;  // interrupted or stopped
  if (end == std::string::npos && begin_ == buffer_.size()) return false;
  line = buffer_.substr(begin_, end - begin_);
  if (line.size() > kMaxLineBytes) refuse();
  begin_ = end == std::string::npos ? buffer_.size() : end + 1;
  return true;
}

// Leaves out what is left of a line that is too long. Returns false where the input ends with it, and as `fill`.
bool LineReader::skip(const std::function<bool()>& stop) {
  std::size_t skipped = 0;
  for (std::size_t end = buffer_.find('\n', begin_); end == std::string::npos; end = buffer_.find('\n')) {
    skipped += buffer_.size() - begin_;
    buffer_.clear();
    begin_ = 0;
    if (skipped > kMaxSkippedBytes)
      throw InputError(
          fmt::format("{}: line {}: expected its end within {} MB, got none", source_, number_, kMaxSkippedBytes >> 20U));
    if (!fill(stop)) return false;
  }
  begin_ = buffer_.find('\n', begin_) + 1;
  refused_ = false;
  return true;
}

void LineReader::refuse() {
  refused_ = true;
  throw LongLineError(
      fmt::format("{}: line {}: expected at most {} MB in a line, got more", source_, number_, kMaxLineBytes >> 20U));
}

// Appends what there is. Returns false at the end of the input, when a signal has come, and when `stop` says so.
bool LineReader::fill(const std::function<bool()>& stop) {
  while (!ended_) {
    if (interrupted() || stop()) return false;
    pollfd waiting{file_, POLLIN, 0};
    const int ready = poll(&waiting, 1, kLookUp_ms);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;  // to read now would be to wait
    const std::size_t before = buffer_.size();
    buffer_.resize(before + kChunk);
    const ssize_t count = read(file_, buffer_.data() + before, kChunk);
    buffer_.resize(before + static_cast<std::size_t>(count > 0 ? count : 0));
    if (count > 0) return true;
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0)
      throw InputError(
          fmt::format("{}: expected a file that can be read, got one that cannot: {}", source_, std::strerror(errno)));
    ended_ = true;
  }
  return false;
}

}  // namespace springtower
