#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// Where a block's eight corners start, m, in the order of core/block.h: those of its cuboid, and its strain.
CornerPlaces cornersOf(const BlockSpec& block);

/// Gives a block the centre, the orientation and the strain that its corners have there (m, in the order of core/block.h, which
/// is that of `run --poses`): the cuboid of its dimensions that fits them best (least squares; Kabsch 1976), and what they differ
/// from it. checkScene refuses corners that are far from any such cuboid.
void placeByCorners(const CornerPlaces& corners, BlockSpec& block);

}  // namespace springtower
