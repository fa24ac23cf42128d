#pragma once

#include "core/lanes.h"
#include "solver/algebra/block_kernels.h"
#include "solver/algebra/block_ldlt.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace springtower {

/// The transposed block of L, W = D^-1 U^T, of a block U that earlier columns have updated. Part of kernels, as the others here.
SPRINGTOWER_INLINE void divideBlock(const float* inverse, const float* block, float* divided) {
  alignas(32) float turned[kNodeMatrix];
  transposeBlock(block, turned);
  blockProduct(inverse, turned, divided);
}

/// Subtracts the products of block i of a column, U_i, with the transposed blocks of L from W_k up to W_last, one after another
/// from `divided`, from what elimination updates with them: blocks below the diagonal, and the diagonal itself where k comes to
/// i. `first`: the first block of the column.
SPRINGTOWER_INLINE void updateTargets(BlockCholesky& matrix, std::size_t first, std::size_t i, std::size_t k, std::size_t last,
                                      const float* divided) {
  const std::int32_t* target = matrix.target.data() + matrix.targetStart[i];
  float* lower = matrix.lower.data();
  const float* block = lower + kNodeMatrix * i;
  const std::size_t below = std::min(i, last);
  for (; k < below; ++k, divided += kNodeMatrix)
    subtractBlockProduct(block, divided, lower + kNodeMatrix * static_cast<std::size_t>(target[k - first]));
  if (k == i && i < last) {
    const auto row = static_cast<std::size_t>(-1 - target[i - first]);
    subtractBlockProduct(block, divided, matrix.diagonal.data() + kNodeMatrix * row);
  }
}

/// Eliminates column j: divides its blocks before `undivided` and updates all that these contribute to; the others are updated,
/// but left undivided. Returns whether its pivots are positive.
SPRINGTOWER_INLINE bool eliminateColumn(BlockCholesky& matrix, std::size_t j, std::size_t undivided) {
  float* inverse = blockAt(matrix.diagonal, j);
  const bool positive = invertBlock(inverse);
  const auto first = static_cast<std::size_t>(matrix.columnStart[j]);
  const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
  for (std::size_t i = first; i < last; ++i) {
    float* block = blockAt(matrix.lower, i);
    updateTargets(matrix, first, i, first, std::min(i, undivided), blockAt(matrix.lower, first));
    if (i >= undivided) continue;
    alignas(32) float divided[kNodeMatrix];
    divideBlock(inverse, block, divided);
    updateTargets(matrix, first, i, i, i + 1, divided);
    std::copy_n(divided, kNodeMatrix, block);
  }
  return positive;
}

/// Eliminates column j and divides all of its blocks.
SPRINGTOWER_INLINE bool eliminateColumn(BlockCholesky& matrix, std::size_t j) {
  return eliminateColumn(matrix, j, static_cast<std::size_t>(matrix.columnStart[j + 1]));
}

}  // namespace springtower
