#include "apps/viewer/view/occlusion.h"

#include "core/scene/scene.h"
#include "solver/world/simulation.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

namespace springtower {
namespace {

std::set<int> nearTo(const Nearby& nearby, std::size_t block) {
  std::set<int> found;
  for (std::size_t i = 0; i < Nearby::kMost; ++i) found.insert(nearby.near[Nearby::kMost * block + i]);
  found.erase(-1);
  return found;
}

TEST(ViewerOcclusion, FindsWhatIsNearAndNothingElse) {
  const Simulation simulation(bitCodeScene("(111)-(111)-(111)-(111)"));
  const Nearby nearby = nearbyOf(simulation.state.position);
  ASSERT_EQ(nearby.boxes.size(), 4U * 12U);
  // The lowest row is near the second one and, over its height of 15 mm, the third; not the fourth.
  const std::set<int> found = nearTo(nearby, 1);
  for (const int block : {0, 2, 3, 4, 5}) EXPECT_EQ(found.count(block), 1U) << block;
  for (const int block : {1, 9, 10, 11}) EXPECT_EQ(found.count(block), 0U) << block;
}

TEST(ViewerOcclusion, AGapIsDarkAndAnOpenPlaceIsNot) {
  const Simulation simulation(bitCodeScene("(111)"));
  const Nearby nearby = nearbyOf(simulation.state.position);
  const Vec3 end = simulation.model.dimensions[0];
  Vec3 least = simulation.state.position.at(0, 0);
  for (std::size_t b = 0; b < 3; ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) least = least.cwiseMin(simulation.state.position.at(b, c));
  }
  const auto openAt = [&](double away) {
    double open = 1.0;
    for (std::size_t b = 0; b < 3; ++b) open *= opennessAt(nearby, b, Vec3(least.x() - away, least.y() + 0.5 * end.y(), 0.0));
    return open;
  };
  EXPECT_LT(openAt(0.001), 0.7);
  EXPECT_GT(openAt(0.001), 0.2);
  double before = 0.0;
  for (const double away : {0.001, 0.005, 0.01, 0.02, 0.04}) {
    EXPECT_GT(openAt(away), before) << away;
    before = openAt(away);
  }
  EXPECT_EQ(openAt(kFloorReach_m + 0.001), 1.0);
}

TEST(ViewerOcclusion, TheFloorIsDarkAroundBlocksAlone) {
  const Simulation simulation(bitCodeScene("(111)-(111)"));
  const FloorOpenness floor = floorOpenness(nearbyOf(simulation.state.position), Vec3::Zero(), 0.7);
  ASSERT_EQ(floor.open.size(), FloorOpenness::kCells * FloorOpenness::kCells);
  EXPECT_EQ(floor.open.front(), 255);
  EXPECT_EQ(floor.open.back(), 255);
  EXPECT_LT(*std::min_element(floor.open.begin(), floor.open.end()), 150);
  const auto dark = std::count_if(floor.open.begin(), floor.open.end(), [](std::uint8_t open) { return open < 255; });
  EXPECT_LT(dark, static_cast<std::ptrdiff_t>(floor.open.size()) / 4);
}

}  // namespace
}  // namespace springtower
