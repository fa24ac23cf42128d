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

/// Energy by which the overlap of blocks of a mass (kg) may be pushed out in a frame beyond what the frame has lost, J.
double freePushOut(const Simulation& simulation, double mass_kg);

/// Advances an island from `begin_s` to the end of the part of the frame with `steps` solutions of its contacts (> 0): reads
/// poses from the particles, solves and moves by the method (by sequential impulses for an island of another method in rigid
/// mode), and looks for contacts, with sequential impulses after every few solutions, between which the points are known that may
/// touch (list_points.h). What is followed by an unforeseen contact is repeated with it, so that blocks stop at the surface.
/// Blocks keep the shape with which the frame begins (shapes.h). Sets `inside` to false if a block has left its swept box. Throws
/// DivergenceError.
IslandOutcome runRigidSteps(IslandStep& step, int steps, double begin_s);

/// The island's working data.
RigidIsland& rigidIslandOf(IslandStep& step);

/// Gravity, user forces and the hand: velocities of all bodies after step.drift_s without contact forces.
void applyForces(IslandStep& step);

/// Adds the work of these in the step, by the way and turn of each body in it, to island.energyBefore_j.
void addWorkOfForces(const IslandStep& step, RigidIsland& island);

/// Moves a body by its velocity and spin for a time. Its angular momentum is conserved; the rotation is by the spin in the middle
/// of the step (second order).
void moveFreely(RigidBody& body, double step_s);

/// The same through a step of step.drift_s: a body that no contact pushes falls freely in it, by its mean velocity and not by
/// that of the step's end, which applyForces has set.
void moveInStep(const IslandStep& step, RigidBody& body);

/// Rotates orthonormal axes by a small angle (rad, world axes), to second order; they stay orthonormal.
void turnAxes(const Vec3& angle, Eigen::Matrix3d& axes);

/// Inverse inertia tensor in world axes, for the body's present orientation.
void updateInertia(RigidBody& body);

}  // namespace springtower
