#pragma once

#include "solver/implicit/search_monitor.h"
#include "solver/world/island_step.h"

#include <cstddef>

namespace springtower {

/// The step of one island in the part of the frame to come.
IslandStep islandStep(Simulation& simulation, const ContactLaw& law, std::size_t island);

/// Runs `advance` for every island that takes part (scratch.takesPart), side by side, each from its checkpoint. Returns whether
/// all have stayed inside their swept boxes. Throws the DivergenceError of the first island in their order that has one, when all
/// have run: the message is the same on any number of threads, and the state as well. `monitor`, or null, is handed on.
bool overIslands(Simulation& simulation, IslandOutcome (*advance)(IslandStep&), SearchMonitor* monitor = nullptr);

}  // namespace springtower
