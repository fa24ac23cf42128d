#pragma once

#include "core/scene/scene.h"
#include "solver/world/simulation.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

/// What libFuzzer, or the player of a kept corpus, calls with one input: any bytes. Every target defines it once. Returns 0.
/// What must not be aborts (springtower::requireThat).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace springtower {

/// Prints `what` and aborts unless it holds: to libFuzzer an input for which something does not hold is as bad as a crash.
void requireThat(bool holds, std::string_view what);

/// Aborts unless a complaint about bad input is what InputError promises: not empty, of one line, and naming the file where one
/// is given.
void requireMessage(std::string_view message, std::string_view file = {});

/// Steps a new scene by so many frames, with energy and contact forces after each, and aborts where anything is not finite. That
/// it diverges (DivergenceError) or is refused (InputError) is allowed, and what would take too long is left out: more than
/// kMostBlocks blocks or kMostSubsteps steps a frame.
void stepFrames(const Scene& scene, int frames);
inline constexpr std::size_t kMostBlocks = 24;
inline constexpr int kMostSubsteps = 2000;

/// Aborts unless all positions and velocities are finite.
void requireFinite(const Simulation& simulation);

/// An input as a file that is nowhere on the disk, for readers that take a path.
class InputFile {
 public:
  /// Throws std::runtime_error where there is no memory for it.
  explicit InputFile(std::string_view content);
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile();
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  int file_ = -1;
  std::string path_;
};

/// An input as a text.
inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// An input as a row of values; zeros follow its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  /// The next bytes as a whole number or as the bits of a double.
  template <class T>
  T next() {
    static_assert(std::is_arithmetic_v<T>);
    T value{};
    const std::size_t count = std::min(sizeof(T), rest_.size());
    std::memcpy(&value, rest_.data(), count);
    rest_ = rest_.subspan(count);
    return value;
  }
  /// A whole number, 0 to `end` - 1, of one byte. Precondition: 1 <= end <= 256.
  int below(int end) { return next<std::uint8_t>() % end; }
  /// A number from `least` up to `most`, of two bytes: one of 65536.
  double between(double least, double most) { return least + (most - least) * next<std::uint16_t>() / 65535.0; }
  [[nodiscard]] bool empty() const { return rest_.empty(); }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace springtower
