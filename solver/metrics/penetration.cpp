#include "solver/metrics/penetration.h"

#include "core/geometry/oriented_box.h"
#include "core/geometry/sweep.h"
#include "core/tuning.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace springtower {
namespace {

using Corners = Eigen::Array<double, kCorners, 1>;
using Bounds = PenetrationWorkspace::Bounds;
using Pair = PenetrationWorkspace::Pair;

Corners corners(const ParticleArray& position, std::size_t block, std::size_t axis) {
  return Eigen::Map<const Corners>(position.values(axis, block));
}

// A block's corners as arrays for projections.
struct Hull {
  std::array<Corners, 3> component;

  Hull(const ParticleArray& position, std::size_t block)
      : component{corners(position, block, 0), corners(position, block, 1), corners(position, block, 2)} {}
  [[nodiscard]] Corners along(const Vec3& axis) const {
    return axis.x() * component[0] + axis.y() * component[1] + axis.z() * component[2];
  }
};

// Least displacement of the second along the unit axis, in either direction, that separates it from the first.
double overlapAlong(const Hull& first, const Hull& second, const Vec3& axis) {
  const Corners a = first.along(axis);
  const Corners b = second.along(axis);
  return std::min(a.maxCoeff() - b.minCoeff(), b.maxCoeff() - a.minCoeff());
}

double boxOverlap(const Bounds& a, const Bounds& b) {
  return (a.high - b.low).cwiseMin(b.high - a.low).minCoeff();
}

void findBounds(const ParticleArray& position, std::vector<Bounds>& bounds) {
  bounds.resize(position.blockCount());
  for (std::size_t b = 0; b < bounds.size(); ++b) {
    for (std::size_t a = 0; a < 3; ++a) {
      const Corners values = corners(position, b, a);
      bounds[b].low[static_cast<Eigen::Index>(a)] = values.minCoeff();
      bounds[b].high[static_cast<Eigen::Index>(a)] = values.maxCoeff();
    }
  }
}

void sortBlocks(PenetrationWorkspace& workspace) {
  const auto& bounds = workspace.bounds;
  auto& order = workspace.order;
  const Eigen::Index axis = widestAxis(bounds.size(), [&](std::size_t b) { return bounds[b].low; });
  const auto before = [&](std::uint32_t a, std::uint32_t b) { return bounds[a].low[axis] < bounds[b].low[axis]; };
  if (order.size() != bounds.size() || axis != workspace.axis) {
    order.resize(bounds.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), before);
    workspace.axis = axis;
    return;
  }
  // The order changes little from frame to frame: insertion sort is nearly one pass.
  for (std::size_t i = 1; i < order.size(); ++i) {
    const std::uint32_t block = order[i];
    std::size_t k = i;
    for (; k > 0 && before(block, order[k - 1]); --k) order[k] = order[k - 1];
    order[k] = block;
  }
}

void findPairs(PenetrationWorkspace& workspace, std::span<const std::uint8_t> fixed) {
  const auto& bounds = workspace.bounds;
  const auto& order = workspace.order;
  workspace.pairs.clear();
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Bounds& box = bounds[order[i]];
    const double end = box.high[workspace.axis];
    for (std::size_t k = i + 1; k < order.size() && bounds[order[k]].low[workspace.axis] < end; ++k) {
      if (!fixed.empty() && fixed[order[i]] != 0 && fixed[order[k]] != 0) continue;
      const double bound = boxOverlap(box, bounds[order[k]]);
      if (bound > 0.0) workspace.pairs.push_back({bound, std::min(order[i], order[k]), std::max(order[i], order[k])});
    }
  }
}

}  // namespace

double overlapDepth(const ParticleArray& position, std::size_t first, std::size_t second, double worth) {
  const Hull a(position, first);
  const Hull b(position, second);
  const FittedBox boxA = fittedBox(position, first);
  const FittedBox boxB = fittedBox(position, second);
  double depth = std::numeric_limits<double>::infinity();
  // Whether the pair may still be deeper than `worth`.
  const auto stillDeep = [&](const Vec3& axis) {
    depth = std::min(depth, overlapAlong(a, b, axis));
    return depth > worth;
  };
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (!stillDeep(Vec3::Unit(k))) return std::max(depth, 0.0);
  }
  for (const FittedBox* box : {&boxA, &boxB}) {
    for (const Vec3& axis : box->axis) {
      if (!stillDeep(axis)) return std::max(depth, 0.0);
    }
  }
  forEachEdgeProduct([&](int i) { return boxA.axis[static_cast<std::size_t>(i)]; },
                     [&](int j) { return boxB.axis[static_cast<std::size_t>(j)]; }, tuning::kPenetrationParallelSine,
                     [&](int, int, const Vec3& axis) { return stillDeep(axis); });
  return std::max(depth, 0.0);
}

Penetration maxPenetration(const ParticleArray& position, bool floor, PenetrationWorkspace& workspace,
                           std::span<const std::uint8_t> fixed) {
  Penetration deepest;
  if (position.blockCount() == 0) return deepest;
  findBounds(position, workspace.bounds);
  if (floor) {
    for (std::size_t b = 0; b < workspace.bounds.size(); ++b) {
      if (!fixed.empty() && fixed[b] != 0) continue;
      if (-workspace.bounds[b].low.z() > deepest.depth) deepest = {-workspace.bounds[b].low.z(), blockId(b), kFloor};
    }
  }
  sortBlocks(workspace);
  findPairs(workspace, fixed);

  // The pair with the largest bound first, block numbers as a tie breaker; ends when no pair can be deeper than the deepest.
  auto& pairs = workspace.pairs;
  const auto later = [](const Pair& a, const Pair& b) {
    if (a.bound != b.bound) return a.bound < b.bound;
    return a.first != b.first ? a.first > b.first : a.second > b.second;
  };
  std::make_heap(pairs.begin(), pairs.end(), later);
  while (!pairs.empty() && pairs.front().bound > deepest.depth) {
    const Pair pair = pairs.front();
    std::pop_heap(pairs.begin(), pairs.end(), later);
    pairs.pop_back();
    const double depth = overlapDepth(position, pair.first, pair.second, deepest.depth);
    if (depth > deepest.depth) deepest = {depth, blockId(pair.first), blockId(pair.second)};
  }
  return deepest;
}

}  // namespace springtower
