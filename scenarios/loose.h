#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// One block of the game without sleep, flat on the floor if there is one.
Scene oneBlockScene(bool floor);

/// A block that is dropped: its centre is `height_m` above the floor, m, with this orientation. Precondition: it does not reach
/// into the floor.
Scene droppedBlockScene(double height_m, const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());

/// An orientation in which a dropped block hits the floor with a corner.
Eigen::Quaterniond ontoACorner();

/// A block on a slope: gravity is tilted by `tilt_deg` towards `direction_deg`, degrees from +x over +y.
Scene blockOnSlopeScene(double tilt_deg, double direction_deg);

/// The block of scenes/block_on_slope.toml: the slope is 1 % below the angle of friction.
Scene steepSlopeScene();

/// A block that slides over the floor at 0.7 m/s until friction stops it.
Scene slidingBlockScene();

/// A block that spins about its axis of middle moment of inertia, so that it tumbles, without gravity and floor.
Scene spinningBlockScene();

/// Two blocks thrown at each other at 3 m/s, which collide askew in the air and fall to the floor.
Scene thrownPairScene();

/// A block thrown lengthwise at a wall of thin blocks that stand on edge (scenes/thin_wall.toml).
Scene thinWallScene();

/// The largest number of blocks of askewPileScene without initial overlap.
inline constexpr int kMaxAskewBlocks = 9;

/// Blocks dropped on one another, each askew and rotated further than the one below. Precondition: at most kMaxAskewBlocks.
Scene askewPileScene(int blocks);

}  // namespace springtower
