#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Checks a separated pair (its position in engine.pairs) whose clearance is used up, after a step. A direction that separates
/// the blocks throughout the step gives a new clearance; otherwise the cubic tests decide, and if features meet, a contact is
/// created, unless all that they have in common are edges that are nearly parallel. The time of the cubic tests is added to
/// `times`.
void updateSeparated(IslandStep& step, std::size_t at, Counters& counters, StageTimes& times);

/// Makes a separated pair no farther apart than `reach_m` a contact, of points that do not touch.
void createAhead(IslandStep& step, std::size_t at, double reach_m);

/// Makes a separated pair a contact at the present positions.
void createTouching(IslandStep& step, std::size_t at, Counters& counters);

/// Present gap (m) of a separated pair along its stored axis, at least 0.
double clearanceNow(const Simulation& simulation, std::size_t at);

/// Recomputes the manifold of a touching pair from the present positions, keeping what its points store; marks the pair as
/// separated when it has parted.
void refreshManifold(IslandStep& step, std::size_t at, Counters& counters);

/// When blocks graze rather than meet.
GrazingLimits grazingLimits(const Simulation& simulation);

/// Travel (m, sum of both blocks) after which a manifold is refreshed, if the blocks have moved against each other.
double refreshTravel(const Simulation& simulation);

}  // namespace springtower
