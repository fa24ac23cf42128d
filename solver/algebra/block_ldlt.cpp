#include "solver/algebra/block_ldlt.h"

#include "core/flush_denormals.h"
#include "core/lanes.h"
#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/algebra/block_kernels.h"
#include "solver/algebra/block_ldlt_tasks.h"
#include "solver/algebra/eliminate_column.h"

#include <algorithm>
#include <iterator>

namespace springtower {

namespace {

std::int32_t find(const BlockCholesky& matrix, std::int32_t column, std::int32_t row) {
  const auto first = matrix.row.begin() + matrix.columnStart[static_cast<std::size_t>(column)];
  const auto last = matrix.row.begin() + matrix.columnStart[static_cast<std::size_t>(column) + 1];
  return static_cast<std::int32_t>(std::lower_bound(first, last, row) - matrix.row.begin());
}

// The pattern of A below the diagonal by columns: edgeRow[edgeStart[j] .. edgeStart[j + 1]], by a counting sort.
void findColumns(std::span<const BlockPair> edges, BlockCholesky& matrix) {
  const auto ends = [&](const BlockPair& edge) {
    const std::int32_t p = matrix.position[static_cast<std::size_t>(edge.a)];
    const std::int32_t q = matrix.position[static_cast<std::size_t>(edge.b)];
    return std::pair{static_cast<std::size_t>(std::min(p, q)), std::max(p, q)};
  };
  const std::size_t count = matrix.node.size();
  matrix.edgeStart.assign(count + 2, 0);
  matrix.edgeRow.resize(edges.size());
  for (const BlockPair& edge : edges) ++matrix.edgeStart[ends(edge).first + 2];
  for (std::size_t j = 2; j < count + 2; ++j) matrix.edgeStart[j] += matrix.edgeStart[j - 1];
  for (const BlockPair& edge : edges) {
    const auto [column, row] = ends(edge);
    matrix.edgeRow[static_cast<std::size_t>(matrix.edgeStart[column + 1]++)] = row;
  }
}

void setOrder(std::span<const std::int32_t> order, BlockCholesky& matrix) {
  matrix.node.assign(order.begin(), order.end());
  matrix.position.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    matrix.position[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);
}

SPRINGTOWER_KERNEL
bool factoriseInOrder(BlockCholesky& matrix) {
  bool positive = true;
  for (std::size_t j = 0; j < matrix.nodeCount(); ++j) positive = eliminateColumn(matrix, j) && positive;
  return positive;
}

SPRINGTOWER_KERNEL
void solveInOrder(BlockCholesky& matrix, std::span<double> values) {
  float* y = matrix.work.data();
  const std::size_t count = matrix.nodeCount();
  for (std::size_t j = 0; j < count; ++j) {
    const double* from = values.data() + kNodeSize * static_cast<std::size_t>(matrix.node[j]);
    for (std::size_t c = 0; c < kNodeSize; ++c) y[kNodeSize * j + c] = static_cast<float>(from[c]);
  }
  for (std::size_t j = 0; j < count; ++j) {
    const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (auto i = static_cast<std::size_t>(matrix.columnStart[j]); i < last; ++i) {
      subtractTransposedTimes(blockAt(matrix.lower, i), y + kNodeSize * j,
                              y + kNodeSize * static_cast<std::size_t>(matrix.row[i]));
    }
  }
  for (std::size_t j = count; j-- > 0;) {
    float scaled[kNodeSize];
    float* mine = y + kNodeSize * j;
    BlockRow sum{};
    const float* inverse = blockAt(matrix.diagonal, j);
    for (std::size_t k = 0; k < kNodeSize; ++k) {
      BlockRow row;
      loadRow(inverse + kNodeSize * k, row);
      addRow(mine[k], row, sum);
    }
    storeRow(sum, scaled);
    const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (auto i = static_cast<std::size_t>(matrix.columnStart[j]); i < last; ++i) {
      subtractBlockTimes(blockAt(matrix.lower, i), y + kNodeSize * static_cast<std::size_t>(matrix.row[i]), scaled);
    }
    for (std::size_t c = 0; c < kNodeSize; ++c) mine[c] = scaled[c];
    double* to = values.data() + kNodeSize * static_cast<std::size_t>(matrix.node[j]);
    for (std::size_t c = 0; c < kNodeSize; ++c) to[c] = static_cast<double>(scaled[c]);
  }
}

}  // namespace

void layOutPattern(std::span<const std::int32_t> order, std::span<const BlockPair> edges, BlockCholesky& matrix) {
  setOrder(order, matrix);
  findColumns(edges, matrix);
  matrix.columnStart.assign(1, 0);
  matrix.row.clear();
  for (std::size_t j = 0; j < order.size(); ++j) {
    const auto first = matrix.edgeRow.begin() + matrix.edgeStart[j];
    const auto last = matrix.edgeRow.begin() + matrix.edgeStart[j + 1];
    std::sort(first, last);
    std::unique_copy(first, last, std::back_inserter(matrix.row));
    matrix.columnStart.push_back(static_cast<std::int32_t>(matrix.row.size()));
  }
}

bool findPattern(std::span<const std::int32_t> order, std::span<const BlockPair> edges, std::size_t mostProducts,
                 BlockCholesky& matrix) {
  const std::size_t count = order.size();
  setOrder(order, matrix);
  findColumns(edges, matrix);

  // The pattern of L: column j is the union of its own part of A and the remainders of the columns whose first row below the
  // diagonal is j (their parent in the elimination tree).
  matrix.columnStart.assign(1, 0);
  matrix.row.clear();
  matrix.mark.assign(count, -1);
  matrix.firstChild.assign(count, -1);
  matrix.nextChild.assign(count, -1);
  std::size_t products = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const auto column = static_cast<std::int32_t>(j);
    const std::size_t first = matrix.row.size();
    matrix.mark[j] = column;
    const auto add = [&](std::int32_t row) {
      if (matrix.mark[static_cast<std::size_t>(row)] == column) return;
      matrix.mark[static_cast<std::size_t>(row)] = column;
      matrix.row.push_back(row);
    };
    for (std::int32_t i = matrix.edgeStart[j]; i < matrix.edgeStart[j + 1]; ++i) add(matrix.edgeRow[static_cast<std::size_t>(i)]);
    for (std::int32_t child = matrix.firstChild[j]; child >= 0; child = matrix.nextChild[static_cast<std::size_t>(child)]) {
      const auto c = static_cast<std::size_t>(child);
      for (std::int32_t i = matrix.columnStart[c]; i < matrix.columnStart[c + 1]; ++i)
        add(matrix.row[static_cast<std::size_t>(i)]);
    }
    const std::size_t below = matrix.row.size() - first;
    products += below * (below + 3) / 2;
    if (products > mostProducts) return false;
    std::sort(matrix.row.begin() + static_cast<std::ptrdiff_t>(first), matrix.row.end());
    matrix.columnStart.push_back(static_cast<std::int32_t>(matrix.row.size()));
    if (below == 0) continue;
    const auto parent = static_cast<std::size_t>(matrix.row[first]);
    matrix.nextChild[j] = matrix.firstChild[parent];
    matrix.firstChild[parent] = column;
  }
  matrix.products = products;
  return true;
}

