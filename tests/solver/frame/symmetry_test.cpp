#include "core/scene/scene.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"
#include "solver/block/inertia.h"
#include "solver/frame/prepare.h"
#include "solver/metrics/measures.h"
#include "solver/world/simulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace springtower {
namespace {

// A scene as seen from elsewhere, or with its blocks in another order: where each block's centre of the plain scene is in it.
struct SeenFrom {
  std::string name;
  std::function<Scene(const Scene&)> change;
  std::function<Vec3(const Vec3&)> back;                            // of a place
  std::function<std::vector<std::size_t>(std::size_t)> order = {};  // of the plain scene's blocks in it, by their number
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

std::vector<std::size_t> reversed(std::size_t count) {
  std::vector<std::size_t> order(count);
  for (std::size_t b = 0; b < count; ++b) order[b] = count - 1 - b;
  return order;
}

std::vector<std::size_t> shuffled(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
  return order;
}

// Its block b is the given scene's block order[b].
Scene inOrder(const Scene& scene, const std::vector<std::size_t>& order) {
  Scene other = scene;
  for (std::size_t b = 0; b < order.size(); ++b) other.blocks[b] = scene.blocks[order[b]];
  return other;
}

SeenFrom turnedBy(double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180.0;
  return {"turned by " + std::to_string(angle_deg) + " degrees",
          [angle](const Scene& scene) { return turnedAboutZ(scene, angle); },
          [angle](const Vec3& place) { return Vec3(Eigen::AngleAxisd(-angle, Vec3::UnitZ()) * place); }};
}

SeenFrom listedBy(const std::string& name, const std::function<std::vector<std::size_t>(std::size_t)>& order) {
  return {name, [order](const Scene& scene) { return inOrder(scene, order(scene.blocks.size())); }, same, order};
}

std::vector<SeenFrom> seenFromElsewhere() {
  const Vec3 far(1000.0, -500.0, 0.0);
  return {turnedBy(17.0),
          turnedBy(33.0),
          turnedBy(123.0),
          {"mirrored", [](const Scene& scene) { return mirroredInX(scene); },
           [](const Vec3& place) { return Vec3(-place.x(), place.y(), place.z()); }},
          {"a kilometre away", [far](const Scene& scene) { return movedBy(scene, far); },
           [far](const Vec3& place) { return Vec3(place - far); }},
          listedBy("in reverse", reversed),
          listedBy("shuffled", [](std::size_t count) { return shuffled(count, 1); }),
          listedBy("shuffled again", [](std::size_t count) { return shuffled(count, 2); })};
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
      const std::size_t as = view.order ? view.order(plain.size())[b] : b;
      farthest = std::max(farthest, (view.back(end[b]) - plain[as]).norm());
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

TEST(Symmetry, WallsAndPyramidsEndAtTheSamePlaceHoweverTheyLie) {
  for (Scene scene : {wallScene(10, 8), brickPyramidScene(12), cubePyramidScene(12)}) {
    scene.settings.sleep = Sleep::off;
    expectSameEnd(scene, 1e-5);
  }
}

// Towers near the slope at which they fall, in any order of their blocks, and turned about the vertical together with gravity's
// direction: the verdict is the same.
TEST(Symmetry, VerdictsAreTheSameHoweverATowerLies) {
  constexpr int kFrames = 90;
  const auto stands = [](const Scene& scene) {
    Simulation simulation(scene);
    const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
    prepare(simulation);
    for (int frame = 0; frame < kFrames; ++frame) stepFrame(simulation);
    return standing(simulation.model, start, simulation.state.position).stands;
  };
  for (const auto& [tilt_deg, expected] : {std::pair(12.5, true), std::pair(16.0, false)}) {
    for (const std::uint64_t seed : {1U, 2U}) {
      Scene scene = towerScene(18, {.heightsSigma_m = 0.00005, .seed = seed});
      scene.gravity.tilt_deg = tilt_deg;
      EXPECT_EQ(stands(scene), expected) << tilt_deg << " degrees, seed " << seed;
      for (const std::uint64_t order : {1U, 2U, 3U})
        EXPECT_EQ(stands(inOrder(scene, shuffled(scene.blocks.size(), order))), expected)
            << tilt_deg << " degrees, order " << order;
      for (const double turned_deg : {17.0, 123.0}) {
        Scene turned = turnedAboutZ(scene, turned_deg * std::numbers::pi / 180.0);
        turned.gravity.direction_deg += turned_deg;
        EXPECT_EQ(stands(turned), expected) << tilt_deg << " degrees, turned by " << turned_deg;
      }
    }
  }
}

}  // namespace
}  // namespace springtower
