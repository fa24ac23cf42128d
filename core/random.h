#pragma once

#include <cstdint>

namespace springtower {

// Random numbers that are the same on every machine. The standard library fixes its engines but not its distributions, so both
// are ours: whole-number arithmetic, then only additions and comparisons of doubles. No logarithm, sine or square root is called,
// whose last bit differs between mathematical libraries.

/// The generator SplitMix64 (Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators"): a counter stepped by
/// the golden ratio and scrambled. Period 2^64.
class SplitMix64 {
 public:
  explicit constexpr SplitMix64(std::uint64_t seed) : state_(seed) {}

  /// The next 64 random bits.
  constexpr std::uint64_t operator()() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t bits = state_;
    bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
    bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
    return bits ^ (bits >> 31U);
  }

 private:
  std::uint64_t state_;
};

/// A stream of random numbers. Streams of one seed are independent of one another, so that one quantity can be varied without
/// changing another.
class RandomStream {
 public:
  constexpr RandomStream(std::uint64_t seed, std::uint64_t stream) : generator_(SplitMix64(SplitMix64(seed)() + stream)()) {}

  /// Uniform in [0, 1): a multiple of 2^-53, so that every step is exact.
  constexpr double uniform() { return static_cast<double>(generator_() >> 11U) * 0x1p-53; }

  /// Exponential with mean 1, by comparisons alone (von Neumann 1951, "Various techniques used in connection with random
  /// digits"): a descending run of uniforms that starts at u has an odd length with probability exp(-u).
  constexpr double exponential() {
    for (double whole = 0.0;; whole += 1.0) {
      const double first = uniform();
      double last = first;
      bool odd = true;
      for (double next = uniform(); next < last; next = uniform()) {
        last = next;
        odd = !odd;
      }
      if (odd) return whole + first;
    }
  }

  /// Normal with mean 0 and standard deviation 1: an exponential x is taken with probability exp(-(x - 1)^2 / 2), which leaves
  /// half a bell curve, and given a random sign.
  constexpr double normal() {
    for (;;) {
      const double size = exponential();
      if (2.0 * exponential() < (size - 1.0) * (size - 1.0)) continue;
      return (generator_() >> 63U) != 0U ? -size : size;
    }
  }

 private:
  SplitMix64 generator_;
};

}  // namespace springtower
