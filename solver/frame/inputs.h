#pragma once

#include "solver/world/simulation.h"

#include <cstddef>

namespace springtower {

// What the outside may change between two frames of a running scene, beside `kick` (solver/world/simulation.h) and the hand
// (solver/hand/grip.h). All of it is part of snapshots. Every function checks what it is given as checkScene does, and throws
// InputError, with nothing changed, naming what is expected and what it got.

/// A force at a block's centre through the coming frame. To push again in the next frame, set another in its place
/// (setOnlyForce). Throws InputError for a number that is no block's.
UserForce forceForOneFrame(const Simulation& simulation, std::size_t block, const Vec3& force);

/// Adds a force to those that act on the scene; forces that ended before the last frame began are dropped.
void applyForce(Simulation& simulation, const UserForce& force);

/// Replaces all forces that act on the scene by one.
void setOnlyForce(Simulation& simulation, const UserForce& force);

/// Takes all forces away.
void clearForces(Simulation& simulation);

/// Sets gravity from the coming frame on. Sleepers wake where it has changed. Stiffness stays what it was chosen for: under
/// stronger gravity blocks compress more than the tolerance.
void setGravity(Simulation& simulation, const Gravity& gravity);

/// Sets Coulomb's coefficients, and wakes all blocks.
void setFriction(Simulation& simulation, double staticFriction, double kineticFriction);

/// Sets whether blocks at rest are put to sleep, and wakes all blocks.
void setSleep(Simulation& simulation, Sleep sleep);

}  // namespace springtower
