#pragma once

#include "solver/world/rigid_island.h"

namespace springtower {

/// Takes the kinetic energy that contacts have added in a substep (of `step_s`, s) from the blocks to which they have given it.
/// Precondition: island.motions holds the bodies' velocities after the passes, gaps are those at the end.
///
/// A contact adds energy where its passes have not converged: blocks part against its push faster than they rebound, and than the
/// release of its springs accounts for, or slide along its friction. What is taken from each of its blocks is at most
/// tuning::kMostGivenEnergy times that energy; and as much from a heavier block on which a lighter one of them pushes, in
/// proportion to the difference of their masses over the sum, through tuning::kHandOnSweeps blocks: a light block hands on what
/// it gets. The rest of `added_j` (J, of the island, beyond the work of gravity, forces and the hand) is that of the springs,
/// which lift the blocks that they carry: to take it from the velocities of all would brake what moves elsewhere, and a block
/// that tips slowly on a wall of 240 would stand still (docs/adr/0019-energy-of-contacts.md).
void takeGivenEnergy(double added_j, double step_s, RigidIsland& island);

}  // namespace springtower
