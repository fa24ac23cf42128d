#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace springtower {

/// A 64-bit hash that values are mixed into one after the other (FNV-1a; Fowler, Noll and Vo 1991). Two different states have
/// the same hash by chance once in 2^64; it is not cryptographic.
class Hash {
 public:
  /// Mixes in a whole word at once. Quicker than byte by byte, and another hash.
  constexpr void word(std::uint64_t value) { value_ = (value_ ^ value) * 1099511628211ULL; }
  /// Mixes in the bytes of an object that has no padding.
  void bytes(const void* data, std::size_t size) {
    for (const unsigned char byte : std::span(static_cast<const unsigned char*>(data), size)) word(byte);
  }
  [[nodiscard]] constexpr std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 1469598103934665603ULL;
};

}  // namespace springtower
