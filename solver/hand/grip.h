#pragma once

#include "core/tuning.h"
#include "solver/world/simulation.h"

#include <span>

namespace springtower {

// The hand holds a block as a whole: it draws its centre and its orientation to where a mouse or a script wants them, by springs
// of bounded force that are solved with all others. Nothing overwrites a velocity, so the hand is never stronger than
// its limit (report 5.6 had to choose between a block that swings round the cursor and a hand with "super strength").

///< presses it against rows that lean as the tower sways, and lifts what is light

/// What the hand wants in one frame.
struct Hand {
  BlockId block = kFloor;                                    ///< kFloor: it holds nothing
  Vec3 place = Vec3::Zero();                                 ///< m, where the block's centre should be at the frame's end
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from the block's axes to the world's; unit
  double limit_n = tuning::kGripForce_n;                     ///< N, most force; the torque is at most this times half the
                                                             ///< block's middle side, what two fingers on its sides can give
  Vec3 velocity = Vec3::Zero();                              ///< m/s, of the place during the frame
  double rate_rad_s = tuning::kFollowFrequency_rad_s;        ///< how stiffly its place is followed
  Vec3 line = Vec3::Zero();                                  ///< unit where it draws along a line: it then lets the block lie as
                                                             ///< its supports do, and carries what hangs over them, so that its
                                                             ///< other end does not lift what lies on it; all by no more than
                                                             ///< the block's weight asks for
};

/// Distance left after a time, from rest at distance 1, of a free block that follows the hand: critically damped, (1 + w t)
/// e^(-w t), so it never overshoots.
double followCourse(double rate_rad_s, double time_s);

/// What the hand remembers of a grip.
struct Grip {
  BlockId block = kFloor;
  double carried = 0.0;                                      ///< share of the block's weight that the hand carries, 0..1: what
                                                             ///< no contact carries
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< to which the hand has come, on its way to the one wanted
  Vec3 spin = Vec3::Zero();                                  ///< rad/s, at which it goes there
};

/// How the held block touches others.
enum class Hold { none, free, sticks, slips };

/// The orientation of a (slightly deformed) block: the rotation nearest to its two longer mean edges. The shortest is left out,
/// as friction shears it without turning the block.
Eigen::Quaterniond orientationOf(const ParticleArray& position, std::size_t block);

/// Lets the hand hold its block in the coming frame (simulation.tether), and brings its memory up to date. `contacts`:
/// those on the block (contactForcesOn) or all, as the simulation stands. The hand takes the weight of a block as far as no
/// contact carries it, one that draws as far as nothing below the block does: a gripped block of the tower rests as before, and
/// one in the air does not sag. Precondition: the hand holds a block.
void hold(const Hand& hand, std::span<const ContactForce> contacts, Grip& grip, Simulation& simulation);

/// Lets go.
void letGo(Simulation& simulation);

/// What the hand does to its block now; nothing where it holds none.
GripForce gripForce(const Simulation& simulation);

/// A hand that draws its block along a line at a steady speed.
struct Draw {
  Hand hand;  ///< the block, a place on the line, its direction, and the force that the hand has at most
  Grip grip;
  double speed_m_s = 0.04;  ///< to which it comes evenly, over the first millimetres
  double drawn_s = 0.0;     ///< s since it set out
};

/// Leads the hand on for the coming frame, no farther ahead of its block than its force reaches, and lets it hold the block.
/// Precondition: the hand holds a block.
void advancePull(Draw& draw, std::span<const ContactForce> contacts, Simulation& simulation);

/// A hand that will draw a block along a line from where it lies, at a speed.
Draw drawingFrom(const Simulation& simulation, BlockId block, const Vec3& direction, double speed_m_s,
                 double limit_n = tuning::kGripForce_n);

/// A hand that takes a block as it lies.
Hand handOn(const Simulation& simulation, BlockId block, double limit_n = tuning::kGripForce_n);

/// Whether the block is free, or held by its contacts, or slides: it slips when more than half of the normal force on it is on
/// points that slide.
Hold holdOf(std::span<const ContactForce> contacts, BlockId block);

}  // namespace springtower
