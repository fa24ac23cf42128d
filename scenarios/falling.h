#pragma once

#include "core/scene/scene.h"

namespace springtower {

// Many blocks in motion.

/// Blocks with random orientations, always the same, on a cubic lattice in which none can touch another, the lowest 10 cm above
/// the floor: some 1.5 times as high as it is wide. They fall into a heap. Precondition: `blocks` is positive.
Scene heapScene(int blocks);

/// The same in a shaft: four a layer, so that they fall from far higher. Precondition: `blocks` is positive.
Scene shaftScene(int blocks);

/// The same as heapScene with 16 a layer, at heights from which equally many land in every part of the first second, as far as
/// none can touch another. Precondition: `blocks` is positive.
Scene rainScene(int blocks);

/// A tower of `rows`, and a block that flies lengthwise at 5 m/s at 0.6 of its height. Precondition: `rows` is positive.
Scene shotTowerScene(int rows);

}  // namespace springtower
