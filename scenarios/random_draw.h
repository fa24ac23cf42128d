#pragma once

#include "core/random.h"
#include "core/vector.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace springtower {

/// What a stream of draws is for.
enum class RandomStreamOf : std::uint8_t { scene, surroundings };

/// Draws of random scenes, each from the next numbers of one stream. Only arithmetic and square roots, which are the same
/// everywhere (core/random.h); scenes made from them also take sines and cosines.
class RandomDraw {
 public:
  /// Draws of one stream do not move those of another: what is added to scenes later has a stream of its own.
  explicit RandomDraw(std::uint64_t seed, RandomStreamOf of = RandomStreamOf::scene)
      : random_(seed, kStream + static_cast<std::uint64_t>(of)) {}

  /// Even in [least, most).
  double between(double least, double most) { return least + (most - least) * random_.uniform(); }

  /// Even in its logarithm in [least, most): each binary digit of the exponent is a square root, which is taken or not.
  /// Precondition: 0 < least <= most.
  double logBetween(double least, double most) {
    constexpr int kDigits = 24;
    double value = least;
    double root = most / least;
    for (int digit = 0; digit < kDigits; ++digit) {
      root = std::sqrt(root);
      if (chance(0.5)) value *= root;
    }
    return std::min(value, most);
  }

  /// A whole number from least to most, both included.
  int whole(int least, int most) { return std::min(most, least + static_cast<int>(random_.uniform() * (most - least + 1))); }

  bool chance(double probability) { return random_.uniform() < probability; }

  /// Which of some weights, by their share of the sum.
  std::size_t pick(std::initializer_list<double> weights) {
    double sum = 0.0;
    for (const double weight : weights) sum += weight;
    double left = sum * random_.uniform();
    std::size_t last = 0;
    for (const double weight : weights) {
      left -= weight;
      if (left < 0.0) return last;
      ++last;
    }
    return weights.size() - 1;
  }

  /// Even in the ball of a radius.
  Vec3 inBall(double radius) {
    for (;;) {
      const double x = between(-1.0, 1.0);
      const double y = between(-1.0, 1.0);
      const double z = between(-1.0, 1.0);
      if (x * x + y * y + z * z < 1.0) return {radius * x, radius * y, radius * z};
    }
  }

 private:
  static constexpr std::uint64_t kStream = 0x7a3e;  // of random scenes; towers of the same seed have streams 0 and 1
  RandomStream random_;
};

}  // namespace springtower
