#pragma once

#include "core/scene/scene.h"

namespace springtower {

/// One block of the game, standing flat on the floor if there is one, that never sleeps.
Scene oneBlockScene(bool floor);

/// A block that is dropped: its centre is `height_m` above the floor, m, and it is turned so. Precondition: it does not reach
/// into the floor.
Scene droppedBlockScene(double height_m, const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());

/// A turn that lets a dropped block meet the floor with a corner.
Eigen::Quaterniond ontoACorner();

/// A block on a slope: gravity leans by `tilt_deg` towards `direction_deg`, degrees from +x over +y.
Scene blockOnSlopeScene(double tilt_deg, double direction_deg);

/// The block of scenes/block_on_slope.toml: the slope is 1 % below the angle of friction.
Scene steepSlopeScene();

/// A block that slides over the floor at 0.7 m/s until friction stops it.
Scene slidingBlockScene();

/// A block that spins about its axis of middle moment, so that it tumbles, without gravity and floor.
Scene spinningBlockScene();

/// Two blocks that are thrown at each other at 3 m/s, meet in the air askew, and fall to the floor.
Scene thrownPairScene();

/// A block thrown lengthwise at a wall of thin blocks that stand on edge: that of scenes/thin_wall.toml.
Scene thinWallScene();

/// Blocks turned at random, always the same, on a lattice in which none can touch another: four a layer. They fall into a heap.
Scene heapScene(int blocks);

/// The most blocks of askewHeapScene that do not start inside one another.
inline constexpr int kMaxAskewBlocks = 9;

/// Blocks dropped on one another, each askew and turned further than the one below. Precondition: at most kMaxAskewBlocks.
Scene askewHeapScene(int blocks);

}  // namespace springtower
