#pragma once

#include "core/vector.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

namespace springtower {

/// Calls visit(i, j) for all intervals that overlap by more than nothing, or lie within `margin` of each other where it is
/// positive (m): i begins no later than j. In the order in which i begins, then j; equal ones by number. One sort, for scenes
/// that are looked at once; frames have their own, which keeps its order (broadphase/sort_and_sweep).
template <class Visit>
void forEachOverlap(std::span<const double> lower, std::span<const double> upper, double margin, const Visit& visit) {
  std::vector<std::size_t> order(lower.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return lower[a] < lower[b]; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double end = upper[order[i]] + margin;
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      if (margin > 0.0 ? lower[order[j]] > end : !(lower[order[j]] < end)) break;
      visit(order[i], order[j]);
    }
  }
}

/// The world's axis along which places are spread most, which leaves the fewest neighbours in a sweep. Places are taken from the
/// first one, so that a scene far from the origin loses no digits. Precondition: at least one place; placeOf(i) is in m.
template <class PlaceOf>
Eigen::Index widestAxis(std::size_t count, const PlaceOf& placeOf) {
  Vec3 sum = Vec3::Zero();
  Vec3 sumOfSquares = Vec3::Zero();
  const Vec3 first = placeOf(std::size_t{0});
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 place = placeOf(i) - first;
    sum += place;
    sumOfSquares += place.cwiseAbs2();
  }
  Eigen::Index widest = 0;
  (sumOfSquares - sum.cwiseAbs2() / static_cast<double>(count)).maxCoeff(&widest);
  return widest;
}

}  // namespace springtower
