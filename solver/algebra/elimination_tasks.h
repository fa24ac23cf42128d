#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// The columns of a wide factorisation, divided by the elimination tree (Liu 1990): subtrees of about equal cost, whose columns
/// do not update one another's, are eliminated as tasks on many threads; above them lies the top, which all of them update, in
/// parts of tuning::kTopPart columns. The division depends on the pattern alone, so results do not depend on the number of
/// threads.
struct EliminationTasks {
  /// Blocks first .. last of a task's column, whose rows lie in the same part of the top.
  struct Source {
    std::int32_t column;
    std::int32_t first;
    std::int32_t last;
  };
  std::vector<std::int32_t> columnStart;  ///< columns of task t are column[columnStart[t]] .. column[columnStart[t + 1]]
  std::vector<std::int32_t> column;       ///< ascending within a task
  std::vector<std::int32_t> taskOf;       ///< [columns]; -1 - p: the p-th of the top
  std::vector<std::int32_t> firstTop;     ///< [columns], first block whose row is in the top; blocks before it lie in the task
  std::vector<std::int32_t> top;          ///< columns of the top, ascending
  std::vector<std::int32_t> sourceStart;  ///< tasks' blocks in the rows of part p are source[sourceStart[p]] ..
  std::vector<Source> source;             ///< ascending by column
  std::size_t tallestTop = 0;             ///< most blocks of a column in the top

  [[nodiscard]] std::size_t partCount() const { return sourceStart.empty() ? 0 : sourceStart.size() - 1; }
  [[nodiscard]] bool isTop(std::size_t columnAt) const { return taskOf[columnAt] < 0; }
  [[nodiscard]] std::size_t topPlace(std::size_t columnAt) const { return static_cast<std::size_t>(-1 - taskOf[columnAt]); }
  [[nodiscard]] bool empty() const { return column.empty(); }
  [[nodiscard]] std::size_t count() const { return columnStart.empty() ? 0 : columnStart.size() - 1; }
};

/// Divides the columns of a pattern of L: the rows of column j, ascending, are row[columnStart[j]] .. row[columnStart[j + 1]].
void divideColumns(std::span<const std::int32_t> columnStart, std::span<const std::int32_t> row, EliminationTasks& tasks);

}  // namespace springtower
