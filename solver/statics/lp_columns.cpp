#include "solver/statics/lp_columns.h"

#include <ClpSimplex.hpp>

namespace springtower {

void LpColumns::addTo(ClpSimplex& clp) const {
  if (count() == 0) return;
  const std::vector<CoinBigIndex> begins(start.begin(), start.end());
  clp.addColumns(count(), nullptr, nullptr, cost.data(), begins.data(), row.data(), value.data());
}

}  // namespace springtower
