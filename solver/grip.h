#pragma once

#include "solver/simulation.h"

#include <span>

namespace springtower {

// The hand holds a block as a whole: it draws its centre and its orientation to where a mouse or a script wants them, with a
// bounded force that goes through the solver like any other. Nothing overwrites a velocity, so the hand is never stronger than
// its limit (report 5.6 had to choose between a block that swings round the cursor and a hand with "super strength").

inline constexpr double kGripForce_n = 5.0;      ///< N, the default limit
inline constexpr double kFollowRate_hz = 7.958;  ///< natural frequency of the follow, 1/s over 2 pi: 50 rad/s

/// What the hand wants in one frame.
struct Hand {
  BlockId block = kFloor;                                    ///< kFloor: it holds nothing
  Vec3 place = Vec3::Zero();                                 ///< m, where the block's centre should be
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from the block's axes to the world's; unit
  double limit_n = kGripForce_n;                             ///< N, most force; the torque is limited to this times half the
                                                             ///< block's middle side, what two fingers on its sides can give
};

/// Gains of a follow whose force is constant over a frame: acceleration = place * (distance) - speed * (velocity).
struct FollowGains {
  double place;  ///< 1/s2
  double speed;  ///< 1/s
};

/// The gains that put both poles of the sampled motion of a free mass at exp(-2 pi rate frame_s): critically damped in the exact
/// sampled sense, at any rate. From rest at distance 1 the distance after k frames is followCourse(k).
FollowGains followGains(double rate_hz, double frame_s);

/// The closed form of that motion: (1 + k (1 - p^2) / (2 p)) p^k with p the pole; positive and falling, so it never overshoots.
double followCourse(double rate_hz, double frame_s, int frames);

/// What the hand remembers of a grip.
struct Grip {
  BlockId block = kFloor;
  double carried = 0.0;           ///< share of the block's weight that the hand carries, 0..1: what no contact carries
  Vec3 levelling = Vec3::Zero();  ///< N m, what the hand turns the block with against its contacts: a block drawn out beyond its
                                  ///< support would tip over the edge and lever up what lies on its other end
};

/// How the held block touches others.
enum class Hold { none, free, sticks, slips };

/// What the hand does to the block.
struct GripForce {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m, about the centre
  bool limited = false;        ///< whether the force is at its limit
};

/// The orientation of a (slightly deformed) block: the rotation nearest to its mean edges.
Eigen::Quaterniond orientationOf(const CornerArray& position, std::size_t block);

/// The hand's force for the coming frame, and its memory brought up to date. `contacts`: contactForces of the simulation as it
/// stands. The hand takes the weight of a block as far as no contact carries it, and the torque that its contacts leave: a
/// gripped block of the tower rests as before, a block in the air does not sag, and one that is drawn out stays level.
/// Precondition: the hand holds a block.
GripForce gripForce(const Simulation& simulation, std::span<const ContactForce> contacts, const Hand& hand, Grip& grip);

/// Eight corner forces that add up to this force and torque and leave the block's shape as it is (to first order), for one frame.
/// Appends them to the scene's forces.
void applyGrip(Simulation& simulation, BlockId block, const GripForce& grip);

/// A hand that draws its block along a line at a steady speed: it leads the block by as much as that takes.
struct Draw {
  Hand hand;  ///< the block, the line (through `place`) and the force that the hand has at most
  Grip grip;
  Vec3 direction = Vec3::UnitX();  ///< unit
  double speed_m_s = 0.04;
};

/// Leads the hand for the coming frame, with the force that its contacts took in the last frame and a push towards its speed, and
/// adds its forces to the scene's. Returns its force along the direction, N. Precondition: the hand holds a block.
double drawOn(Draw& draw, std::span<const ContactForce> contacts, Simulation& simulation);

/// A hand that takes a block as it lies.
Hand handOn(const Simulation& simulation, BlockId block, double limit_n = kGripForce_n);

/// Whether the block is free, or held by its contacts, or slides: it slips when more than half of the normal force on it is on
/// points that slide.
Hold holdOf(std::span<const ContactForce> contacts, BlockId block);

}  // namespace springtower
