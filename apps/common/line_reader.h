#pragma once

#include "core/error.h"

#include <cstddef>
#include <functional>
#include <string>

namespace springtower {

/// A line of more than kMaxLineBytes. The next line can be read.
struct LongLineError : InputError {
  using InputError::InputError;
};

/// Reads a file or standard input line by line, as its lines come: of a pipe the first lines can be had before the last are
/// written. For one thread at a time.
class LineReader {
 public:
  /// `path` - is standard input. Throws InputError for what cannot be read.
  explicit LineReader(const std::string& path);
  LineReader(const LineReader&) = delete;
  LineReader& operator=(const LineReader&) = delete;
  ~LineReader();

  /// How messages name the input: the path, or "standard input".
  [[nodiscard]] const std::string& source() const { return source_; }

  /// The next line without its end. Returns false at the end of the input, and when a signal has come (interruption.h) or `stop`
  /// has become true while it waited for more. Throws InputError when reading fails, and LongLineError for a line of more than
  /// kMaxLineBytes, which the next call leaves out; where it does not end within 64 MB, that call throws InputError.
  bool next(std::string& line, const std::function<bool()>& stop);

 private:
  bool fill(const std::function<bool()>& stop);
  bool skip(const std::function<bool()>& stop);
  [[noreturn]] void refuse();  // a line that is too long

  std::string source_;
  int file_ = -1;
  std::string buffer_;
  std::size_t begin_ = 0;  // of what is not handed out yet
  std::size_t number_ = 0;
  bool ended_ = false;
  bool refused_ = false;  // the line of number_ is too long, and not read to its end
};

}  // namespace springtower
