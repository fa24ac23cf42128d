#pragma once

#include "core/ids.h"
#include "core/vector.h"

#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// Working space of a dissection; its storage is reused.
struct DissectionSpace {
  std::vector<std::int32_t> neighbourStart;  ///< neighbours of node i are neighbour[neighbourStart[i] .. neighbourStart[i + 1]]
  std::vector<std::int32_t> neighbour;
  std::vector<std::int32_t> sorted;  ///< a set, sorted along an axis
  std::vector<std::int32_t> best;    ///< and along the axis of the best cut
  std::vector<std::int32_t> place;   ///< of each node in `sorted`, -1 outside the set
  std::vector<std::int32_t> reach;   ///< by place: the farthest place of a neighbour
  std::vector<std::int32_t> change;  ///< of the separator's size from cut to cut
};

/// Elimination order of the nodes of an island's matrix.
struct EliminationOrder {
  std::vector<std::int32_t> nodes;     ///< nodes[k] is the k-th to be eliminated
  std::vector<Vec3> centre;            ///< m, of each node's block
  std::vector<DissectionSpace> space;  ///< one, once nodes have been ordered by dissection
};

/// Fills `order.nodes` from the lowest of order.centre to the highest: in a tower the matrix is then a band three blocks wide.
void orderBottomUp(EliminationOrder& order);

/// Fills `order.nodes` by nested dissection (George 1973), for nodes at order.centre coupled by `edges`: a set is sorted along
/// each axis and cut where the fewest nodes before the cut have a neighbour behind it; these form the separator and are
/// eliminated last. The result does not depend on the order of edges.
void orderByDissection(std::span<const BlockPair> edges, EliminationOrder& order);

/// Gives the working space back, and the centres; the order stays.
void releaseSpace(EliminationOrder& order);

}  // namespace springtower
