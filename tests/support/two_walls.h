#pragma once

#include "core/scene/scene.h"
#include "scenarios/walls.h"

namespace springtower {

/// Two walls of 294 blocks a metre apart: wide islands, whose kernels take ranges, side by side.
inline Scene twoWalls() {
  Scene scene = wallScene(24, 12);
  for (BlockSpec block : wallScene(24, 12).blocks) {
    block.centre.y() += 1.0;
    scene.blocks.push_back(block);
  }
  return scene;
}

}  // namespace springtower
