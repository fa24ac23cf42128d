#pragma once

#include "solver/world/island_step.h"

namespace springtower {

// Rigid steps of a frame. Blocks do not deform; the contacts are those of every other method.

/// Sizes what the rigid methods need.
void prepareRigid(Simulation& simulation);

/// Orthonormal axes of a block as columns: its first mean edge, the part of the second perpendicular to it, and their cross
/// product (Gram & Schmidt).
Eigen::Matrix3d straightAxes(const ParticleArray& position, std::size_t block);

/// Steps of a frame: from the settings, or the default.
int rigidSubsteps(const Settings& settings);

/// Advances an island through the frame from `begin_s` on, with steps of the size at which a whole frame takes `steps`: reads
/// poses from the particles, then for each step runs the solver of the method (sequential impulses for an island of another
/// method in rigid mode) and updates the contacts. A step in which blocks make contact is repeated with the contacts found, so
/// that they stop at the surface. Blocks keep their present shape. Sets `inside` to false if a block has left its swept box.
/// Throws DivergenceError.
IslandOutcome runRigidSteps(IslandStep& step, int steps, double begin_s);

/// The island's working data.
RigidIsland& rigidIslandOf(IslandStep& step);

/// Gravity, user forces and the hand: velocities of all bodies after step.drift_s without contact forces.
void applyForces(IslandStep& step);

/// Moves a body by its velocity and spin for a time. Its angular momentum is conserved; the rotation is by the spin in the middle
/// of the step (second order).
void moveFreely(RigidBody& body, double step_s);

/// Rotates orthonormal axes by a small angle (rad, world axes), to second order; they stay orthonormal.
void turnAxes(const Vec3& angle, Eigen::Matrix3d& axes);

/// Inverse inertia tensor in world axes, for the body's present orientation.
void updateInertia(RigidBody& body);

}  // namespace springtower
