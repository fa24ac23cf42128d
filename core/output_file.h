#pragma once

#include <fstream>
#include <string>

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

}  // namespace springtower
