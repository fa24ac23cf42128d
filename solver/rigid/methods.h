#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

/// The rigid methods: each advances the island's bodies by step.drift_s and leaves the impulses in its contacts. Sequential
/// impulses do so in two parts: one moves the bodies; after the step is accepted, the other relaxes their velocities. `again`:
/// the step is repeated from the same poses, with the contacts found in it.
void solveAndIntegratePgs(IslandStep& step, RigidIsland& island, bool again);
void relaxPgs(IslandStep& step, RigidIsland& island);
void stepRigidLcp(IslandStep& step, RigidIsland& island);
void stepXpbd(IslandStep& step, RigidIsland& island);

}  // namespace springtower
