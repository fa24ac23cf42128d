#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Looks at a pair (its position in engine.pairs) that was apart and whose margin is used up, after a step: a direction that
/// separates the blocks all through the step renews the margin; otherwise the cubic tests decide, and if features meet a contact
/// is born. The time of the cubic tests is added to `times`.
void updateSeparated(IslandStep& step, std::size_t at, Counters& counters, StageTimes& times);

/// Gap (m) of a pair that is apart along the direction that separated its blocks when they were looked at last: its margin here.
/// Not negative.
double marginNow(const Simulation& simulation, std::size_t at);

/// Renews the manifold of a touching pair from the positions now, keeping what its points store; lets the pair go when it has
/// parted.
void refreshManifold(IslandStep& step, std::size_t at, Counters& counters);

/// Path (m, both blocks together) after which a manifold is renewed.
double refreshTravel(const Simulation& simulation);

}  // namespace springtower
