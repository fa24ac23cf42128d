// What a rigid block has of its shape.
#include "core/settings.h"
#include "solver/rigid/shapes.h"
#include "solver/world/rigid_island.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// Of a block that is sheared by its contacts the farthest corner bounds how fast its points are, whichever that is.
TEST(RigidMoments, TheRadiusIsThatOfTheFarthestCorner) {
  RigidBody body;
  for (std::size_t c = 0; c < kCorners; ++c) {
    for (std::size_t a = 0; a < 3; ++a) body.corner[a][c] = 0.01 * cornerSide(c, a);
    body.corner[0][c] -= 0.002 * cornerSide(c, 2);
  }
  setMoments(Inertia::cuboid, 0.02, body);
  double farthest = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c)
    farthest = std::max(farthest, std::hypot(body.corner[0][c], body.corner[1][c], body.corner[2][c]));
  EXPECT_DOUBLE_EQ(body.radius_m, farthest);
  EXPECT_GT(farthest, 1.05 * 0.01 * std::sqrt(3.0));
}

}  // namespace
}  // namespace springtower
