#pragma once

#include <cstddef>
#include <fstream>
#include <iosfwd>
#include <string>

namespace springtower {

/// The longest line, in bytes, that a reader of the project's own formats keeps in memory: 1 MB, a thousand times what any of
/// them writes. Whatever has no line ends (a device, a picture) is so refused at once instead of filling the memory.
inline constexpr std::size_t kMaxLineBytes = std::size_t{1} << 20U;

/// Reads the next line of a stream without its end, as std::getline does. Returns false at the end of the stream and when reading
/// fails (stream.bad()). Throws InputError "where: expected at most 1 MB in a line, got more" for a longer one.
bool readLine(std::istream& stream, std::string& line, const std::string& where);

/// A text file, read line by line.
class LineInput {
 public:
  /// Opens a file. `option` begins the message where one names the file, else it is empty. Throws InputError naming the file when
  /// it is a folder or cannot be opened.
  explicit LineInput(const std::string& path, const std::string& option = {});

  /// The next line without its end; false at the end of the file. Throws InputError naming file and line when reading fails and
  /// for a line of more than kMaxLineBytes.
  bool next(std::string& line);

  /// Of the line that `next` has read last, from 1; 0 before.
  [[nodiscard]] std::size_t number() const { return number_; }
  /// Names the file and that line, for messages: "FILE, line 3".
  [[nodiscard]] std::string where() const;
  /// Whether that line ended with the file, without a line end: what is still being written ends so.
  [[nodiscard]] bool endedWithFile() const { return stream_.eof(); }

 private:
  std::string name_;  // for messages
  std::ifstream stream_;
  std::size_t number_ = 0;
};

}  // namespace springtower
