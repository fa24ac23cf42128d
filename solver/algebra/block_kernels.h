#pragma once

#include "core/lanes.h"
#include "core/vector.h"
#include "solver/algebra/block_size.h"

#include <cstddef>
#include <cstdint>

// Operations on 12 x 12 blocks of floats, row by row, for kernels that are built for several instruction sets.

namespace springtower {

using Quad = float __attribute__((vector_size(16)));
using Octet = float __attribute__((vector_size(32)));

/// One row of a block: twelve floats.
struct BlockRow {
  Octet low;
  Quad high;
};

SPRINGTOWER_INLINE void loadRow(const float* from, BlockRow& to) {
  __builtin_memcpy(&to.low, from, sizeof to.low);
  __builtin_memcpy(&to.high, from + 8, sizeof to.high);
}
SPRINGTOWER_INLINE void storeRow(const BlockRow& from, float* to) {
  __builtin_memcpy(to, &from.low, sizeof from.low);
  __builtin_memcpy(to + 8, &from.high, sizeof from.high);
}
SPRINGTOWER_INLINE void subtractRow(float factor, const BlockRow& row, BlockRow& from) {
  from.low -= factor * row.low;
  from.high -= factor * row.high;
}
SPRINGTOWER_INLINE void addRow(float factor, const BlockRow& row, BlockRow& to) {
  to.low += factor * row.low;
  to.high += factor * row.high;
}

/// Four rows processed together: enough for their sums to hide one another's latency, and few enough for the registers.
struct FourRows {
  BlockRow a, b, c, d;
};

SPRINGTOWER_INLINE void loadRows(const float* from, FourRows& to) {
  loadRow(from, to.a);
  loadRow(from + kNodeSize, to.b);
  loadRow(from + 2 * kNodeSize, to.c);
  loadRow(from + 3 * kNodeSize, to.d);
}
SPRINGTOWER_INLINE void storeRows(const FourRows& from, float* to) {
  storeRow(from.a, to);
  storeRow(from.b, to + kNodeSize);
  storeRow(from.c, to + 2 * kNodeSize);
  storeRow(from.d, to + 3 * kNodeSize);
}

/// c -= w t, all 12 x 12 row by row.
SPRINGTOWER_INLINE void subtractBlockProduct(const float* w, const float* t, float* c) {
  for (std::size_t i = 0; i < kNodeMatrix; i += 4 * kNodeSize) {
    FourRows sum;
    loadRows(c + i, sum);
    for (std::size_t k = 0; k < kNodeSize; ++k) {
      BlockRow row;
      loadRow(t + kNodeSize * k, row);
      subtractRow(w[i + k], row, sum.a);
      subtractRow(w[i + kNodeSize + k], row, sum.b);
      subtractRow(w[i + 2 * kNodeSize + k], row, sum.c);
      subtractRow(w[i + 3 * kNodeSize + k], row, sum.d);
    }
    storeRows(sum, c + i);
  }
}

/// c = s t for symmetric s.
SPRINGTOWER_INLINE void blockProduct(const float* s, const float* t, float* c) {
  for (std::size_t i = 0; i < kNodeMatrix; i += 4 * kNodeSize) {
    FourRows sum{};
    for (std::size_t k = 0; k < kNodeSize; ++k) {
      BlockRow row;
      loadRow(t + kNodeSize * k, row);
      addRow(s[i + k], row, sum.a);
      addRow(s[i + kNodeSize + k], row, sum.b);
      addRow(s[i + 2 * kNodeSize + k], row, sum.c);
      addRow(s[i + 3 * kNodeSize + k], row, sum.d);
    }
    storeRows(sum, c + i);
  }
}

/// Transposes four by four at a time.
SPRINGTOWER_INLINE void transposeBlock(const float* from, float* to) {
  for (std::size_t i = 0; i < kNodeSize; i += 4) {
    for (std::size_t k = 0; k < kNodeSize; k += 4) {
      Quad a, b, c, d;
      __builtin_memcpy(&a, from + kNodeSize * i + k, sizeof a);
      __builtin_memcpy(&b, from + kNodeSize * (i + 1) + k, sizeof b);
      __builtin_memcpy(&c, from + kNodeSize * (i + 2) + k, sizeof c);
      __builtin_memcpy(&d, from + kNodeSize * (i + 3) + k, sizeof d);
      const Quad ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
      const Quad cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
      const Quad abLast = __builtin_shufflevector(a, b, 2, 6, 3, 7);
      const Quad cdLast = __builtin_shufflevector(c, d, 2, 6, 3, 7);
      const Quad first = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
      const Quad second = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
      const Quad third = __builtin_shufflevector(abLast, cdLast, 0, 1, 4, 5);
      const Quad fourth = __builtin_shufflevector(abLast, cdLast, 2, 3, 6, 7);
      __builtin_memcpy(to + kNodeSize * k + i, &first, sizeof first);
      __builtin_memcpy(to + kNodeSize * (k + 1) + i, &second, sizeof second);
      __builtin_memcpy(to + kNodeSize * (k + 2) + i, &third, sizeof third);
      __builtin_memcpy(to + kNodeSize * (k + 3) + i, &fourth, sizeof fourth);
    }
  }
}

/// Splits a row into its entry p alone and the rest.
using OctetOfPlaces = std::int32_t __attribute__((vector_size(32)));
using QuadOfPlaces = std::int32_t __attribute__((vector_size(16)));
SPRINGTOWER_INLINE void splitRow(std::int32_t p, const BlockRow& row, float entry, BlockRow& without, BlockRow& alone) {
  const OctetOfPlaces low = OctetOfPlaces{0, 1, 2, 3, 4, 5, 6, 7} == p;
  const QuadOfPlaces high = QuadOfPlaces{8, 9, 10, 11} == p;
  without.low = low ? Octet{} : row.low;
  without.high = high ? Quad{} : row.high;
  alone.low = low ? Octet{} + entry : Octet{};
  alone.high = high ? Quad{} + entry : Quad{};
}

/// Gauss-Jordan without pivoting, in place; for positive definite blocks every pivot is positive. FourRows are changed as vectors
/// only: storing a single number into a row would stall the next load of it.
SPRINGTOWER_INLINE bool invertBlock(float* m) {
  bool positive = true;
  for (std::size_t p = 0; p < kNodeSize; ++p) {
    const float pivot = m[kNodeSize * p + p];
    positive = positive && pivot > 0.0F;
    const float inverse = 1.0F / pivot;
    const auto at = static_cast<std::int32_t>(p);
    BlockRow row, alone;
    loadRow(m + kNodeSize * p, row);
    splitRow(at, row, inverse, row, alone);
    row.low = row.low * inverse + alone.low;
    row.high = row.high * inverse + alone.high;
    storeRow(row, m + kNodeSize * p);
    for (std::size_t i = 0; i < kNodeSize; ++i) {
      if (i == p) continue;
      const float factor = m[kNodeSize * i + p];
      BlockRow other;
      loadRow(m + kNodeSize * i, other);
      splitRow(at, other, 0.0F, other, alone);
      subtractRow(factor, row, other);
      storeRow(other, m + kNodeSize * i);
    }
  }
  return positive;
}

/// y -= t^T x
SPRINGTOWER_INLINE void subtractTransposedTimes(const float* t, const float* x, float* y) {
  BlockRow sum;
  loadRow(y, sum);
  for (std::size_t k = 0; k < kNodeSize; ++k) {
    BlockRow row;
    loadRow(t + kNodeSize * k, row);
    subtractRow(x[k], row, sum);
  }
  storeRow(sum, y);
}

/// The sum over the lanes of each of four quads.
SPRINGTOWER_INLINE void quadSums(const Quad& a, const Quad& b, const Quad& c, const Quad& d, Quad& result) {
  const Quad ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  result = __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

SPRINGTOWER_INLINE void quadTimes(const float* t, const Quad& x0, const Quad& x1, const Quad& x2, Quad& result) {
  Quad a, b, c;
  __builtin_memcpy(&a, t, sizeof a);
  __builtin_memcpy(&b, t + 4, sizeof b);
  __builtin_memcpy(&c, t + 8, sizeof c);
  result = a * x0 + b * x1 + c * x2;
}

/// y -= t x
SPRINGTOWER_INLINE void subtractBlockTimes(const float* t, const float* x, float* y) {
  Quad x0, x1, x2;
  __builtin_memcpy(&x0, x, sizeof x0);
  __builtin_memcpy(&x1, x + 4, sizeof x1);
  __builtin_memcpy(&x2, x + 8, sizeof x2);
  for (std::size_t r = 0; r < kNodeSize; r += 4) {
    Quad a, b, c, d, total, old;
    quadTimes(t + kNodeSize * r, x0, x1, x2, a);
    quadTimes(t + kNodeSize * (r + 1), x0, x1, x2, b);
    quadTimes(t + kNodeSize * (r + 2), x0, x1, x2, c);
    quadTimes(t + kNodeSize * (r + 3), x0, x1, x2, d);
    quadSums(a, b, c, d, total);
    __builtin_memcpy(&old, y + r, sizeof old);
    old -= total;
    __builtin_memcpy(y + r, &old, sizeof old);
  }
}

/// The first number of a stored block.
inline float* blockAt(AlignedVector<float>& values, std::size_t block) {
  return values.data() + kNodeMatrix * block;
}

}  // namespace springtower
