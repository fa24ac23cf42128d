#pragma once

#include "apps/viewer/view/mesh.h"

#include <cstdint>
#include <vector>

namespace springtower {

/// What is drawn: triangles with light and shadow, and others without: flat on the floor, or over all (arrows).
struct Picture {
  std::vector<Vertex> blocks;
  std::vector<Vertex> ground;
  std::vector<Vertex> marks;
  bool floor = true;
  bool grid = false;              ///< the floor is marked in squares of 2 cm
  std::int32_t highlighted = -1;  ///< a block drawn brighter: what the mouse is over
};

}  // namespace springtower
