#pragma once

#include "narrowphase/manifold.h"
#include "solver/world/island_step.h"

#include <array>
#include <vector>

namespace springtower {

/// The state of an island at rest within the search for its equilibrium, so that the search can return to it. (The checkpoint of
/// the frame holds the blocks as placed.)
class SavedIsland {
 public:
  explicit SavedIsland(const IslandStep& step);
  void restore(IslandStep& step) const;

 private:
  struct Block {
    std::array<Vec3, kCorners> position;
    BlockHistory history;
  };
  struct Pair {
    PairPhase phase;
    double clearance;
    double travelAtCheck;
    Vec3 axis;
    Manifold manifold;  // of touching pairs
  };
  double smoothing_j_;
  std::vector<Block> blocks_;
  std::vector<Pair> pairs_;
};

}  // namespace springtower
