#pragma once

#include <ClpSimplex.hpp>
#include <vector>

namespace springtower {

/// Columns of a linear program, one after the other, as CLP takes them: entries are added, then the column is finished with its
/// cost.
struct LpColumns {
  std::vector<CoinBigIndex> start = {0};
  std::vector<int> row;
  std::vector<double> value;
  std::vector<double> cost;

  void add(int at, double entry) {
    row.push_back(at);
    value.push_back(entry);
  }
  void finish(double theCost) {
    start.push_back(static_cast<CoinBigIndex>(row.size()));
    cost.push_back(theCost);
  }
  [[nodiscard]] int count() const { return static_cast<int>(cost.size()); }
  /// Adds them to a program; each variable is not negative and has no upper bound.
  void addTo(ClpSimplex& clp) const {
    if (count() > 0) clp.addColumns(count(), nullptr, nullptr, cost.data(), start.data(), row.data(), value.data());
  }
};

}  // namespace springtower
