#pragma once

#include "solver/engine.h"

namespace springtower {

/// Before a frame: wakes sleeping blocks that a user's force will act on, and all of them when gravity has changed since they
/// fell asleep.
void wakeForFrame(Simulation& simulation);

/// After a frame: judges the rest of every awake block by its rigid motion and its balance, wakes sleeping blocks whose awake
/// neighbours push them otherwise than when they fell asleep, and puts groups of touching blocks to sleep that are all at rest.
void updateRest(Simulation& simulation);

/// Wakes one block.
void wake(Simulation& simulation, std::size_t block);

}  // namespace springtower
