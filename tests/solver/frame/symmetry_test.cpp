#include "core/scene/scene.h"
#include "scenarios/towers.h"
#include "solver/block/inertia.h"
#include "solver/frame/prepare.h"
#include "solver/world/simulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

namespace springtower {
namespace {

// A scene as seen from elsewhere, or with its blocks in another order: where each block's centre of the plain scene is in it.
struct SeenFrom {
  std::string name;
  std::function<Scene(const Scene&)> change;
  std::function<Vec3(const Vec3&)> back;  // of a place
  bool reversed = false;                  // block b is the plain scene's block count - 1 - b
};

Vec3 same(const Vec3& place) {
  return place;
}

Scene turnedAboutZ(Scene scene, double angle) {
  const Eigen::AngleAxisd about(angle, Vec3::UnitZ());
  for (BlockSpec& block : scene.blocks) {
    block.centre = about * block.centre;
    block.orientation = about * block.orientation;
  }
  return scene;
}

// In the plane x = 0. A box that is turned about z by an angle becomes one that is turned by its opposite.
Scene mirroredInX(Scene scene) {
  for (BlockSpec& block : scene.blocks) {
    block.centre.x() *= -1.0;
    block.orientation = block.orientation.conjugate();
  }
  return scene;
}

Scene movedBy(Scene scene, const Vec3& by) {
  for (BlockSpec& block : scene.blocks) block.centre += by;
  return scene;
}

Scene inReverse(Scene scene) {
  std::reverse(scene.blocks.begin(), scene.blocks.end());
  return scene;
}

std::vector<SeenFrom> seenFromElsewhere() {
  constexpr double kAngle = 33.0 * std::numbers::pi / 180.0;
  const Vec3 far(1000.0, -500.0, 0.0);
  return {
      {"turned by 33 degrees", [](const Scene& scene) { return turnedAboutZ(scene, kAngle); },
       [](const Vec3& place) { return Vec3(Eigen::AngleAxisd(-kAngle, Vec3::UnitZ()) * place); }, false},
      {"mirrored", [](const Scene& scene) { return mirroredInX(scene); },
       [](const Vec3& place) { return Vec3(-place.x(), place.y(), place.z()); }, false},
      {"a kilometre away", [far](const Scene& scene) { return movedBy(scene, far); },
       [far](const Vec3& place) { return Vec3(place - far); }, false},
      {"in another order of blocks", [](const Scene& scene) { return inReverse(scene); }, same, true},
  };
}

std::vector<Vec3> endOf(const Scene& scene, int frames) {
  Simulation simulation(scene);
  prepare(simulation);
  for (int frame = 0; frame < frames; ++frame) stepFrame(simulation);
  std::vector<Vec3> centres;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) centres.push_back(centre(simulation.state.position, b));
  return centres;
}

void expectSameEnd(const Scene& scene, double within_m) {
  constexpr int kFrames = 60;
  const std::vector<Vec3> plain = endOf(scene, kFrames);
  const double stiffness = largestStiffness(Simulation(scene).stiffness);
  for (const SeenFrom& view : seenFromElsewhere()) {
    const Scene other = view.change(scene);
    EXPECT_NEAR(largestStiffness(Simulation(other).stiffness), stiffness, 0.01 * stiffness) << view.name;
    const std::vector<Vec3> end = endOf(other, kFrames);
    double farthest = 0.0;
    for (std::size_t b = 0; b < plain.size(); ++b) {
      const std::size_t as = view.reversed ? plain.size() - 1 - b : b;
      farthest = std::max(farthest, (view.back(end[as]) - plain[b]).norm());
    }
    EXPECT_LT(farthest, within_m) << scene.name << ", " << view.name;
  }
}

// Rows that hang over by a few millimetres.
TEST(Symmetry, AShiftedTowerEndsAtTheSamePlaceHoweverItLies) {
  TowerOptions options;
  for (int row = 1; row < 9; ++row) {
    for (int position = 1; position <= 3; ++position) options.offsets.push_back({row, position, 0.0007 * row, -0.0004 * row});
  }
  Scene scene = towerScene(9, options);
  scene.settings.sleep = Sleep::off;
  expectSameEnd(scene, 1e-6);
}

// Within a fifth of the tolerance of 0.05 mm.
TEST(Symmetry, UnevenRowsEndAtTheSamePlaceHoweverTheyLie) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Scene scene = towerScene(18, {.heightsSigma_m = 0.0002, .seed = seed});
    scene.settings.sleep = Sleep::off;
    expectSameEnd(scene, 1e-5);
  }
}

}  // namespace
}  // namespace springtower
