#pragma once

#include "apps/viewer/view/mesh.h"
#include "apps/viewer/view/occlusion.h"

#include <cstdint>
#include <vector>

namespace springtower {

/// What is drawn: triangles with light and shadow, and others without: flat on the floor, or over all (arrows).
struct Picture {
  std::vector<Vertex> blocks;
  Nearby nearby;              ///< of the blocks
  FloorOpenness floorOpen;    ///< of the floor
  Vec3 table = Vec3::Zero();  ///< m, the middle of the table's top
  double tableRadius = 1.0;   ///< m
  std::vector<Vertex> ground;
  std::vector<Vertex> marks;
  bool floor = true;
  bool grid = false;              ///< the floor is marked in squares of 2 cm
  std::int32_t highlighted = -1;  ///< a block drawn brighter: what the mouse is over
};

}  // namespace springtower
