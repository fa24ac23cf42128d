#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

// Which points of an island may touch in a rigid step, found before it (narrowphase/near_points.h). A step consists of some
// substeps. Pairs whose blocks hardly move against one another keep their points for some steps; those that move fast have
// theirs found anew in every substep; for the rest it is done in every step.

/// Lists the points of the active pairs that may touch in a step of step.drift_s, except those of fast pairs, which become
/// `fastPairs`, and marks the pairs of both as covered. They start with the impulses of the step before, of those in `known`,
/// or of the manifolds where nothing is known, for substeps of `substep_s`. `again`: the step is repeated, with pairs that have
/// met in it.
void listPoints(IslandStep& step, RigidIsland& island, double substep_s, bool again);

/// Between substeps of a step of `step_s`: makes fast pairs of those of bodies whose velocity has changed so much since the step
/// began that they may outrun the points listed.
void addOutrun(IslandStep& step, RigidIsland& island, double step_s);

/// In a substep, with step.drift_s as its length: lists the points of fast pairs. `firstSubstep`: of the step.
void listFastPoints(IslandStep& step, RigidIsland& island, bool firstSubstep);

/// Whether a pair that was not covered has met in the step.
bool hasUncoveredContact(const IslandStep& step);

/// Before the first step: nothing is known but the manifolds.
void forgetPoints(RigidIsland& island);

/// After the last step: the lists that take turns get equal memory, so that a frame that is run again allocates nothing.
void equaliseMemory(RigidIsland& island);

/// After a step: pairs that push become contacts, and the points are what is known in the next step.
void keepPoints(IslandStep& step, RigidIsland& island);

}  // namespace springtower
