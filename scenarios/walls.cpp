#include "scenarios/walls.h"

#include <cmath>

namespace springtower {
namespace {

constexpr int kPileCells = 6;  // of three blocks side by side, in both directions
static_assert(kPileRowBlocks == kPileCells * kPileCells * 3);
constexpr double kPileFit = 1.002;  // spacing of the blocks of a row, in their lengths

// `extent_m`: of a block along the pyramid.
Scene pyramidOf(const BlockSpec& brick, double extent_m, int rows) {
  const double pitch_m = extent_m + kWallGap_m;
  Scene scene;
  for (int row = 0; row < rows; ++row) {
    for (int i = row; i < rows; ++i) {
      BlockSpec block = brick;
      block.centre = Vec3((i - 0.5 * row - 0.5 * (rows - 1)) * pitch_m, 0.0, (row + 0.5) * brick.dimensions.z());
      scene.blocks.push_back(block);
    }
  }
  return scene;
}

}  // namespace

Scene wallScene(int columns, int courses) {
  const double pitch_m = kBlockLength_m + kWallGap_m;
  const double half_m = 0.5 * (kBlockLength_m - kWallGap_m);
  Scene scene;
  const auto lay = [&](double x_m, double length_m, int course) {
    BlockSpec block;
    block.centre = Vec3(x_m, 0.0, (course + 0.5) * kBlockHeight_m);
    block.dimensions.x() = length_m;
    block.mass = kBlockMass_kg * length_m / kBlockLength_m;
    scene.blocks.push_back(block);
  };
  for (int course = 0; course < courses; ++course) {
    const int whole = course % 2 == 0 ? columns : columns - 1;
    for (int i = 0; i < whole; ++i) lay((i - 0.5 * (whole - 1)) * pitch_m, kBlockLength_m, course);
    if (whole == columns) continue;
    const double end_m = 0.5 * (columns * pitch_m - kWallGap_m) - 0.5 * half_m;
    lay(-end_m, half_m, course);
    lay(end_m, half_m, course);
  }
  return scene;
}

Scene pyramidScene(int rows) {
  return pyramidOf({}, kBlockLength_m, rows);
}

Scene brickPyramidScene(int rows) {
  BlockSpec brick;
  brick.orientation = Eigen::Quaterniond(1.0, 0.0, 0.0, 1.0).normalized();  // a right angle about z
  return pyramidOf(brick, kBlockWidth_m, rows);
}

Scene cubePyramidScene(int rows, double mass_kg) {
  BlockSpec cube;
  cube.dimensions = Vec3::Constant(kCubeSide_m);
  cube.mass = mass_kg;
  return pyramidOf(cube, kCubeSide_m, rows);
}

Scene pileScene(int rows, const PileStart& start) {
  const double length_m = kPileFit * kBlockLength_m;
  const double width_m = length_m / 3.0;
  Scene scene;
  for (int row = 0; row < rows; ++row) {
    const bool turned = row % 2 == 1;
    const double shift_m = turned ? 0.5 * length_m : 0.0;
    for (int i = 0; i < kPileCells * kPileCells * 3; ++i) {
      const int line = i / (3 * kPileCells);
      const double along_m = (line + 0.5) * length_m + shift_m;
      const double across_m = (i - 3 * kPileCells * line + 0.5) * width_m + shift_m;
      BlockSpec block;
      block.centre = Vec3(turned ? across_m : along_m, turned ? along_m : across_m, (row + 0.5) * kBlockHeight_m);
      if (turned) block.orientation = start.turn;
      block.velocity.z() = -std::sqrt(2.0 * scene.gravity.magnitude * start.fall_m);
      scene.blocks.push_back(block);
    }
  }
  return scene;
}

}  // namespace springtower
