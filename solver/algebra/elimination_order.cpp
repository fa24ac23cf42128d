#include "solver/algebra/elimination_order.h"

#include "core/tuning.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace springtower {

namespace {

// A cut of a sorted set at position `at`: nodes before it without a neighbour behind it, the separator, and the nodes behind.
struct Cut {
  std::size_t at = 0;
  double cost = std::numeric_limits<double>::infinity();
};

void findNeighbours(std::span<const BlockPair> edges, std::size_t count, DissectionSpace& space) {
  space.neighbourStart.assign(count + 2, 0);
  space.neighbour.resize(2 * edges.size());
  for (const BlockPair& edge : edges) {
    ++space.neighbourStart[static_cast<std::size_t>(edge.a) + 2];
    ++space.neighbourStart[static_cast<std::size_t>(edge.b) + 2];
  }
  std::partial_sum(space.neighbourStart.begin(), space.neighbourStart.end(), space.neighbourStart.begin());
  const auto add = [&](std::int32_t node, std::int32_t other) {
    space.neighbour[static_cast<std::size_t>(space.neighbourStart[static_cast<std::size_t>(node) + 1]++)] = other;
  };
  for (const BlockPair& edge : edges) {
    add(edge.a, edge.b);
    add(edge.b, edge.a);
  }
}

void sortAlong(Eigen::Index axis, std::span<const Vec3> centre, std::span<std::int32_t> nodes) {
  std::sort(nodes.begin(), nodes.end(), [&](std::int32_t p, std::int32_t q) {
    const double a = centre[static_cast<std::size_t>(p)][axis];
    const double b = centre[static_cast<std::size_t>(q)][axis];
    return a != b ? a < b : p < q;
  });
}

// Fills space.reach for a sorted set; precondition: space.place is filled for its nodes.
void findReach(std::span<const std::int32_t> sorted, DissectionSpace& space) {
  space.reach.resize(sorted.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const auto node = static_cast<std::size_t>(sorted[i]);
    std::int32_t reach = -1;
    for (std::int32_t k = space.neighbourStart[node]; k < space.neighbourStart[node + 1]; ++k)
      reach = std::max(reach, space.place[static_cast<std::size_t>(space.neighbour[static_cast<std::size_t>(k)])]);
    space.reach[i] = reach;
  }
}

// The best cut of a sorted set: a small separator, near the middle among equals.
Cut bestCut(std::span<const std::int32_t> sorted, DissectionSpace& space) {
  const std::size_t count = sorted.size();
  for (std::size_t i = 0; i < count; ++i) space.place[static_cast<std::size_t>(sorted[i])] = static_cast<std::int32_t>(i);
  findReach(sorted, space);
  // Node i is in the separator of every cut behind it up to its farthest neighbour.
  space.change.assign(count + 1, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const auto reach = static_cast<std::size_t>(std::max<std::int32_t>(space.reach[i], 0));
    if (reach <= i) continue;
    ++space.change[i + 1];
    --space.change[reach + 1];
  }
  const auto size = static_cast<double>(count);
  Cut best;
  std::int32_t separator = 0;
  for (std::size_t k = 0; k < count; ++k) {
    separator += space.change[k];
    const double share = static_cast<double>(k) / size;
    if (share < tuning::kMinDissectionShare || share > 1.0 - tuning::kMinDissectionShare) continue;
    const double cost = (separator + 0.5) * (1.0 + std::abs(2.0 * share - 1.0));
    if (cost < best.cost) best = {k, cost};
  }
  for (const std::int32_t node : sorted) space.place[static_cast<std::size_t>(node)] = -1;
  return best;
}

// Orders a set of nodes in place: those before the best cut, those behind it, and last the separator.
void dissect(std::span<std::int32_t> nodes, std::span<const Vec3> centre, DissectionSpace& space) {
  if (nodes.size() <= tuning::kMaxUncutNodes) return;
  Cut best;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    space.sorted.assign(nodes.begin(), nodes.end());
    sortAlong(axis, centre, space.sorted);
    const Cut cut = bestCut(space.sorted, space);
    if (!(cut.cost < best.cost)) continue;
    best = cut;
    std::swap(space.best, space.sorted);
  }
  for (std::size_t i = 0; i < space.best.size(); ++i)
    space.place[static_cast<std::size_t>(space.best[i])] = static_cast<std::int32_t>(i);
  findReach(space.best, space);
  const auto last = static_cast<std::int32_t>(best.at);
  const auto before = [&](std::size_t i) { return i < best.at && space.reach[i] < last; };
  std::size_t left = 0;
  for (std::size_t i = 0; i < space.best.size(); ++i) {
    if (before(i)) nodes[left++] = space.best[i];
  }
  std::size_t right = left;
  for (std::size_t i = best.at; i < space.best.size(); ++i) nodes[right++] = space.best[i];
  std::size_t end = right;
  for (std::size_t i = 0; i < best.at; ++i) {
    if (!before(i)) nodes[end++] = space.best[i];
  }
  for (const std::int32_t node : nodes) space.place[static_cast<std::size_t>(node)] = -1;
  dissect(nodes.first(left), centre, space);
  dissect(nodes.subspan(left, right - left), centre, space);
}

}  // namespace

void orderBottomUp(EliminationOrder& order) {
  order.nodes.resize(order.centre.size());
  std::iota(order.nodes.begin(), order.nodes.end(), 0);
  sortAlong(2, order.centre, order.nodes);
}

void orderByDissection(std::span<const BlockPair> edges, EliminationOrder& order) {
  order.nodes.resize(order.centre.size());
  std::iota(order.nodes.begin(), order.nodes.end(), 0);
  if (order.space.empty()) order.space.resize(1);
  DissectionSpace& space = order.space.front();
  findNeighbours(edges, order.centre.size(), space);
  space.place.assign(order.centre.size(), -1);
  dissect(order.nodes, order.centre, space);
}

void releaseSpace(EliminationOrder& order) {
  order.centre = std::vector<Vec3>();
  order.space = std::vector<DissectionSpace>();
}

}  // namespace springtower
