#pragma once

#include "solver/island_step.h"

namespace springtower {

/// Looks at a pair that was apart and whose margin is used up, after a step: a direction that separates the blocks all through
/// the step renews the margin; otherwise the cubic tests decide, and if features meet a contact is born.
void watchApart(IslandStep& step, NearPair& pair, Counters& counters);

/// Renews the manifold of a touching pair from the positions now, keeping its memory; lets the pair go when it has parted.
void renewManifold(IslandStep& step, NearPair& pair, Counters& counters);

/// Path (m, both blocks together) after which a manifold is renewed.
double refreshTravel(const Simulation& simulation);

}  // namespace springtower
