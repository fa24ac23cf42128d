#pragma once

#include "core/counters.h"

#include <chrono>

namespace springtower {

/// Times consecutive stages: each lap is added to a stage and starts the next; a skipped lap is added to none. One clock reading
/// a lap, so it is cheap enough for every substep.
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
