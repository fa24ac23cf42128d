#pragma once

#include "solver/world/simulation.h"

#include <span>
#include <vector>

namespace springtower {

/// A force of the scene (UserForce) that acts at the end of the frame that has just ended.
struct UserPush {
  std::size_t block;
  Vec3 place;   ///< m, present point of application
  Vec3 force;   ///< N
  Vec3 torque;  ///< N m
};
std::vector<UserPush> userPushes(const Simulation& simulation);

/// Sum of gravity, the scene's forces and the contact forces on a block: zero while it rests. The hand is not included.
struct Imbalance {
  double force = 0.0;   ///< in weights of the block
  double torque = 0.0;  ///< about its centre, in its weight times its height (its shortest edge)
};

/// Of every block, [blocks]; zeros without gravity. `contacts`: from contactForces.
std::vector<Imbalance> imbalances(const Simulation& simulation, std::span<const ContactForce> contacts);

/// The largest force and the largest torque of any block. Zeros without blocks.
Imbalance largestImbalance(std::span<const Imbalance> imbalances);

/// Largest distance of the friction of a contact point outside its Coulomb cone, N; 0 if all are inside. The cone is that of the
/// larger of both coefficients.
double farthestOutsideCone(const Simulation& simulation, std::span<const ContactForce> contacts);

}  // namespace springtower
