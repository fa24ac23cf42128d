#pragma once

#include "core/lanes.h"
#include "solver/algebra/block_kernels.h"
#include "solver/algebra/block_ldlt.h"

#include <cstddef>
#include <cstdint>

namespace springtower {

/// Eliminates column j: divides its blocks and updates all that they contribute to. Returns whether its pivots are positive. Part
/// of kernels.
SPRINGTOWER_INLINE bool eliminateColumn(BlockCholesky& matrix, std::size_t j) {
  float* inverse = blockAt(matrix.diagonal, j);
  const bool positive = invertBlock(inverse);
  const auto first = static_cast<std::size_t>(matrix.columnStart[j]);
  const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
  for (std::size_t i = first; i < last; ++i) {
    alignas(32) float turned[kNodeMatrix];
    alignas(32) float divided[kNodeMatrix];
    float* block = blockAt(matrix.lower, i);
    transposeBlock(block, turned);
    blockProduct(inverse, turned, divided);
    const std::int32_t* target = matrix.target.data() + matrix.targetStart[i];
    for (std::size_t k = first; k < i; ++k) {
      subtractBlockProduct(block, blockAt(matrix.lower, k), blockAt(matrix.lower, static_cast<std::size_t>(target[k - first])));
    }
    subtractBlockProduct(block, divided, blockAt(matrix.diagonal, static_cast<std::size_t>(-1 - target[i - first])));
    for (std::size_t r = 0; r < kNodeMatrix; r += 4 * kNodeSize) {
      FourRows rows;
      loadRows(divided + r, rows);
      storeRows(rows, block + r);
    }
  }
  return positive;
}

}  // namespace springtower
