#include "solver/algebra/gauss_seidel.h"

#include "core/lanes.h"
#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/algebra/block_kernels.h"
#include "solver/algebra/eliminate_column.h"

#include <algorithm>

namespace springtower {

namespace {

SPRINGTOWER_KERNEL
bool divideByDiagonal(BlockCholesky& matrix, std::size_t first, std::size_t last) {
  bool positive = true;
  for (std::size_t j = first; j < last; ++j) {
    float* inverse = blockAt(matrix.diagonal, j);
    positive = invertBlock(inverse) && positive;
    const auto end = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (auto i = static_cast<std::size_t>(matrix.columnStart[j]); i < end; ++i)
      divideBlock(inverse, blockAt(matrix.ownLower, i), blockAt(matrix.lower, i));
  }
  return positive;
}

// The negative of the product in `to`, [position][12].
SPRINGTOWER_KERNEL
void subtractProduct(const BlockCholesky& matrix, const float* from, float* to) {
  for (std::size_t j = 0; j < matrix.nodeCount(); ++j) {
    const float* x = from + kNodeSize * j;
    float* y = to + kNodeSize * j;
    subtractBlockTimes(matrix.ownDiagonal.data() + kNodeMatrix * j, x, y);
    const auto end = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (auto i = static_cast<std::size_t>(matrix.columnStart[j]); i < end; ++i) {
      const float* block = matrix.ownLower.data() + kNodeMatrix * i;
      const std::size_t row = kNodeSize * static_cast<std::size_t>(matrix.row[i]);
      subtractBlockTimes(block, x, to + row);
      subtractTransposedTimes(block, from + row, y);
    }
  }
}

}  // namespace

void layOutWithoutFill(std::span<const std::int32_t> order, std::span<const BlockPair> edges, BlockCholesky& matrix) {
  layOutPattern(order, edges, matrix);
  const std::size_t count = order.size();
  matrix.isWithoutFill = true;
  matrix.products = matrix.row.size();
  matrix.target.clear();
  matrix.targetStart.clear();
  matrix.tasks = {};
  matrix.divided.clear();
  matrix.taken.clear();
  matrix.diagonal.resize(kNodeMatrix * count);
  matrix.lower.resize(kNodeMatrix * matrix.row.size());
  matrix.ownDiagonal.resize(matrix.diagonal.size());
  matrix.ownLower.resize(matrix.lower.size());
  matrix.work.resize(2 * kNodeSize * count);
}

bool factoriseWithoutFill(BlockCholesky& matrix) {
  std::copy(matrix.diagonal.begin(), matrix.diagonal.end(), matrix.ownDiagonal.begin());
  std::swap(matrix.lower, matrix.ownLower);
  const std::size_t count = matrix.nodeCount();
  return mergeRanges(
      count, tuning::kBlockGrain, count >= tuning::kParallelBlocks, true,
      [&](std::size_t first, std::size_t last) { return divideByDiagonal(matrix, first, last); },
      [](bool a, bool b) { return a && b; });
}

void multiply(BlockCholesky& matrix, std::span<const double> x, std::span<double> y) {
  const std::size_t count = matrix.nodeCount();
  float* from = matrix.work.data();
  float* to = from + kNodeSize * count;
  for (std::size_t j = 0; j < count; ++j) {
    const double* value = x.data() + kNodeSize * static_cast<std::size_t>(matrix.node[j]);
    for (std::size_t c = 0; c < kNodeSize; ++c) from[kNodeSize * j + c] = static_cast<float>(value[c]);
  }
  std::fill_n(to, kNodeSize * count, 0.0F);
  subtractProduct(matrix, from, to);
  for (std::size_t j = 0; j < count; ++j) {
    double* value = y.data() + kNodeSize * static_cast<std::size_t>(matrix.node[j]);
    for (std::size_t c = 0; c < kNodeSize; ++c) value[c] = -static_cast<double>(to[kNodeSize * j + c]);
  }
}

}  // namespace springtower
