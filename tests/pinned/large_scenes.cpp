#include "tests/pinned/pinned_scene.h"

#include <cmath>

namespace springtower {
namespace {

constexpr double kWallGap_m = 0.0004;  // between neighbours of a row, so that they do not press each other

// A running bond, with half bricks at the ends of every other row.
Scene wall(int columns, int rows) {
  const double pitch_m = kBlockLength_m + kWallGap_m;
  const double half_m = 0.5 * (kBlockLength_m - kWallGap_m);
  Scene scene;
  const auto lay = [&](double x_m, double length_m, int row) {
    BlockSpec block;
    block.centre = Vec3(x_m, 0.0, (row + 0.5) * kBlockHeight_m);
    block.dimensions.x() = length_m;
    block.mass = kBlockMass_kg * length_m / kBlockLength_m;
    scene.blocks.push_back(block);
  };
  for (int row = 0; row < rows; ++row) {
    const int whole = row % 2 == 0 ? columns : columns - 1;
    for (int i = 0; i < whole; ++i) lay((i - 0.5 * (whole - 1)) * pitch_m, kBlockLength_m, row);
    if (whole == columns) continue;
    const double end_m = 0.5 * (columns * pitch_m - kWallGap_m) - 0.5 * half_m;
    lay(-end_m, half_m, row);
    lay(end_m, half_m, row);
  }
  return scene;
}

// Cubes, each on two.
Scene pyramid(int rows) {
  constexpr double kSide_m = 0.02;
  const double pitch_m = kSide_m + kWallGap_m;
  Scene scene;
  for (int row = 0; row < rows; ++row) {
    for (int i = row; i < rows; ++i) {
      BlockSpec block;
      block.centre = Vec3((i - 0.5 * row - 0.5 * (rows - 1)) * pitch_m, 0.0, (row + 0.5) * kSide_m);
      block.dimensions = Vec3::Constant(kSide_m);
      block.mass = 0.004;
      scene.blocks.push_back(block);
    }
  }
  return scene;
}

// Square rows, each turned by a right angle against the one below and shifted by half a block, so that all of it is one island.
Scene pile(int rows, double fall_m) {
  constexpr int kCells = 6;  // of three blocks side by side, along and across
  const double length_m = 1.002 * kBlockLength_m;
  const double width_m = length_m / 3.0;
  Scene scene;
  for (int row = 0; row < rows; ++row) {
    const bool turned = row % 2 == 1;
    const double shift_m = turned ? 0.5 * length_m : 0.0;
    for (int i = 0; i < kCells * kCells * 3; ++i) {
      const int line = i / (3 * kCells);
      const double along_m = (line + 0.5) * length_m + shift_m;
      const double across_m = (i - 3 * kCells * line + 0.5) * width_m + shift_m;
      BlockSpec block;
      block.centre = Vec3(turned ? across_m : along_m, turned ? along_m : across_m, (row + 0.5) * kBlockHeight_m);
      if (turned) block.orientation = Eigen::Quaterniond(1.0, 0.0, 0.0, 1.0).normalized();
      block.velocity.z() = -std::sqrt(2.0 * scene.gravity.magnitude * fall_m);
      scene.blocks.push_back(block);
    }
  }
  return scene;
}

Scene side(Scene one, int along, int across, double spacing_m) {
  const std::vector<BlockSpec> blocks = std::move(one.blocks);
  one.blocks.clear();
  for (int x = 0; x < along; ++x) {
    for (int y = 0; y < across; ++y) {
      for (BlockSpec block : blocks) {
        block.centre += Vec3(spacing_m * x, spacing_m * y, 0.0);
        one.blocks.push_back(block);
      }
    }
  }
  return one;
}

Scene hundredTowers() {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  options.seed = 3;
  return side(towerScene(2, options), 10, 10, 0.2);
}

// Five full towers end against end, which sway: one island of 270 blocks that bends.
Scene touchingTowers() {
  Scene scene = awake(side(towerScene(18), 5, 1, kBlockLength_m));
  scene.gravity.sway_deg = 0.1;
  scene.gravity.sway_hz = 2.0;
  return scene;
}

Scene landingPile() {
  Scene scene = pile(3, 0.01);
  scene.settings.tolerance_m = 2e-4;
  return scene;
}

// Eight leaning stacks that slide and topple, each an island of its own.
Scene toppling() {
  Scene scene = side(towerScene(4), 4, 2, 0.3);
  scene.gravity.tilt_deg = 30.0;
  return scene;
}

}  // namespace

std::vector<PinnedScene> pinnedLarge() {
  return {
      {"WallOf246", 30, [] { return awake(wall(20, 12)); }},
      {"SmallWallFallsAsleep", 200, [] { return wall(5, 6); }},
      {"PyramidOf10", 60, [] { return awake(pyramid(10)); }},
      {"PyramidFallsAsleep", 200, [] { return pyramid(6); }},
      {"PileLands", 3, landingPile},
      {"PileRests", 20, [] { return awake(pile(3, 0.0)); }},
      {"HundredTowers", 20, hundredTowers},
      {"TouchingTowers", 20, touchingTowers},
      {"TopplingStacks", 40, toppling},
  };
}

}  // namespace springtower
