#pragma once

#include <springtower/world.h>

// What acts on a world from outside. Call these between steps; all of it is part of snapshots. Every function but `gravity`
// throws InputError, and changes nothing, for numbers that are not finite or outside the ranges that scene.h names, for a number
// that is no block's, for a fixed block, for a y component or a turn out of the plane in a scene that moves in the plane y = 0,
// and for a world that has failed.

namespace springtower::api {

/// Adds a force that acts from start_s to end_s, by its mean over each step; those that have ended are dropped. The block it acts
/// on wakes. Allocates.
void applyForce(World& world, const Force& force);

/// A force at a block's centre through the whole of the coming frame, and no further: for those who push anew in each. Several
/// add up. Allocates.
void pushThroughFrame(World& world, int block, const Vec3& force_n);

/// Takes all forces away, those of the scene among them.
void clearForces(World& world);

/// Sets gravity from the coming frame on; what sleeps wakes where it has changed. Stiffness stays what it was chosen for when the
/// world was made: under stronger gravity, or one that leans more, blocks compress more than the tolerance.
void setGravity(World& world, const Gravity& gravity);

/// Gravity as it is set.
Gravity gravity(const World& world);

/// Sets Coulomb's coefficients of surfaces that have none of their own, and wakes all blocks; the kinetic one is 0 to the static
/// one.
void setFriction(World& world, double staticFriction, double kineticFriction);

/// Sets whether blocks at rest are put to sleep, and wakes all.
void setSleep(World& world, Sleep sleep);

/// Adds to the velocity of a block, m/s (within 1000 each), as a blow would that takes no time, and wakes it.
void kick(World& world, int block, const Vec3& velocity_m_s);

// The hand. It holds one block as a whole, by springs of bounded force that are solved with all others: it is never stronger than
// its limit, and what it holds may slip from it. It takes the weight of its block as far as nothing else carries it.

/// Takes a block as it lies, and lets go of any other. `limit_n`: the most force, 1e-3 to 1000 N.
void grab(World& world, int block, double limit_n = 5.0);

/// Leads the hand, from the coming frame on, in a straight line to where the centre of its block should be, at a speed of 1e-3 to
/// 2 m/s. It stays there. Throws InputError where it holds nothing.
void moveHand(World& world, const Vec3& place, double speed_m_s = 0.1);

/// How the block in the hand should be turned; it comes there smoothly, in some tenths of a second. Throws InputError where the
/// hand holds nothing or `orientation` is no unit quaternion.
void turnHand(World& world, const Quaternion& orientation);

/// Takes a block and draws it along a line at a steady speed (1e-3 to 2 m/s), gently: while it touches what lies below, that
/// decides its height. This is how a block is drawn out of a tower. It goes on until moveHand, which carries on from there, or
/// release. `direction` is of any length but 0.
void pull(World& world, int block, const Vec3& direction, double speed_m_s = 0.04, double limit_n = 5.0);

/// Lets go. Nothing happens where the hand holds nothing.
void release(World& world);

/// What the hand does to its block.
struct HandState {
  int block = kFloor;    ///< kFloor: it holds nothing, and all else is zero
  Vec3 place;            ///< m, where it is to have the block's centre now
  Vec3 force_n;          ///< on the block, at its centre; zero before the first frame
  Vec3 torque_n_m;       ///< on the block, about its centre
  bool limited = false;  ///< whether the force is at its limit
};
HandState handState(const World& world);

}  // namespace springtower::api
