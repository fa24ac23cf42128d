#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

#include <vector>

namespace springtower {

// Impacts in sequential impulses (solver/rigid/pgs.cpp): Newton's law of restitution, bounded by energy. Where blocks meet faster
// than leastReboundSpeed, they first stop one another, as resting ones do; then they part at the coefficient of restitution
// times the speed at which they met. Both are solved through all blocks that the impact reaches.

/// Before a substep: the speeds at which blocks meet that meet in it. Bodies move by island.motions; those that no contact pushed
/// in the last substep fall by step.gravity until they meet.
void setImpacts(const IslandStep& step, RigidIsland& island);

/// Fastest impact of points that push, m/s; 0: there is none.
double fastestImpact(const RigidIsland& island);

/// After passes: marks the bodies that a contact pushes by more than a millionth of their weight; points that do not push have no
/// impact. Returns whether any body is pushed: where none is, no blocks meet.
bool markPushedByPoints(const IslandStep& step, RigidIsland& island);

/// After the passes: takes back so much of the change from the bodies' velocities to those of the passes that their kinetic
/// energy is at most `most_j` (J). Momentum is conserved, as it is by either.
void boundRebound(RigidIsland& island, double most_j);

/// After an impact: the contacts of blocks that it has struck, by more than the slowest impact that rebounds, start the next
/// substep with the impulses that there were before; those of the impact would act a second time. Notes which pairs have met.
void forgetImpact(IslandStep& step, RigidIsland& island);

/// Kinetic energy, J; of a body that impulses move, and of all of these.
double kineticEnergy(const RigidBody& body);
double kineticEnergy(const std::vector<RigidBody>& bodies);

}  // namespace springtower
