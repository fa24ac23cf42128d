#pragma once

#include <chrono>
#include <cstdint>
#include <fstream>
#include <string>

namespace springtower {

/// Where a link leads that points to a file that is not there yet; any other path as it is. Throws
/// std::filesystem::filesystem_error where it cannot be read.
std::string withoutDanglingLinks(std::string path);

/// A file that is written while the program works and appears under its name only when it is complete. It is opened at once, so
/// that a name that cannot be written is known before any work is done. Until `commit` the content stands beside it in
/// NAME.partial, which the destructor removes unless it is kept: `keep`, or a disk that got full after a part had been flushed. A
/// device or pipe is written directly. What replaces a file in a folder that takes no new ones stands in the system's folder for
/// temporary files until then, and is copied: a process that is killed while it copies leaves part of it. Where there is no such
/// folder either, that file is written directly. A process that is killed leaves NAME.partial as it was last flushed, and the
/// next one that writes to NAME takes its place. Of two processes that write to NAME at the same time the second one writes
/// NAME.partial-PID, and NAME is in the end that of the one that finishes last. NAME.partial is locked (flock) while its process
/// lives: that is how the second one distinguishes it from what a killed process has left. A link is followed, whether there is a
/// file at its end yet or not.
class OutputFile {
 public:
  /// Opens `path`; `option` names the command line option it came from. Throws InputError naming both when it cannot be written.
  OutputFile(std::string path, std::string option);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  ~OutputFile();

  [[nodiscard]] std::ostream& stream() { return stream_; }

  /// Hands what was written to the system, so that it is kept whatever becomes of this process, unless that was done less than a
  /// second ago. Call it after every frame or line. Throws InputError naming the file when the disk is full, and the file that
  /// has what was flushed before.
  void flushEverySecond();

  /// Whether content can be taken back: not from a device or pipe.
  [[nodiscard]] bool canCut() const { return !partial_.empty(); }

  /// Takes back all but the first `bytes` bytes. Precondition: canCut(), and so many were written. Throws InputError when that
  /// fails.
  void cutTo(std::uintmax_t bytes);

  /// The file that is written until `commit`, for a program that takes its name as an argument: NAME.partial, a temporary file,
  /// or a device's own name.
  [[nodiscard]] const std::string& writtenPath() const { return partial_.empty() ? path_ : partial_; }

  /// Lets the destructor leave what was flushed where it is, for a program that ends by an error. Returns the name of that file;
  /// empty where nothing has been flushed, or the file is written directly.
  std::string keep();

  /// Writes what is left and gives the file its name. Throws InputError naming the file when the disk is full, or when it cannot
  /// get its name: what was written, or flushed before the disk was full, then stays where it is, which the message says.
  void commit();

 private:
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void failAsFull();
  bool openPartial(const std::string& name);
  bool openTemporary();
  bool copyTemporary() const;
  void unlock();

  std::string path_;
  std::string option_;
  std::string partial_;     // empty when written directly
  bool temporary_ = false;  // partial_ is in the folder for temporary files: copied, as it cannot be renamed
  bool isFlushed_ = false;  // whether a part of the content has been flushed
  bool isKept_ = false;     // whether the destructor leaves partial_
  int lock_ = -1;           // the partial file once more, to hold its lock
  std::ofstream stream_;
  std::chrono::steady_clock::time_point flushed_;
};

}  // namespace springtower
