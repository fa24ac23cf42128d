#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

/// The rigid methods: each advances the island's bodies by step.drift_s and leaves the impulses in its contacts; sequential
/// impulses in its lists of points.
void stepImpulses(IslandStep& step, RigidIsland& island);
void stepRigidLcp(IslandStep& step, RigidIsland& island);
void stepXpbd(IslandStep& step, RigidIsland& island);

}  // namespace springtower
