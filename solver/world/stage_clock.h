#pragma once

#include "core/counters.h"

#include <chrono>

namespace springtower {

/// Times stages that follow one another: each lap goes to a stage and starts the next; what is skipped goes to none. One reading
/// of the clock a lap, so that it can be used in every substep.
class StageClock {
 public:
  explicit StageClock(StageTimes& times) : times_(times), last_(std::chrono::steady_clock::now()) {}
  void lap(Stage stage) {
    const auto now = std::chrono::steady_clock::now();
    times_.seconds[static_cast<std::size_t>(stage)] += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }
  void skip() { last_ = std::chrono::steady_clock::now(); }

 private:
  StageTimes& times_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace springtower
