#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// Stiffness of the contacts and springs of every block, N/m, all [blocks]. Part of the model: set once, from the loads that are
/// expected (solver/world/stiffness).
struct BlockStiffness {
  std::vector<double> stack_n_m;  ///< of one between blocks of the stack in which this block stands; 0 for a fixed block
  std::vector<double> floor_n_m;  ///< of one on the floor, which has fewer points: a tower's block rests on three others
  std::vector<double> edge_n_m;   ///< of an upright edge as long as the scene's least block is high
  /// What a block is to bear, itself included, over the mean weight of its stack's blocks, at most 1; empty where it is 1 for
  /// all. Of a light block among heavy ones it is less, and so is what its smoothed contacts bear (ContactStep::smoothing_j).
  std::vector<double> loadShare;
};

/// Stiffness of a contact point of two blocks, N/m, normal; `lower` is negative for the floor. Between two stacks the stiffer of
/// theirs: one may come to lie on the other. On a fixed block that on the floor.
inline double pairStiffness(const BlockStiffness& of, std::int32_t upper, std::int32_t lower) {
  const auto a = static_cast<std::size_t>(upper);
  if (lower < 0) return of.floor_n_m[a];
  const auto b = static_cast<std::size_t>(lower);
  const double ofA = of.stack_n_m[a];
  const double ofB = of.stack_n_m[b];
  if (std::min(ofA, ofB) > 0.0) return std::max(ofA, ofB);
  return ofA > 0.0 ? of.floor_n_m[a] : of.floor_n_m[b];
}

/// Share of a contact in the smoothing: the lesser one of its blocks; `lower` is negative for the floor.
inline double smoothingShare(const BlockStiffness& of, std::int32_t upper, std::int32_t lower) {
  if (of.loadShare.empty()) return 1.0;
  const double ofUpper = of.loadShare[static_cast<std::size_t>(upper)];
  return lower < 0 ? ofUpper : std::min(ofUpper, of.loadShare[static_cast<std::size_t>(lower)]);
}

/// Largest of the stiffnesses of blocks, N/m; 0 where there are none.
inline double largest(const std::vector<double>& stiffness_n_m) {
  return stiffness_n_m.empty() ? 0.0 : *std::max_element(stiffness_n_m.begin(), stiffness_n_m.end());
}

/// Largest stiffness of any contact point between blocks, N/m.
inline double largestStiffness(const BlockStiffness& of) {
  return largest(of.stack_n_m);
}

}  // namespace springtower
