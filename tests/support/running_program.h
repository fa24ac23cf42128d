#pragma once

#include "tests/support/program.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// Where a program's standard streams go: a file or device, nothing for a scratch file, or kClosed.
struct Streams {
  std::string input = {};
  std::string output = {};
  std::string error = {};
};
inline constexpr std::string_view kClosed = "closed";

/// A program of this build that runs beside the test, which may send it signals. Signals are as a shell in the foreground leaves
/// them. What still runs in the end is killed.
class RunningProgram {
 public:
  /// Throws std::runtime_error when it cannot be started.
  RunningProgram(std::string_view name, const std::vector<std::string>& arguments, const Streams& streams = {});
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  ~RunningProgram();

  /// Waits until something is true. Throws std::runtime_error when the program has ended before, or after a minute.
  void waitUntil(const std::function<bool()>& isTrue);
  /// Waits until a file has so many bytes.
  void waitForFile(const std::string& path, std::size_t bytes = 1);

  void send(int signal) const;
  [[nodiscard]] bool isRunning();
  /// What it has printed so far.
  [[nodiscard]] std::string output() const { return contentOf(output_); }
  /// Waits for its end. Throws std::runtime_error when it has none within a minute.
  ProgramResult wait();

 private:
  ScratchFolder scratch_;
  std::string output_;
  std::string error_;
  int process_ = -1;
  int status_ = 0;
};

}  // namespace springtower
