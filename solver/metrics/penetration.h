#pragma once

#include "core/ids.h"
#include "core/state.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// The deepest penetration of a state: of a block into another, or into the floor (then `second` is kFloor). Without any, depth
/// is 0 and both are kFloor.
struct Penetration {
  double depth = 0.0;  ///< m, >= 0
  BlockId first = kFloor;
  BlockId second = kFloor;
};

/// Storage that maxPenetration reuses from call to call; it has no effect on results.
struct PenetrationWorkspace {
  struct Bounds {
    Vec3 low;
    Vec3 high;
  };
  struct Pair {
    double bound;  ///< m, upper bound of the depth
    std::uint32_t first;
    std::uint32_t second;
  };
  std::vector<Bounds> bounds;        ///< of the corners, [blocks]
  std::vector<std::uint32_t> order;  ///< blocks by their lower bound along `axis`, [blocks]
  Eigen::Index axis = -1;
  std::vector<Pair> pairs;  ///< a binary heap, largest bound first
};

/// Overlap depth of two blocks, m; 0 if they do not overlap. It is the least overlap of the projections of their actual corners,
/// including deformation, over the face normals of both fitted cuboids, the cross products of their edges, and the world's axes.
/// It is never less than the true depth of the two convex hulls, and equals it for undeformed cuboids (separating axis theorem;
/// Gottschalk, Lin & Manocha 1996). A result of at most `worth` may be returned early and is then only an upper bound, at most
/// `worth`.
double overlapDepth(const ParticleArray& position, std::size_t first, std::size_t second, double worth = 0.0);

/// The deepest penetration among all pairs of blocks and, with a floor, of blocks below z = 0; from geometry only, without any
/// slop. Near pairs come from one sort and sweep; pairs are tested in full only if their bounding boxes overlap by more than the
/// deepest pair found so far. `fixed` is [blocks], 1 where a block is fixed, or empty: fixed blocks may lie in one another and in
/// the floor.
Penetration maxPenetration(const ParticleArray& position, bool floor, PenetrationWorkspace& workspace,
                           std::span<const std::uint8_t> fixed = {});

}  // namespace springtower
