#pragma once

#include "core/hand.h"
#include "core/tuning.h"
#include "solver/world/simulation.h"

#include <span>

namespace springtower {

// The hand holds a block as a whole: bounded springs, solved together with all others, pull its centre and orientation to the
// targets set by a mouse or a script. Nothing overwrites a velocity, so the hand is never stronger than its limit (report 5.6 had
// to choose between a block that swings round the cursor and a hand with "super strength").

/// Distance left after a time, from rest at distance 1, of a free block that follows the hand: critically damped, (1 + w t) e^(-w
/// t), so it never overshoots.
double followCourse(double rate_rad_s, double time_s);

/// State of a grip between frames.
struct Grip {
  BlockId block = kFloor;
  double carried = 0.0;  ///< share of the block's weight that the hand supports, 0..1: the share without contact forces
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< present target orientation, on its way to that of the hand
  Vec3 spin = Vec3::Zero();                                  ///< rad/s, its angular velocity
};

/// Contact state of the held block.
enum class Hold { none, free, sticks, slips };

/// The orientation of a (slightly deformed) block: the rotation nearest to its two longer mean edges. The shortest is left out,
/// because friction shears it without rotating the block.
Eigen::Quaterniond orientationOf(const ParticleArray& position, std::size_t block);

/// Sets simulation.tether so that the hand holds its block in the coming frame, and updates the grip. `contacts`: those on the
/// block (contactForcesOn) or all, at the present state. The hand supports the part of the block's weight that no contact
/// supports; a drawing hand, the part that nothing below the block supports. So a gripped block of the tower rests as before, and
/// one in the air does not sag. Precondition: the hand holds a block.
void hold(const Hand& hand, std::span<const ContactForce> contacts, Grip& grip, Simulation& simulation);

/// Releases the block.
void letGo(Simulation& simulation);

/// Present force of the hand on its block; zero if it holds none.
GripForce gripForce(const Simulation& simulation);

/// A hand that draws its block along a line at a steady speed.
struct Draw {
  Hand hand;  ///< the block, a place on the line, its direction, and the force limit
  Grip grip;
  double speed_m_s = 0.04;  ///< final speed, reached with uniform acceleration over the first millimetres
  double drawn_s = 0.0;     ///< s since the draw began
};

/// Distance from its block at which a hand reaches its force limit, m. Precondition: the hand holds a block.
double reachOf(const Hand& hand, const Simulation& simulation);

/// Moves the place of a hand along its line at a speed (m/s, signed) for the coming frame; its height follows the block's, the
/// less of the block's weight the hand supports (`carried`, 0..1). Precondition: the hand holds a block and has a line.
void moveAlongLine(Hand& hand, double speed_m_s, double carried, const Simulation& simulation);

/// Advances the hand for the coming frame, limited to the distance from its block at which its force limit is reached, and holds
/// the block. Precondition: the hand holds a block.
void advancePull(Draw& draw, std::span<const ContactForce> contacts, Simulation& simulation);

/// A hand that will draw a block along a line from its present position, at a speed. Throws InputError for a number that is no
/// block's.
Draw drawingFrom(const Simulation& simulation, BlockId block, const Vec3& direction, double speed_m_s,
                 double limit_n = tuning::kGripForce_n);

/// A hand that grips a block in its present pose. Throws InputError for a number that is no block's.
Hand handOn(const Simulation& simulation, BlockId block, double limit_n = tuning::kGripForce_n);

/// Whether the block is free, sticks at its contacts, or slips: it slips when more than half of the normal force on it acts at
/// slipping points.
Hold holdOf(std::span<const ContactForce> contacts, BlockId block);

}  // namespace springtower
