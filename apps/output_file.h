#pragma once

#include <fstream>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace springtower {

/// A file that is written while the program works and appears under its name only when it is complete. It is opened at once, so
/// that a name that cannot be written is known before any work is done. Until `commit` the content stands in a partial file
/// beside it, which the destructor removes; a device or pipe is written directly.
class OutputFile {
 public:
  /// Opens `path`; `option` names the command line option it came from. Throws InputError naming both when it cannot be written.
  OutputFile(std::string path, std::string option);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  [[nodiscard]] std::ostream& stream() { return stream_; }

  /// Writes what is left and gives the file its name. Throws InputError naming the file when the disk is full or the name is
  /// gone.
  void commit();

 private:
  [[noreturn]] void fail(const std::string& what) const;

  std::string path_;
  std::string option_;
  std::string partial_;  // empty when written directly
  std::ofstream stream_;
};

/// Makes the folder that option `--out` names, with those above it. Throws InputError where that cannot be.
void makeOutputFolder(const std::string& folder);

/// Writes a whole file of that folder. Throws InputError as OutputFile does.
void writeOutputFile(const std::string& folder, const std::string& name, const std::function<void(std::ostream&)>& write);

/// A text as a field of a CSV file (RFC 4180).
std::string csvText(std::string_view text);

}  // namespace springtower
