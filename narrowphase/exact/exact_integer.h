#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace springtower {

/// An integer of at most 64 * Capacity bits: sign and magnitude, least significant limb first, no allocation. Only the limbs in
/// use are ever read, copied or written, so small numbers in a large capacity are cheap.
///
/// A product has the sum of its factors' capacities, so it always fits. A sum keeps the larger capacity of its terms: the first
/// numbers of a computation must have enough free bits at the top for all later sums (products add up the free bits of their
/// factors).
template <std::size_t Capacity>
struct Integer {
  std::array<std::uint64_t, Capacity> limbs;
  std::uint32_t size = 0;  ///< limbs in use; the last one is not zero; 0 for the number 0
  bool negative = false;

  Integer() {
    // Not required, but free, and it avoids warnings of compilers that unroll short loops and report limbs that are never read.
    if constexpr (Capacity <= 4) limbs.fill(0);
  }
  Integer(std::int64_t value) : Integer() {
    const auto bits = static_cast<std::uint64_t>(value);
    size = value != 0;
    negative = value < 0;
    limbs[0] = negative ? 0 - bits : bits;
  }
  template <std::size_t Other>
  Integer(const Integer<Other>& other) : Integer() {
    assign(other);
  }
  Integer(const Integer& other) : Integer() { assign(other); }
  Integer& operator=(const Integer& other) {
    assign(other);
    return *this;
  }

  int sign() const { return size == 0 ? 0 : (negative ? -1 : 1); }

 private:
  template <std::size_t Other>
  void assign(const Integer<Other>& other) {
    assert(other.size <= Capacity);
    size = other.size;
    negative = other.negative;
    std::copy_n(other.limbs.begin(), size, limbs.begin());
  }
};

__extension__ typedef unsigned __int128 DoubleLimb;

/// -1, 0 or 1 if |a| is smaller than, equal to or larger than |b|.
template <std::size_t A, std::size_t B>
int compareMagnitudes(const Integer<A>& a, const Integer<B>& b) {
  if (a.size != b.size) return a.size < b.size ? -1 : 1;
  for (std::uint32_t i = a.size; i-- > 0;)
    if (a.limbs[i] != b.limbs[i]) return a.limbs[i] < b.limbs[i] ? -1 : 1;
  return 0;
}

/// |larger| + |smaller|, with the given sign, for larger.size >= smaller.size.
template <std::size_t Sum, std::size_t A, std::size_t B>
Integer<Sum> addMagnitudes(const Integer<A>& larger, const Integer<B>& smaller, bool negative) {
  Integer<Sum> sum;
  DoubleLimb carry = 0;
  for (std::uint32_t i = 0; i < larger.size; ++i) {
    carry += larger.limbs[i];
    if (i < smaller.size) carry += smaller.limbs[i];
    sum.limbs[i] = static_cast<std::uint64_t>(carry);
    carry >>= 64;
  }
  sum.size = larger.size;
  if (carry != 0) {
    assert(sum.size < Sum);
    sum.limbs[sum.size++] = static_cast<std::uint64_t>(carry);
  }
  sum.negative = negative;
  return sum;
}

/// |larger| - |smaller|, with the given sign, for |larger| > |smaller|.
template <std::size_t Difference, std::size_t A, std::size_t B>
Integer<Difference> subtractMagnitudes(const Integer<A>& larger, const Integer<B>& smaller, bool negative) {
  Integer<Difference> difference;
  std::uint64_t borrow = 0;
  for (std::uint32_t i = 0; i < larger.size; ++i) {
    const DoubleLimb taken = DoubleLimb{i < smaller.size ? smaller.limbs[i] : 0} + borrow;
    difference.limbs[i] = static_cast<std::uint64_t>(larger.limbs[i] - taken);
    borrow = larger.limbs[i] < taken;
  }
  difference.size = larger.size;
  while (difference.limbs[difference.size - 1] == 0) --difference.size;
  difference.negative = negative;
  return difference;
}

template <std::size_t A>
Integer<A> operator-(const Integer<A>& a) {
  Integer<A> result = a;
  result.negative = !a.negative;
  return result;
}

