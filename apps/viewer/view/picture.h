#pragma once

#include "apps/viewer/view/overlays.h"

#include <cstdint>
#include <vector>

namespace springtower {

/// What is drawn: triangles with light and shadow, and others without (arrows), which lie over all.
struct Picture {
  std::vector<Vertex> blocks;
  std::vector<Vertex> marks;
  bool floor = true;
  std::int32_t highlighted = -1;  ///< a block drawn brighter: what the mouse is over
};

}  // namespace springtower
