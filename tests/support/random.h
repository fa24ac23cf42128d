#pragma once

#include "core/random.h"

#include <cstdint>

namespace springtower {

/// Random numbers for tests, the same from the same seed on every machine.
struct Random {
  SplitMix64 generator;

  /// A whole number from 0 up to, not including, `end`.
  std::int32_t below(std::int32_t end) { return static_cast<std::int32_t>(generator() % static_cast<std::uint64_t>(end)); }
  /// A number from `least` up to `most`.
  double between(double least, double most) { return least + (most - least) * static_cast<double>(generator() >> 11U) * 0x1p-53; }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }
};

}  // namespace springtower