template <std::size_t A, std::size_t B>
Integer<std::max(A, B)> operator+(const Integer<A>& a, const Integer<B>& b) {
  constexpr std::size_t kSum = std::max(A, B);
  if (a.size == 0) return b;
  if (b.size == 0) return a;
  if (a.negative == b.negative)
    return a.size >= b.size ? addMagnitudes<kSum>(a, b, a.negative) : addMagnitudes<kSum>(b, a, a.negative);
  const int order = compareMagnitudes(a, b);
  if (order == 0) return {};
  return order > 0 ? subtractMagnitudes<kSum>(a, b, a.negative) : subtractMagnitudes<kSum>(b, a, b.negative);
}

template <std::size_t A, std::size_t B>
Integer<std::max(A, B)> operator-(const Integer<A>& a, const Integer<B>& b) {
  return a + (-b);
}

template <std::size_t A, std::size_t B>
Integer<A + B> operator*(const Integer<A>& a, const Integer<B>& b) {
  Integer<A + B> product;
  if (a.size == 0 || b.size == 0) return product;
  product.size = a.size + b.size;
  std::fill_n(product.limbs.begin(), product.size, 0);
  for (std::uint32_t i = 0; i < a.size; ++i) {
    DoubleLimb carry = 0;
    for (std::uint32_t j = 0; j < b.size; ++j) {
      carry += DoubleLimb{a.limbs[i]} * b.limbs[j] + product.limbs[i + j];
      product.limbs[i + j] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    product.limbs[i + b.size] = static_cast<std::uint64_t>(carry);
  }
  if (product.limbs[product.size - 1] == 0) --product.size;
  product.negative = a.negative != b.negative;
  return product;
}

/// a * 2^bits, in a number of the given capacity.
template <std::size_t Result, std::size_t A>
Integer<Result> shiftedLeft(const Integer<A>& a, std::uint32_t bits) {
  Integer<Result> result;
  if (a.size == 0) return result;
  const std::uint32_t limbs = bits / 64;
  const std::uint32_t rest = bits % 64;
  assert(a.size + limbs <= Result);
  std::fill_n(result.limbs.begin(), limbs, 0);
  std::uint64_t carry = 0;
  for (std::uint32_t i = 0; i < a.size; ++i) {
    result.limbs[i + limbs] = (a.limbs[i] << rest) | carry;
    carry = rest == 0 ? 0 : a.limbs[i] >> (64 - rest);
  }
  result.size = a.size + limbs;
  if (carry != 0) {
    assert(result.size < Result);
    result.limbs[result.size++] = carry;
  }
  result.negative = a.negative;
  return result;
}

/// a / 2, rounded towards zero.
template <std::size_t A>
Integer<A> halved(const Integer<A>& a) {
  Integer<A> result;
  for (std::uint32_t i = 0; i < a.size; ++i) result.limbs[i] = (a.limbs[i] >> 1) | (i + 1 < a.size ? a.limbs[i + 1] << 63 : 0);
  result.size = a.size;
  if (result.size != 0 && result.limbs[result.size - 1] == 0) --result.size;
  result.negative = a.negative;
  return result;
}

/// The number of bits of |a|: 0 for 0, otherwise 2^(bits-1) <= |a| < 2^bits.
template <std::size_t A>
std::uint32_t bitLength(const Integer<A>& a) {
  return a.size == 0 ? 0 : 64 * a.size - static_cast<std::uint32_t>(std::countl_zero(a.limbs[a.size - 1]));
}

/// The largest double not above |a| / 2^exponent, for a value that is no smaller than 2^-1022 or that a double holds exactly.
template <std::size_t A>
double magnitudeRoundedDown(const Integer<A>& a, std::uint32_t exponent) {
  constexpr std::uint32_t kDigits = 53;
  const std::uint32_t bits = bitLength(a);
  const std::uint32_t dropped = bits > kDigits ? bits - kDigits : 0;
  std::uint64_t digits = 0;
  for (std::uint32_t i = dropped / 64; i < a.size; ++i) {
    const std::uint32_t position = 64 * i;  // of the limb's lowest bit
    digits |= position >= dropped ? a.limbs[i] << (position - dropped) : a.limbs[i] >> (dropped - position);
  }
  return std::ldexp(static_cast<double>(digits), static_cast<int>(dropped) - static_cast<int>(exponent));
}

}  // namespace springtower
