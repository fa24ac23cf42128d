#pragma once

#include <vector>

class ClpSimplex;

namespace springtower {

/// Columns of a linear program, one after the other, as CLP takes them: entries are added, then the column is finished with its
/// cost.
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
  /// Adds them to a program; each variable is not negative and has no upper bound.
  void addTo(ClpSimplex& clp) const;
};

}  // namespace springtower
