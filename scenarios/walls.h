#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// Between neighbours of a course, so that they do not press each other, m.
inline constexpr double kWallGap_m = 0.0004;
/// The cubes of a pyramid: side, m, and mass, kg.
inline constexpr double kCubeSide_m = 0.02;
inline constexpr double kCubeMass_kg = 0.004;

/// A wall of the game's blocks in running bond, along x, with half blocks at the ends of every other course. Precondition: both
/// numbers are positive.
Scene wallScene(int columns, int courses);

/// A pyramid of game blocks along x, each on two but for the lowest row of `rows` blocks.
Scene pyramidScene(int rows);

/// The same of cubes of kCubeSide_m, whose mass is given in kg.
Scene cubePyramidScene(int rows, double mass_kg = kCubeMass_kg);

/// Blocks in a row of a pile.
inline constexpr int kPileRowBlocks = 108;

/// How a pile begins.
struct PileStart {
  double fall_m = 0.0;  ///< m, what it has fallen through when it lands, which it is about to
  /// By which the blocks of every other row are turned: a right angle about z. Rounded otherwise it is another scene in its last
  /// bits.
  Eigen::Quaterniond turn = Eigen::Quaterniond(1.0, 0.0, 0.0, 1.0).normalized();
};

/// Square rows of kPileRowBlocks, each turned by a right angle against the one below and shifted by half a block, so that all of
/// it is one island. Nothing holds its blocks together but their weight. They have no place in a tower's rows.
Scene pileScene(int rows, const PileStart& start = {});

}  // namespace springtower
