#pragma once

#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

namespace springtower {

/// Moment of inertia, its inverse, and radius of a body with its present corners. `mass_kg` is that of the block.
void setMoments(Inertia inertia, double mass_kg, RigidBody& body);

/// How the shapes of all blocks follow forces, from the stiffness of their springs.
void prepareShapes(Simulation& simulation);

/// Energy of an island's contacts in rigid mode of a penalty method, J: that of the springs that their forces compress.
double strainEnergyOfContacts(const IslandStep& step);

/// Lessens what lasts of the forces in an island's contacts, all by the same share, until their springs store no more than
/// `most_j`. Returns what they store, J.
double boundStrainOfContacts(const IslandStep& step, double most_j);

/// As a frame ends: the blocks of an island of springs take on a share of the shape that they have under the forces of their
/// contacts, so that implicit steps find them in equilibrium when they take over. The share is that of `time_s`, the frame's
/// length, in it and sqrt(h / g): forces change as fast as blocks fall past one another. The springs store no more energy than
/// `lost_j`, what the frame has lost. Angular momentum is kept. Blocks do not deform farther than by a force that compresses the
/// contact's springs by the tolerance: what is greater is an impact. Impulses are in the manifolds, positions where the bodies
/// are.
void relaxShapes(const IslandStep& step, double time_s, double lost_j, RigidIsland& island);

}  // namespace springtower
