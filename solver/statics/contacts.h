#pragma once

#include "core/ids.h"
#include "core/scene/scene.h"

#include <vector>

namespace springtower {

/// A corner of the area in which two blocks face each other, and their gap there.
struct FacingPoint {
  Vec3 place = Vec3::Zero();  ///< m, on the upper block
  double gap_m = 0.0;         ///< m, along the normal; 0 where they touch
};

/// Two blocks, or a block and the floor, that touch or would touch after a small settlement.
struct FacePair {
  BlockId upper = kFloor;
  BlockId lower = kFloor;
  Vec3 normal = Vec3::UnitZ();      ///< unit, from lower to upper
  std::vector<FacingPoint> points;  ///< corners of the overlap of the two faces (4 for a rectangle), or the crossing of two edges
};

/// Contacts and potential contacts of a scene's blocks, rigid and as placed: for every pair (and every block with the floor) the
/// points of the best separating axis of two cuboids (Gottschalk, Lin & Manocha 1996): a face clipped by the other, or the
/// crossing of two edges. Includes points with a gap of at most a few millionths of the block, and, where one block lies over the
/// other (the normal is within 30 degrees of upright), also points with a gap of up to `reach_m`; gaps between neighbours side by
/// side are never included. Faces that overlap by less than a millionth of a block do not touch. Ordered by upper and lower
/// block. Overlaps within the limit of checkScene count as gap 0.
std::vector<FacePair> facingBlocks(const Scene& scene, double reach_m);

}  // namespace springtower
