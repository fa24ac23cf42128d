// Thin cards that fall on an edge.
#include "core/scene/scene.h"
#include "solver/runner/run.h"
#include "solver/world/simulation.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

constexpr double kLength_m = 0.09;
constexpr double kThickness_m = 5e-4;

// A card that leans by an angle (degrees), its lower edge so high (m) above the floor.
Scene cardOnEdge(double angle_deg, double height_m) {
  Scene scene;
  const double angle = angle_deg * std::numbers::pi / 180.0;
  BlockSpec card;
  card.dimensions = Vec3(kLength_m, 0.06, kThickness_m);
  card.mass = 800.0 * card.dimensions.prod();
  card.orientation = Eigen::AngleAxisd(angle, Vec3::UnitY());
  card.centre.z() = height_m + 0.5 * (kLength_m * std::sin(angle) + kThickness_m * std::cos(angle));
  scene.blocks.push_back(card);
  return scene;
}

// As it rocks to rest it turns by some 0.01 rad in a step, its corners by half a millimetre: as much as it is thick, but it keeps
// its shape. Twelve drops, as each bounces another way.
TEST(ThinCard, ComesToRestAfterItFellOnAnEdge) {
  for (const double angle_deg : {20.0, 25.0, 30.0, 35.0, 40.0, 60.0}) {
    for (const double height_m : {0.3, 0.5}) {
      SCOPED_TRACE(testing::Message() << angle_deg << " degrees, " << height_m << " m");
      Simulation simulation(cardOnEdge(angle_deg, height_m));
      RunOptions options;
      options.seconds = 4.0;
      EXPECT_NO_THROW(runScene(simulation, options));
      EXPECT_NEAR(centre(simulation.state.position, 0).z(), 0.5 * kThickness_m, 5e-5) << "flat on the floor";
    }
  }
}

}  // namespace
}  // namespace springtower
