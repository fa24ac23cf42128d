#pragma once

#include "solver/implicit.h"
#include "solver/island_step.h"

namespace springtower {

// What the rigid methods ask of a frame. Blocks do not deform; the contacts are those of every other method.

/// Sizes what the rigid methods need.
void prepareRigid(Simulation& simulation);

/// Orthonormal axes of a block as columns: its first mean edge, the second as far as it is across that, and the one across both
/// (Gram & Schmidt).
Eigen::Matrix3d straightAxes(const CornerArray& position, std::size_t block);

/// Steps of a frame: as the settings say, or the default.
int rigidSubsteps(const Settings& settings);

/// Steps an island through the whole frame: poses from the particles, then for each step the method's own solution and the
/// contacts. A step in which blocks meet is taken again with the contacts it has found, so that they stop at the surface.
/// Returns false in `inside` when a block has left its swept box. Throws DivergenceError.
IslandOutcome runRigidSteps(IslandStep& step);

/// The island's working data.
RigidIsland& rigidIslandOf(IslandStep& step);

/// Gravity, user forces: velocities of all bodies after step.drift_s of free flight.
void applyForces(IslandStep& step);

/// Moves a body by its velocity and spin for a time. Its angular momentum is kept; the turn is by the spin in the middle of the
/// step (second order).
void moveFreely(RigidBody& body, double step_s);

/// A turn followed by a rotation vector (rad, world axes).
Eigen::Quaterniond turnedBy(const Vec3& angle, const Eigen::Quaterniond& turn);

/// Moment of inertia in the world's axes, inverted, for the body's turn now.
void updateInertia(RigidBody& body);

}  // namespace springtower
