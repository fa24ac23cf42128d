#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

/// Moment of inertia, its inverse, and radius of a body with its present corners. `mass_kg` is that of the block.
void setMoments(Inertia inertia, double mass_kg, RigidBody& body);

/// How the shapes of all blocks follow forces, from the stiffness of their springs.
void prepareShapes(Simulation& simulation);

/// As a frame begins: the blocks of an island of springs take on a share of the shape that they have under the forces of their
/// contacts, so that implicit steps find them in equilibrium when they take over. The share is that of `time_s` in it and
/// sqrt(h / g): forces change as fast as blocks fall past one another. Angular momentum is kept. Blocks do not deform farther
/// than by a force that compresses the contact's springs by the tolerance: what is greater is an impact. Bodies have been read,
/// in the order of step.blocks; impulses are in the manifolds.
void relaxShapes(const IslandStep& step, double time_s, RigidIsland& island);

}  // namespace springtower
