#include "core/scene/scene.h"
#include "solver/metrics/measures.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace springtower {
namespace {

// A block on its narrow base that rocks about its edges (Housner 1963).
struct Rocking {
  double width_m;
  double height_m;
  [[nodiscard]] double radius_m() const { return 0.5 * std::hypot(width_m, height_m); }
  [[nodiscard]] double corner() const { return std::atan(width_m / height_m); }              ///< rad, angle at which it topples
  [[nodiscard]] double kept() const { return 1.0 - 1.5 * std::pow(std::sin(corner()), 2); }  ///< share of the spin, a hit
};

// Times at which it stands upright, released at rest from `share` of the corner, by integration of the pendulum's equation with
// steps of 10 us (midpoint: 1e-9 s).
std::vector<double> crossings(const Rocking& block, double share, int count) {
  const double square = 0.75 * kStandardGravity_m_s2 / block.radius_m();
  constexpr double kStep_s = 1e-5;
  std::vector<double> times;
  double angle = share * block.corner();
  double spin = 0.0;
  const auto pull = [&](double at) { return -square * std::sin(block.corner() - at); };
  for (double t = 0.0; times.size() < static_cast<std::size_t>(count); t += kStep_s) {
    const double middle = angle + 0.5 * kStep_s * spin;
    const double faster = spin + kStep_s * pull(middle);
    const double next = angle + 0.5 * kStep_s * (spin + faster);
    spin = faster;
    angle = next;
    if (angle > 0.0) continue;
    times.push_back(t + kStep_s);
    spin = -spin * block.kept();
    angle = 0.0;
  }
  return times;
}

Scene released(const Rocking& block, double share) {
  Scene scene;
  scene.settings.sleep = Sleep::off;
  scene.settings.frame_s = 1.0 / 240.0;
  scene.staticFriction = scene.kineticFriction = 0.8;
  scene.restitution = 0.0;
  BlockSpec spec;
  spec.dimensions = {block.width_m, 2.0 * block.width_m, block.height_m};
  const double angle = share * block.corner();
  spec.orientation = Eigen::AngleAxisd(angle, Vec3::UnitY());
  const double lean = block.corner() - angle;
  spec.centre = {-block.radius_m() * std::sin(lean), 0.0, block.radius_m() * std::cos(lean)};
  scene.blocks.push_back(spec);
  return scene;
}

struct RockingTest : ::testing::TestWithParam<Method> {};

// Without rebound every hit keeps the spin about the new edge that angular momentum leaves: 3 % on the fifth crossing. Implicit
// steps at 3 um: the depth of the edges at the default tolerance is a twentieth of the height by which the centre falls.
TEST_P(RockingTest, LosesWhatHousnerSays) {
  for (const Rocking block : {Rocking{0.015, 0.075}, Rocking{0.03, 0.12}}) {
    Scene scene = released(block, 0.6);
    scene.settings.method = GetParam();
    if (GetParam() == Method::implicit) scene.settings.tolerance_m = 3e-6;
    const std::vector<double> expected = crossings(block, 0.6, 5);
    Simulation simulation(scene);
    std::vector<double> found;
    double lean = meanEdge(simulation.state.position, 0, 2).x();
    while (found.size() < 5 && simulation.time_s < 3.0) {
      prepareAndStep(simulation);
      const double now = meanEdge(simulation.state.position, 0, 2).x();
      // The crossing between two frames, linearly; the lean is noted where it is beyond rounding.
      if (now * lean < 0.0)
        found.push_back(simulation.time_s - scene.settings.frame_s * std::abs(now) / (std::abs(now) + std::abs(lean)));
      lean = now;
    }
    ASSERT_EQ(found.size(), 5U) << block.width_m << " wide";
    EXPECT_NEAR(found[0], expected[0], 0.01 * expected[0]);
    EXPECT_NEAR(found[4], expected[4], 0.03 * expected[4]);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, RockingTest, ::testing::Values(Method::implicit, Method::rigidPgs),
                         [](const auto& test) { return test.param == Method::implicit ? "implicit" : "rigidPgs"; });

}  // namespace
}  // namespace springtower
