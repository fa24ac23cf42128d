#pragma once

#include "core/ids.h"
#include "core/state.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// The deepest penetration of a state: of a block into another, or into the floor (then `second` is kFloor). Without any, depth
/// is 0 and both are kFloor.
struct Penetration {
  double depth = 0.0;  ///< m, >= 0
  BlockId first = kFloor;
  BlockId second = kFloor;
};

/// Memory that maxPenetration uses again from call to call; nothing in it changes a result.
struct PenetrationWorkspace {
  struct Bounds {
    Vec3 low;
    Vec3 high;
  };
  struct Pair {
    double bound;  ///< the depth is no more than this, m
    std::uint32_t first;
    std::uint32_t second;
  };
  std::vector<Bounds> bounds;        ///< of the corners, [blocks]
  std::vector<std::uint32_t> order;  ///< blocks by their lower bound along `axis`, [blocks]
  Eigen::Index axis = -1;
  std::vector<Pair> pairs;  ///< a heap, largest bound first
};

/// How deep two blocks overlap, m; 0 when they do not. The least overlap of the projections of their actual corners, so that
/// deformation counts, over the face normals of both fitted cuboids, the cross products of their edges, and the world's axes. It
/// is never less than the true depth of the two convex hulls; it is that depth when the blocks are undeformed cuboids (separating
/// axis theorem; Gottschalk, Lin & Manocha 1996). A result of at most `worth` may be returned early and is then only known to be
/// at most `worth`.
double overlapDepth(const ParticleArray& position, std::size_t first, std::size_t second, double worth = 0.0);

/// The deepest penetration among all pairs of blocks and, with a floor, of blocks below z = 0; from geometry alone, without any
/// slop. Near pairs come from one sort and sweep; only those are tested in full whose bounding boxes overlap by more than the
/// deepest pair found so far.
Penetration maxPenetration(const ParticleArray& position, bool floor, PenetrationWorkspace& workspace);

}  // namespace springtower
