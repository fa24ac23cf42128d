// Blocks that slide over others: a seam between two of these is no obstacle, a step is one.
#include "core/scene/scene.h"
#include "core/tuning.h"
#include "solver/frame/prepare.h"
#include "solver/world/simulation.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <numbers>

namespace springtower {
namespace {

constexpr double kSeamGap_m = 4.5e-4;
constexpr double kSeamFriction = 0.4;
constexpr int kSeamRow = 16;

// Blocks that lie side by side with gaps, and another on the second of them that slides along the row, turned by an angle about
// z. `step_m`: by how much the blocks from the fourth on are higher.
Scene rowWithSlider(double speed_m_s, double turn_rad, double step_m) {
  Scene scene;
  scene.settings.sleep = Sleep::off;
  scene.staticFriction = scene.kineticFriction = kSeamFriction;
  const Vec3 size(kBlockWidth_m, kBlockLength_m, kBlockHeight_m);
  for (int i = 0; i < kSeamRow; ++i) {
    BlockSpec block;
    block.dimensions = size;
    if (i >= 3) block.dimensions.z() += step_m;
    block.centre = {i * (size.x() + kSeamGap_m), 0.0, 0.5 * block.dimensions.z()};
    scene.blocks.push_back(block);
  }
  BlockSpec slider;
  slider.dimensions = size;
  slider.centre = {size.x() + kSeamGap_m, 0.0, 1.5 * size.z()};
  slider.orientation = Eigen::AngleAxisd(turn_rad, Vec3::UnitZ());
  slider.velocity.x() = speed_m_s;
  scene.blocks.push_back(slider);
  return scene;
}

// How far it slides, m.
double way(const Scene& scene) {
  Simulation simulation(scene);
  prepare(simulation);
  for (int frame = 0; frame < 60; ++frame) stepFrame(simulation);
  return centre(simulation.state.position, kSeamRow).x() - scene.blocks.back().centre.x();
}

TEST(Seams, DoNotStopWhatSlidesOverThem) {
  for (const double tolerance_m : {5e-5, 1e-5}) {
    for (const double turn_deg : {0.0, 2.0, 20.0}) {
      for (const double speed_m_s : {0.3, 0.6, 1.0}) {
        SCOPED_TRACE(testing::Message() << speed_m_s << " m/s, turned by " << turn_deg << " degrees, " << tolerance_m << " m");
        Scene scene = rowWithSlider(speed_m_s, turn_deg * std::numbers::pi / 180.0, 0.0);
        scene.settings.tolerance_m = tolerance_m;
        const double expected = speed_m_s * speed_m_s / (2.0 * kSeamFriction * scene.gravity.magnitude);
        EXPECT_NEAR(way(scene), expected, 0.04 * expected) << "as on a floor";
      }
    }
  }
}

// What is higher by ten tolerances is a wall: it stops there, 13 mm farther on than the seam of the third and fourth block
// begins.
TEST(Seams, OfUnequalBlocksDo) {
  const Scene scene = rowWithSlider(0.6, 0.0, 5e-4);
  EXPECT_LT(way(scene), 1.1 * kBlockWidth_m);
}

}  // namespace
}  // namespace springtower
