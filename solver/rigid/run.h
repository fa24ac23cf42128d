#pragma once

#include "solver/world/island_step.h"

namespace springtower {

// What the rigid methods ask of a frame. Blocks do not deform; the contacts are those of every other method.

/// Sizes what the rigid methods need.
void prepareRigid(Simulation& simulation);

/// Orthonormal axes of a block as columns: its first mean edge, the second as far as it is across that, and the one across both
/// (Gram & Schmidt).
Eigen::Matrix3d straightAxes(const ParticleArray& position, std::size_t block);

/// Steps of a frame: as the settings say, or the default.
int rigidSubsteps(const Settings& settings);

/// Steps an island through the frame from `begin_s` on, as many steps as a whole frame would take `steps`: poses from the
/// particles, then for each step the method's own solution (sequential impulses for an island of another method that falls) and
/// the contacts. A step in which blocks meet is taken again with the contacts it has found, so that they stop at the surface.
/// Blocks keep the shape they have. Returns false in `inside` when a block has left its swept box. Throws DivergenceError.
IslandOutcome runRigidSteps(IslandStep& step, int steps, double begin_s);

/// The island's working data.
RigidIsland& rigidIslandOf(IslandStep& step);

/// Gravity, user forces: velocities of all bodies after step.drift_s of free flight.
void applyForces(IslandStep& step);

/// Moves a body by its velocity and spin for a time. Its angular momentum is kept; the turn is by the spin in the middle of the
/// step (second order).
void moveFreely(RigidBody& body, double step_s);

/// Turns orthonormal axes by a small angle (rad, world axes), to second order; they stay orthonormal.
void turnAxes(const Vec3& angle, Eigen::Matrix3d& axes);

/// Moment of inertia in the world's axes, inverted, for the body's turn now.
void updateInertia(RigidBody& body);

}  // namespace springtower
