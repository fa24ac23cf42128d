#pragma once

#include <vector>

class ClpSimplex;

namespace springtower {

/// Columns of a linear program in CLP's format, one after the other: add entries, then finish the column with its cost.
struct LpColumns {
  std::vector<int> start = {0};
  std::vector<int> row;
  std::vector<double> value;
  std::vector<double> cost;

  void add(int at, double entry) {
    row.push_back(at);
    value.push_back(entry);
  }
  void finish(double theCost) {
    start.push_back(static_cast<int>(row.size()));
    cost.push_back(theCost);
  }
  [[nodiscard]] int count() const { return static_cast<int>(cost.size()); }
  /// Adds the columns to a program; each variable is non-negative and has no upper bound.
  void addTo(ClpSimplex& clp) const;
};

}  // namespace springtower
