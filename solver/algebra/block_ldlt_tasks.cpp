#include "solver/algebra/block_ldlt_tasks.h"

#include "core/flush_denormals.h"
#include "core/lanes.h"
#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/algebra/block_kernels.h"
#include "solver/algebra/eliminate_column.h"

#include <algorithm>

namespace springtower {

namespace {

std::size_t at(std::int32_t index) {
  return static_cast<std::size_t>(index);
}

// forRanges whose ranges, on whatever thread, have no denormal numbers: what fills in gets less from column to column, and
// without this a factorisation of 5000 blocks takes twice as long and more.
template <class Body>
void overRanges(std::size_t count, std::size_t grain, bool parallel, const Body& body) {
  forRanges(count, grain, parallel, [&](std::size_t first, std::size_t last) {
    const FlushDenormals flush;
    body(first, last);
  });
}

// Eliminates a task's columns, as far as its own columns are concerned: blocks in rows of the top are updated, but left
// undivided.
SPRINGTOWER_KERNEL
bool eliminateTask(BlockCholesky& matrix, std::span<const std::int32_t> columns) {
  bool positive = true;
  for (const std::int32_t column : columns)
    positive = eliminateColumn(matrix, at(column), at(matrix.tasks.firstTop[at(column)])) && positive;
  return positive;
}

// Updates the columns of a part of the top by all columns of tasks. Several columns at once, so that a block U that has been read
// serves more than one product.
SPRINGTOWER_KERNEL
void gatherTopColumns(BlockCholesky& matrix, std::span<const EliminationTasks::Source> sources) {
  alignas(32) float divided[tuning::kTopPart][kNodeMatrix];
  for (const auto& [column, from, to] : sources) {
    const std::size_t first = at(matrix.columnStart[at(column)]);
    const std::size_t last = at(matrix.columnStart[at(column) + 1]);
    for (std::size_t i = at(from); i < last; ++i) {
      if (i < at(to)) divideBlock(blockAt(matrix.diagonal, at(column)), blockAt(matrix.lower, i), divided[i - at(from)]);
      updateTargets(matrix, first, i, at(from), std::min(i + 1, at(to)), divided[0]);
    }
  }
}

// Divides the blocks of a task's columns in rows of the top.
SPRINGTOWER_KERNEL
void divideTopRows(BlockCholesky& matrix, std::span<const std::int32_t> columns) {
  for (const std::int32_t column : columns) {
    for (std::int32_t i = matrix.tasks.firstTop[at(column)]; i < matrix.columnStart[at(column) + 1]; ++i) {
      alignas(32) float divided[kNodeMatrix];
      divideBlock(blockAt(matrix.diagonal, at(column)), blockAt(matrix.lower, at(i)), divided);
      std::copy_n(divided, kNodeMatrix, blockAt(matrix.lower, at(i)));
    }
  }
}

SPRINGTOWER_KERNEL
bool invertDiagonal(BlockCholesky& matrix, std::size_t column) {
  return invertBlock(blockAt(matrix.diagonal, column));
}

// Divides some blocks of a column of the top into matrix.divided.
SPRINGTOWER_KERNEL
void divideBlocks(BlockCholesky& matrix, std::size_t column, std::size_t from, std::size_t to) {
  const std::size_t first = at(matrix.columnStart[column]);
  for (std::size_t i = from; i < to; ++i)
    divideBlock(blockAt(matrix.diagonal, column), blockAt(matrix.lower, i), blockAt(matrix.divided, i - first));
}

// Updates what lies in the row of block i of a column of the top.
SPRINGTOWER_KERNEL
void updateRow(BlockCholesky& matrix, std::size_t first, std::size_t i) {
  updateTargets(matrix, first, i, first, i + 1, matrix.divided.data());
}

bool eliminateTopColumn(BlockCholesky& matrix, std::size_t column) {
  const bool positive = invertDiagonal(matrix, column);
  const std::size_t first = at(matrix.columnStart[column]);
  const std::size_t count = at(matrix.columnStart[column + 1]) - first;
  const bool parallel = count * (count + 3) / 2 >= tuning::kParallelProducts;
  overRanges(count, tuning::kEliminationRowGrain, parallel,
             [&](std::size_t from, std::size_t to) { divideBlocks(matrix, column, first + from, first + to); });
  // Rows have the more to do the later they come, so each range takes as many from the end as from the beginning.
  overRanges((count + 1) / 2, tuning::kEliminationRowGrain, parallel, [&](std::size_t from, std::size_t to) {
    for (std::size_t r = from; r < to; ++r) {
      updateRow(matrix, first, first + r);
      if (count - 1 - r != r) updateRow(matrix, first, first + count - 1 - r);
    }
  });
  std::copy_n(matrix.divided.data(), kNodeMatrix * count, blockAt(matrix.lower, first));
  return positive;
}

std::span<const std::int32_t> columnsOf(const EliminationTasks& tasks, std::size_t task) {
  const std::size_t first = at(tasks.columnStart[task]);
  return std::span(tasks.column).subspan(first, at(tasks.columnStart[task + 1]) - first);
}

std::span<const EliminationTasks::Source> sourcesOf(const EliminationTasks& tasks, std::size_t part) {
  const std::size_t first = at(tasks.sourceStart[part]);
  return std::span(tasks.source).subspan(first, at(tasks.sourceStart[part + 1]) - first);
}

template <class Kernel>
void overTasks(const EliminationTasks& tasks, const Kernel& kernel) {
  overRanges(tasks.count(), 1, true, [&](std::size_t first, std::size_t last) {
    for (std::size_t task = first; task < last; ++task) kernel(columnsOf(tasks, task));
  });
}

// Forward substitution of a task's columns; what they take from values of the top goes to `ofTop`, [top][12].
SPRINGTOWER_KERNEL
void substituteTask(const BlockCholesky& matrix, std::span<const std::int32_t> columns, float* y, float* ofTop) {
  const EliminationTasks& tasks = matrix.tasks;
  std::fill_n(ofTop, kNodeSize * tasks.top.size(), 0.0F);
  for (const std::int32_t column : columns) {
    const float* value = y + kNodeSize * at(column);
    for (std::int32_t i = matrix.columnStart[at(column)]; i < matrix.columnStart[at(column) + 1]; ++i) {
      const std::size_t row = at(matrix.row[at(i)]);
      float* to = i < tasks.firstTop[at(column)] ? y + kNodeSize * row : ofTop + kNodeSize * tasks.topPlace(row);
      subtractTransposedTimes(matrix.lower.data() + kNodeMatrix * at(i), value, to);
    }
  }
}

// Adds what tasks have taken from some values of the top.
void addTaken(const BlockCholesky& matrix, std::size_t first, std::size_t last, float* y) {
  const EliminationTasks& tasks = matrix.tasks;
  for (std::size_t task = 0; task < tasks.count(); ++task) {
    const float* taken = matrix.taken.data() + kNodeSize * tasks.top.size() * task;
    for (std::size_t t = first; t < last; ++t) {
      for (std::size_t c = 0; c < kNodeSize; ++c) y[kNodeSize * at(tasks.top[t]) + c] += taken[kNodeSize * t + c];
    }
  }
}

SPRINGTOWER_KERNEL
void substituteTop(const BlockCholesky& matrix, float* y) {
  for (const std::int32_t column : matrix.tasks.top) {
    for (std::int32_t i = matrix.columnStart[at(column)]; i < matrix.columnStart[at(column) + 1]; ++i) {
      subtractTransposedTimes(matrix.lower.data() + kNodeMatrix * at(i), y + kNodeSize * at(column),
                              y + kNodeSize * at(matrix.row[at(i)]));
    }
  }
}

// Division by D and back substitution of these columns, from the last.
SPRINGTOWER_KERNEL
void backward(const BlockCholesky& matrix, std::span<const std::int32_t> columns, float* y) {
  for (std::size_t c = columns.size(); c-- > 0;) {
    const std::size_t j = at(columns[c]);
    float scaled[kNodeSize];
    float* mine = y + kNodeSize * j;
    BlockRow sum{};
    const float* inverse = matrix.diagonal.data() + kNodeMatrix * j;
    for (std::size_t k = 0; k < kNodeSize; ++k) {
      BlockRow row;
      loadRow(inverse + kNodeSize * k, row);
      addRow(mine[k], row, sum);
    }
    storeRow(sum, scaled);
    for (std::int32_t i = matrix.columnStart[j]; i < matrix.columnStart[j + 1]; ++i)
      subtractBlockTimes(matrix.lower.data() + kNodeMatrix * at(i), y + kNodeSize * at(matrix.row[at(i)]), scaled);
    std::copy_n(scaled, kNodeSize, mine);
  }
}

// On one thread: all columns of tasks, then those of the top. Every block sums the same products in the same order as in tasks,
// which divide some blocks twice.
SPRINGTOWER_KERNEL
bool factoriseInSequence(BlockCholesky& matrix) {
  bool positive = true;
  for (std::size_t j = 0; j < matrix.nodeCount(); ++j) {
    if (!matrix.tasks.isTop(j)) positive = eliminateColumn(matrix, j) && positive;
  }
  for (const std::int32_t column : matrix.tasks.top) positive = eliminateColumn(matrix, at(column)) && positive;
  return positive;
}

}  // namespace

bool factoriseInTasks(BlockCholesky& matrix) {
  if (threadsNow() == 1) return factoriseInSequence(matrix);
  const EliminationTasks& tasks = matrix.tasks;
  const auto both = [](bool a, bool b) { return a && b; };
  bool positive = mergeRanges(
      tasks.count(), 1, true, true,
      [&](std::size_t first, std::size_t last) {
        const FlushDenormals flush;
        bool all = true;
        for (std::size_t task = first; task < last; ++task) all = eliminateTask(matrix, columnsOf(tasks, task)) && all;
        return all;
      },
      both);
  overRanges(tasks.partCount(), 1, true, [&](std::size_t first, std::size_t last) {
    for (std::size_t part = first; part < last; ++part) gatherTopColumns(matrix, sourcesOf(tasks, part));
  });
  overTasks(tasks, [&](std::span<const std::int32_t> columns) { divideTopRows(matrix, columns); });
  for (const std::int32_t column : tasks.top) positive = eliminateTopColumn(matrix, at(column)) && positive;
  return positive;
}

void solveInTasks(BlockCholesky& matrix, std::span<double> values) {
  const EliminationTasks& tasks = matrix.tasks;
  float* y = matrix.work.data();
  const auto overNodes = [&](const auto& kernel) {
    overRanges(matrix.nodeCount(), tuning::kBlockGrain, true, [&](std::size_t first, std::size_t last) {
      for (std::size_t j = first; j < last; ++j) kernel(values.data() + kNodeSize * at(matrix.node[j]), y + kNodeSize * j);
    });
  };
  overNodes([](const double* from, float* to) {
    for (std::size_t c = 0; c < kNodeSize; ++c) to[c] = static_cast<float>(from[c]);
  });
  overRanges(tasks.count(), 1, true, [&](std::size_t first, std::size_t last) {
    for (std::size_t task = first; task < last; ++task)
      substituteTask(matrix, columnsOf(tasks, task), y, matrix.taken.data() + kNodeSize * tasks.top.size() * task);
  });
  overRanges(tasks.top.size(), tuning::kBlockGrain, true,
             [&](std::size_t first, std::size_t last) { addTaken(matrix, first, last, y); });
  substituteTop(matrix, y);
  backward(matrix, tasks.top, y);
  overTasks(tasks, [&](std::span<const std::int32_t> columns) { backward(matrix, columns, y); });
  overNodes([](double* to, const float* from) {
    for (std::size_t c = 0; c < kNodeSize; ++c) to[c] = static_cast<double>(from[c]);
  });
}

}  // namespace springtower
