#include "solver/algebra/elimination_tasks.h"

#include "core/tuning.h"

#include <algorithm>
#include <numeric>

namespace springtower {

namespace {

constexpr std::int32_t kTop = -1;

std::size_t asSize(std::int32_t column) {
  return static_cast<std::size_t>(column);
}

// Block products that the elimination of each column and of all below it in the tree takes. A column's parent is its first row.
std::vector<double> subtreeCosts(std::span<const std::int32_t> columnStart, std::span<const std::int32_t> row) {
  std::vector<double> cost(columnStart.size() - 1, 0.0);
  for (std::size_t j = 0; j < cost.size(); ++j) {
    const double below = columnStart[j + 1] - columnStart[j];
    cost[j] += 1.0 + 0.5 * below * (below + 3.0);
    if (below > 0.0) cost[asSize(row[asSize(columnStart[j])])] += cost[j];
  }
  return cost;
}

// Gives each column the largest subtree below the limit that it lies in, by the subtree's root, or the top.
void findSubtrees(std::span<const std::int32_t> columnStart, std::span<const std::int32_t> row, std::span<const double> cost,
                  double limit, std::vector<std::int32_t>& rootOf) {
  rootOf.assign(cost.size(), kTop);
  for (std::size_t j = cost.size(); j-- > 0;) {
    if (cost[j] > limit) continue;
    const bool isRoot = columnStart[j + 1] == columnStart[j] || rootOf[asSize(row[asSize(columnStart[j])])] == kTop;
    rootOf[j] = isRoot ? static_cast<std::int32_t>(j) : rootOf[asSize(row[asSize(columnStart[j])])];
  }
}

// Bundles subtrees, in the order of their roots, into tasks of at least half the limit; returns the number of tasks. On return
// taskOf of each root is its task.
std::int32_t bundle(std::span<const double> cost, double limit, std::span<const std::int32_t> rootOf,
                    std::vector<std::int32_t>& taskOf) {
  std::int32_t task = 0;
  double filled = 0.0;
  for (std::size_t j = 0; j < cost.size(); ++j) {
    if (rootOf[j] != static_cast<std::int32_t>(j)) continue;
    if (filled >= 0.5 * limit) {
      ++task;
      filled = 0.0;
    }
    taskOf[j] = task;
    filled += cost[j];
  }
  return task + 1;
}

void listSources(std::span<const std::int32_t> columnStart, std::span<const std::int32_t> row, EliminationTasks& tasks) {
  const auto partOf = [&](std::int32_t block) { return tasks.topPlace(asSize(row[asSize(block)])) / tuning::kTopPart; };
  const std::size_t parts = (tasks.top.size() + tuning::kTopPart - 1) / tuning::kTopPart;
  const auto forSources = [&](const auto& visit) {
    for (std::size_t j = 0; j < tasks.taskOf.size(); ++j) {
      if (tasks.isTop(j)) continue;
      std::int32_t first = tasks.firstTop[j];
      for (std::int32_t i = first; i < columnStart[j + 1]; ++i) {
        const std::size_t part = partOf(i);
        if (i + 1 < columnStart[j + 1] && partOf(i + 1) == part) continue;
        visit(part, EliminationTasks::Source{static_cast<std::int32_t>(j), first, i + 1});
        first = i + 1;
      }
    }
  };
  tasks.sourceStart.assign(parts + 2, 0);
  forSources([&](std::size_t part, const EliminationTasks::Source& /*source*/) { ++tasks.sourceStart[part + 2]; });
  std::partial_sum(tasks.sourceStart.begin(), tasks.sourceStart.end(), tasks.sourceStart.begin());
  tasks.source.resize(asSize(tasks.sourceStart.back()));
  forSources([&](std::size_t part, const EliminationTasks::Source& source) {
    tasks.source[asSize(tasks.sourceStart[part + 1]++)] = source;
  });
  tasks.sourceStart.pop_back();
}

}  // namespace

void divideColumns(std::span<const std::int32_t> columnStart, std::span<const std::int32_t> row, EliminationTasks& tasks) {
  const std::vector<double> cost = subtreeCosts(columnStart, row);
  double total = 0.0;
  for (std::size_t j = 0; j < cost.size(); ++j) total += columnStart[j + 1] == columnStart[j] ? cost[j] : 0.0;
  const double limit = total / tuning::kEliminationTasks;
  std::vector<std::int32_t> rootOf;
  findSubtrees(columnStart, row, cost, limit, rootOf);
  tasks.taskOf.assign(cost.size(), kTop);
  const std::int32_t count = bundle(cost, limit, rootOf, tasks.taskOf);
  tasks.columnStart.assign(asSize(count) + 2, 0);
  tasks.firstTop.assign(cost.size(), 0);
  tasks.top.clear();
  tasks.tallestTop = 0;
  for (std::size_t j = 0; j < cost.size(); ++j) {
    tasks.firstTop[j] = columnStart[j];
    if (rootOf[j] == kTop) {
      tasks.taskOf[j] = -1 - static_cast<std::int32_t>(tasks.top.size());
      tasks.top.push_back(static_cast<std::int32_t>(j));
      tasks.tallestTop = std::max(tasks.tallestTop, asSize(columnStart[j + 1] - columnStart[j]));
      continue;
    }
    tasks.taskOf[j] = tasks.taskOf[asSize(rootOf[j])];
    ++tasks.columnStart[asSize(tasks.taskOf[j]) + 2];
    while (tasks.firstTop[j] < columnStart[j + 1] && rootOf[asSize(row[asSize(tasks.firstTop[j])])] != kTop) ++tasks.firstTop[j];
  }
  std::partial_sum(tasks.columnStart.begin(), tasks.columnStart.end(), tasks.columnStart.begin());
  tasks.column.resize(asSize(tasks.columnStart.back()));
  for (std::size_t j = 0; j < cost.size(); ++j) {
    if (tasks.isTop(j)) continue;
    tasks.column[asSize(tasks.columnStart[asSize(tasks.taskOf[j]) + 1]++)] = static_cast<std::int32_t>(j);
  }
  tasks.columnStart.pop_back();
  listSources(columnStart, row, tasks);
}

}  // namespace springtower
