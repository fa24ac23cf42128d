#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace springtower {

/// A bar that shows how far a long job is, rewritten in place on standard error; silent unless that is a terminal and the job
/// takes more than two seconds. For one thread at a time.
class Progress {
 public:
  /// `unit` follows "[####      ] DONE of TOTAL "; with a total of 0, one that is not known, "DONE ".
  Progress(double total, std::string unit);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() { clear(); }

  /// Says how much is done, and perhaps at what; cheap enough to call every frame.
  void update(double done, std::string_view at = {});
  /// Removes the line.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  double total_;
  std::string unit_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point next_;
};

}  // namespace springtower
