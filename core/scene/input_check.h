#pragma once

#include "core/scene/scene.h"

#include <Eigen/Geometry>
#include <span>
#include <string_view>

namespace springtower {

// What may change while a scene runs is checked as it is when the scene is made (checkScene).

/// Checks that every number of a gravity is within the limits of core/limits.h. Throws InputError naming `source`, the number,
/// what is expected and what it got.
void checkGravity(const Gravity& gravity, std::string_view source);

/// Checks that a force acts on one of these blocks (dimensions in m), at its centre (-1), at one of its corners (0 to 7) or at a
/// point that lies within it, that its numbers are within the limits and that it does not end before it starts. Throws InputError
/// naming `source`, the number, what is expected and what it got.
void checkForce(const UserForce& force, std::span<const Vec3> dimensions, std::string_view source);

/// Checks that a block, counted from 0, is one of `blocks`. Throws InputError naming `source`, the number and what is allowed.
void requireBlock(std::size_t block, std::size_t blocks, std::string_view source);

/// Checks that a block is not fixed, so that it may be pushed, kicked or held. Precondition: it is one of the scene's. Throws
/// InputError naming `source`, the block, and what is allowed.
void requireMovable(const Scene& scene, std::size_t block, std::string_view source);

/// Checks both coefficients of friction: within the limits, and the kinetic one no larger than the static one. Throws InputError
/// naming `source`, the coefficient, what is expected and what it got.
void checkFriction(double staticFriction, double kineticFriction, std::string_view source);

/// Checks the coefficients of a whole scene: its own, those of the floor, of blocks and of pairs, each pair once. Throws
/// InputError.
void checkFrictions(const Scene& scene, std::string_view source);

/// Checks what a scene in the plane y = 0 allows: a force at the centre, without a y component, and a torque about y alone;
/// gravity without a y component; a block turned so that one of its axes is the plane's normal. Throws InputError naming
/// `source`, what is expected and what it got.
void checkForceInPlane(const UserForce& force, std::string_view source);
void checkGravityInPlane(const Gravity& gravity, std::string_view source);
void checkTurnInPlane(const Eigen::Quaterniond& turn, std::string_view source);

}  // namespace springtower
