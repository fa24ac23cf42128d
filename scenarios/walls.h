#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// Gap between neighbours of a course, so that they do not press each other, m.
inline constexpr double kWallGap_m = 0.0004;
/// The cubes of a pyramid: side, m, and mass, kg.
inline constexpr double kCubeSide_m = 0.02;
inline constexpr double kCubeMass_kg = 0.004;

/// A wall of the game's blocks in running bond, along x, with half blocks at the ends of every other course. Precondition: both
/// numbers are positive.
Scene wallScene(int columns, int courses);

/// A pyramid of game blocks along x, each on two others except for the lowest row of `rows` blocks.
Scene pyramidScene(int rows);

/// The same with the blocks turned by a right angle, so that their lengths lie across the pyramid and their widths along it.
Scene brickPyramidScene(int rows);

/// The same as `pyramidScene` with cubes of kCubeSide_m of the given mass, kg.
Scene cubePyramidScene(int rows, double mass_kg = kCubeMass_kg);

/// Number of blocks in a row of a pile.
inline constexpr int kPileRowBlocks = 108;

/// Height through which the pile that has a name, is charted and is profiled has fallen when it lands, m.
inline constexpr double kPileFall_m = 0.1;

/// Initial state of a pile.
struct PileStart {
  double fall_m = 0.0;  ///< m, height through which it has fallen when it lands, which is about to happen
  /// Rotation of the blocks of every other row: a right angle about z. Another rounding of it gives a scene that differs in its
  /// last bits.
  Eigen::Quaterniond turn = Eigen::Quaterniond(1.0, 0.0, 0.0, 1.0).normalized();
};

/// Square rows of kPileRowBlocks, each rotated by a right angle relative to the one below and shifted by half a block, so that
/// everything is one island. Only their weight holds the blocks together. They are not assigned to rows of a tower.
Scene pileScene(int rows, const PileStart& start = {});

}  // namespace springtower
