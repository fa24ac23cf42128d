#pragma once

#include "core/scene/scene.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// Loads of the contact points of a stack, before anything has moved. A stack: blocks that carry one another, directly or through
/// others, if all fell straight down.
struct StackLoad {
  double contact_n = 0.0;  ///< N, largest load of one contact point between its blocks: the one that the tolerance applies to
  double floor_n = 0.0;    ///< N, largest load of one contact point on the floor, also under the heaviest block of the scene
  double edge_n = 0.0;     ///< N, largest load of one of a block's four upright edges, also under the heaviest block
  double mean_n = 0.0;     ///< N, mean weight of its blocks
  double sway_n_m = 0.0;   ///< N/m, least contact stiffness at which the stack does not buckle under its own weight
};

/// Loads that determine the stiffness of contacts and springs.
struct LoadEstimate {
  std::vector<StackLoad> stacks;
  std::vector<std::int32_t> stackOf;  ///< of each block, [blocks]
  std::vector<double> load_n;         ///< N, of each block: its weight and what the blocks on it pass on, [blocks]
  int layers = 0;                     ///< most blocks on top of one another
  double askewFall_m = 0.0;           ///< m, largest height from which a block that does not lie flat falls onto what is below it

  [[nodiscard]] const StackLoad& of(std::size_t block) const { return stacks[static_cast<std::size_t>(stackOf[block])]; }
};

/// Estimates loads from the blocks' true outlines, so that scenes turned about the vertical, mirrored or listed in another order
/// have the same: every block passes its weight and the load on it to the highest blocks below it (as if all fell straight down),
/// in proportion to the areas of overlap, each share to two of the four corners of an overlap, and more by the lever of tilted
/// gravity. Any block of the scene may come to lie on any other, so the loads of floor and edges are at least those of the
/// heaviest one, unless there is no gravity. Sway is the buckling of a column under its own weight (Greenhill 1881), with the
/// bending stiffness of the overlaps' corners in series with the blocks and a safety factor of ten. O(n log n) for scattered
/// scenes.
LoadEstimate estimateLoads(const Scene& scene);

}  // namespace springtower
