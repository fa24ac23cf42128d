// Scenes that start from what a run has left at rest.
#include "core/scene/corners.h"
#include "solver/frame/prepare.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "tests/support/block_scenes.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

namespace springtower {
namespace {

Simulation atRest(const Scene& scene, double seconds) {
  Simulation simulation(scene);
  stepFor(simulation, seconds);
  return simulation;
}

CornerPlaces cornersNow(const Simulation& simulation, std::size_t block) {
  CornerPlaces corners;
  for (std::size_t c = 0; c < kCorners; ++c) corners[c] = simulation.state.position.at(block, c);
  return corners;
}

// The scene with its blocks as they lie now: by their corners, or by the cuboids that fit them.
Scene restarted(const Simulation& simulation, bool strained) {
  Scene scene = simulation.scene;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    placeByCorners(cornersNow(simulation, b), scene.blocks[b]);
    if (!strained) scene.blocks[b].strain.reset();
    scene.blocks[b].velocity.setZero();
    scene.blocks[b].spin.setZero();
  }
  return scene;
}

Scene tiltedTower() {
  Scene scene = towerScene(6);
  scene.gravity.tilt_deg = 8.0;
  scene.gravity.direction_deg = 30.0;
  return scene;
}

Scene unevenTower() {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  return towerScene(6, options);
}

struct RestScene {
  const char* name;
  std::function<Scene()> make;
};

class Restart : public ::testing::TestWithParam<RestScene> {};

// From its corners a tower lies where it lay, within a micrometre, from the first frame on, and is at rest.
TEST_P(Restart, FromCornersStaysWhereItLay) {
  for (const Sleep sleep : {Sleep::on, Sleep::off}) {
    Scene scene = GetParam().make();
    scene.settings.sleep = sleep;
    const Simulation before = atRest(scene, 8.0);
    Simulation simulation(restarted(before, true));
    const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
    EXPECT_LT(largestCornerMove(before.state.position, simulation.state.position), 1e-15);
    const double energy_j = energy(before).total();
    for (int frame = 0; frame < 120; ++frame) {
      prepareAndStep(simulation);
      ASSERT_LT(largestCornerMove(before.state.position, simulation.state.position), 1e-6) << "frame " << frame;
      ASSERT_LT(rootMeanSquareCornerSpeed(simulation.state.velocity), 1e-5) << "frame " << frame;
      ASSERT_LT(energy(simulation).total(), energy_j + 1e-6 * std::abs(energy_j));
    }
    EXPECT_TRUE(standing(simulation.model, start, simulation.state.position).stands);
    EXPECT_LT(rootMeanSquareCornerSpeed(simulation.state.velocity), 1e-9);
  }
}

// From the cuboids alone it returns to its strain: no corner moves farther than springs and contacts deflect.
TEST_P(Restart, FromCuboidsFindsTheRestState) {
  const Simulation before = atRest(GetParam().make(), 8.0);
  Simulation simulation(restarted(before, false));
  for (int frame = 0; frame < 120; ++frame) {
    prepareAndStep(simulation);
    ASSERT_LT(largestCornerMove(before.state.position, simulation.state.position), kBlockTolerance_m) << "frame " << frame;
  }
  EXPECT_LT(rootMeanSquareCornerSpeed(simulation.state.velocity), 1e-9);
  PenetrationWorkspace workspace;
  EXPECT_LT(maxPenetration(simulation.state.position, true, workspace).depth, 2.0 * kBlockTolerance_m);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Restart,
                         ::testing::Values(RestScene{"tower", [] { return towerScene(6); }},
                                           RestScene{"tall", [] { return towerScene(18); }}, RestScene{"tilted", tiltedTower},
                                           RestScene{"uneven", unevenTower}),
                         [](const auto& of) { return std::string(of.param.name); });

// Two blocks that overlap by two tolerances in free space are without force as they lie: nothing throws them apart.
TEST(RestartWithoutLoad, LeavesOverlapsWithoutEnergy) {
  for (const Method method : {Method::implicit, Method::implicitEuler, Method::semiImplicitEuler}) {
    Scene scene = towerScene(1);
    scene.blocks.resize(2);
    scene.blocks[1].centre = scene.blocks[0].centre + Vec3(0.0, 0.0, kBlockHeight_m - 2.0 * kBlockTolerance_m);
    scene.floor = false;
    scene.gravity.magnitude = 0.0;
    scene.settings.method = method;
    scene.settings.sleep = Sleep::off;
    Simulation simulation(scene);
    for (int frame = 0; frame < 30; ++frame) prepareAndStep(simulation);
    EXPECT_LT(rootMeanSquareCornerSpeed(simulation.state.velocity), 1e-6) << nameOf(method);
  }
}

}  // namespace
}  // namespace springtower