void releaseLayoutSpace(BlockCholesky& matrix) {
  for (auto* space : {&matrix.mark, &matrix.firstChild, &matrix.nextChild, &matrix.edgeStart, &matrix.edgeRow})
    *space = std::vector<std::int32_t>();
}

bool analyse(std::span<const std::int32_t> order, std::span<const BlockPair> edges, std::size_t mostProducts,
             BlockCholesky& matrix) {
  if (!findPattern(order, edges, mostProducts, matrix)) return false;
  listUpdates(matrix);
  return true;
}

void listUpdates(BlockCholesky& matrix) {
  const std::size_t count = matrix.node.size();
  matrix.isWithoutFill = false;
  matrix.ownDiagonal = {};
  matrix.ownLower = {};
  matrix.target.clear();
  matrix.targetStart.clear();
  for (std::size_t j = 0; j < count; ++j) {
    const auto first = static_cast<std::size_t>(matrix.columnStart[j]);
    const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (std::size_t i = first; i < last; ++i) {
      matrix.targetStart.push_back(static_cast<std::int32_t>(matrix.target.size()));
      for (std::size_t k = first; k < i; ++k) matrix.target.push_back(find(matrix, matrix.row[k], matrix.row[i]));
      matrix.target.push_back(-1 - matrix.row[i]);
    }
  }
  matrix.tasks = {};
  if (count >= tuning::kParallelBlocks) divideColumns(matrix.columnStart, matrix.row, matrix.tasks);
  matrix.divided.resize(kNodeMatrix * matrix.tasks.tallestTop);
  matrix.taken.resize(kNodeSize * matrix.tasks.top.size() * matrix.tasks.count());
  matrix.diagonal.resize(kNodeMatrix * count);
  matrix.lower.resize(kNodeMatrix * matrix.row.size());
  matrix.work.resize(kNodeSize * count);
}

bool holds(const BlockCholesky& matrix, std::span<const BlockPair> edges) {
  return std::all_of(edges.begin(), edges.end(), [&](const BlockPair& edge) {
    const std::int32_t p = matrix.position[static_cast<std::size_t>(edge.a)];
    const std::int32_t q = matrix.position[static_cast<std::size_t>(edge.b)];
    const std::int32_t at = find(matrix, std::min(p, q), std::max(p, q));
    return at < matrix.columnStart[static_cast<std::size_t>(std::min(p, q)) + 1] &&
           matrix.row[static_cast<std::size_t>(at)] == std::max(p, q);
  });
}

BlockSlot slotOf(const BlockCholesky& matrix, std::int32_t first, std::int32_t second) {
  const std::int32_t p = matrix.position[static_cast<std::size_t>(first)];
  const std::int32_t q = matrix.position[static_cast<std::size_t>(second)];
  return {find(matrix, std::min(p, q), std::max(p, q)), p > q};
}

void clear(BlockCholesky& matrix) {
  const auto fill = [&](AlignedVector<float>& values) {
    forRanges(values.size(), tuning::kBlockGrain * kNodeMatrix, !matrix.tasks.empty(),
              [&](std::size_t first, std::size_t last) { std::fill(values.data() + first, values.data() + last, 0.0F); });
  };
  fill(matrix.diagonal);
  fill(matrix.lower);
}

bool factorise(BlockCholesky& matrix) {
  const FlushDenormals flush;
  return matrix.tasks.empty() ? factoriseInOrder(matrix) : factoriseInTasks(matrix);
}

void solve(BlockCholesky& matrix, std::span<double> values) {
  const FlushDenormals flush;
  matrix.tasks.empty() ? solveInOrder(matrix, values) : solveInTasks(matrix, values);
}

}  // namespace springtower
