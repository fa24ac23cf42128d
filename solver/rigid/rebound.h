#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

// Restitution of the rigid methods that have a list of contacts (RigidContact); sequential impulses have it in their passes
// (solver/rigid/pgs.cpp). Both follow Newton's law: a point at which blocks meet faster than leastReboundSpeed parts at the
// coefficient of restitution times that speed, through all blocks that the impact reaches.

/// Before a step: the speeds at which the blocks part that meet in it, by the velocities that the bodies have.
void setContactRebounds(const IslandStep& step, RigidIsland& island);

/// Marks as pushed the bodies that a contact pushes, by more than a millionth of their weight; or all that touch anything.
void markPushed(const IslandStep& step, RigidIsland& island);
void markTouching(RigidIsland& island);

/// After a step: what pushed and meets fast parts, by passes over the contacts that pushed. Marks the bodies that a contact
/// pushes. Kinetic energy is at most island.energyBefore_j after it, or what it was before: several blocks that meet at once,
/// with friction, would gain some by Newton's law.
void applyContactRebounds(IslandStep& step, RigidIsland& island);

}  // namespace springtower
