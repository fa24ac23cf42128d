#pragma once

#include "core/state.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace springtower {

/// The poses of the last frames, for showing them again: a ring that is filled once and then written round.
class Poses {
 public:
  /// How many are kept: three seconds at 60 frames a second.
  static constexpr std::size_t kMost = 180;

  void add(const ParticleArray& position) {
    if (kept_.size() < kMost) {
      kept_.push_back(position);
      return;
    }
    kept_[next_] = position;
    next_ = (next_ + 1) % kMost;
  }
  void clear() {
    kept_.clear();
    next_ = 0;
  }
  [[nodiscard]] std::size_t count() const { return kept_.size(); }
  /// The i-th from the oldest. Precondition: i < count().
  [[nodiscard]] const ParticleArray& at(std::size_t i) const { return kept_[(next_ + i) % kept_.size()]; }

 private:
  std::vector<ParticleArray> kept_;
  std::size_t next_ = 0;  // the oldest, once all are there
};

}  // namespace springtower
