#pragma once

#include "core/scene/scene.h"
#include "scenarios/random_draw.h"

#include <cstddef>
#include <vector>

namespace springtower {

/// Sizes and masses of the blocks of one random scene.
struct BlockManner {
  double side_m = 0.0;     ///< about which sides vary
  bool alike = false;      ///< all blocks have the same sides
  Vec3 sides_m;            ///< where they are alike
  double mass_kg = 0.0;    ///< about which masses vary
  double massRatio = 1.0;  ///< the largest that is allowed
};

BlockManner drawBlockManner(RandomDraw& draw);

/// A block of that manner at the origin, not turned, at rest.
BlockSpec drawBlock(RandomDraw& draw, const BlockManner& manner);

// Each of these draws the blocks of one kind of scene, none inside another. `count`: how many, at least 2. `manner` is theirs.

/// A column, a pile or rows of blocks that lie on one another, turned about the vertical alone.
std::vector<BlockSpec> drawStack(RandomDraw& draw, const BlockManner& manner, std::size_t count);

/// Boxes on one another with planks that lean against their upper edges; no more than `count` blocks.
std::vector<BlockSpec> drawPlanks(RandomDraw& draw, const BlockManner& manner, std::size_t count);

/// Blocks turned and thrown at random above the floor, or with `floor` false anywhere, most of them towards the middle.
std::vector<BlockSpec> drawFlying(RandomDraw& draw, const BlockManner& manner, std::size_t count, bool floor);

/// A stack, and one block or two that fly at it.
std::vector<BlockSpec> drawShot(RandomDraw& draw, const BlockManner& manner, std::size_t count);

}  // namespace springtower
