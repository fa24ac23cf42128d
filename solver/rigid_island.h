#pragma once

#include "core/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// A block as the rigid methods see it, while its island is stepped through a frame. Between frames the particles are the state:
/// poses are read from them when a frame begins and written back after every step, so that all else works unchanged.
struct RigidBody {
  Vec3 place = Vec3::Zero();                                 ///< m, of its centre
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< from its own axes to the world's; unit
  Vec3 velocity = Vec3::Zero();                              ///< m/s
  Vec3 spin = Vec3::Zero();                                  ///< rad/s, world axes
  Vec3 moment = Vec3::Zero();                                ///< kg m2, principal moments of inertia
  double inverseMass = 0.0;                                  ///< 1/kg
  Eigen::Matrix3d inverseInertia = Eigen::Matrix3d::Zero();  ///< 1/(kg m2), world axes
  Vec3 placeBefore = Vec3::Zero();                           ///< the same four when the step began
  Eigen::Quaterniond turnBefore = Eigen::Quaterniond::Identity();
  Vec3 velocityBefore = Vec3::Zero();
  Vec3 spinBefore = Vec3::Zero();
  Vec3 moved = Vec3::Zero();   ///< m, by which the step has moved it so far
  Vec3 turned = Vec3::Zero();  ///< rad, by which the step has turned it, to first order
};

/// One point of a manifold as a constraint: along its normal the blocks may part, across it they stick or slide.
struct RigidContact {
  std::int32_t upper = -1;  ///< place of the body in the island; -1 for what does not move: the floor, a sleeping block
  std::int32_t lower = -1;
  std::int32_t pair = 0;  ///< position in engine.pairs
  std::int32_t point = 0;
  std::array<Vec3, 3> direction;    ///< unit: the normal, from lower to upper, and two tangents
  Vec3 armUpper;                    ///< m, from the body's centre to the point
  Vec3 armLower;                    ///< m
  double gap = 0.0;                 ///< m when the step began; negative where the blocks overlap
  double coefficient = 0.0;         ///< of friction, static or kinetic as the point did last
  std::array<double, 3> mass{};     ///< kg, effective along each direction
  std::array<double, 3> impulse{};  ///< N s, accumulated along each direction
  std::array<double, 2> stretch{};  ///< m, tangential displacement since the point took hold (position-based method)
  double share = 1.0;               ///< one over the points of its manifold
  double loadBefore = 0.0;          ///< N s2, normal push of the step before (position-based method)
  bool sliding = false;             ///< whether friction is at its bound
};

/// Working space of the pivoting method: rows are the contacts' normals, then their tangents.
struct PivotingSpace {
  std::vector<double> matrix;    ///< 1/kg, how an impulse along one row changes the velocity along another, [rows][rows]
  std::vector<double> inverse;   ///< kg, inverse of its part for the clamped rows, [rows][rows] with the first of them in use
  std::vector<double> impulse;   ///< N s, [rows]
  std::vector<double> velocity;  ///< m/s, along each row with these impulses
  std::vector<double> least;     ///< N s, bounds of the impulses
  std::vector<double> most;      ///< N s
  std::vector<double> impulseChange;   ///< for a unit change of the row that is driven
  std::vector<double> velocityChange;  ///< likewise
  std::vector<double> column;          ///< a product with the inverse, [clamped]
  std::vector<std::int32_t> clamped;   ///< rows whose velocity is held at zero
  std::vector<std::int32_t> placeOf;   ///< of each row in `clamped`, or -1
};

/// What an island of rigid blocks works with. Nothing in it outlives a step; its storage is used again.
struct RigidIsland {
  std::vector<RigidBody> bodies;  ///< [blocks of the island]
  std::vector<RigidContact> contacts;
  PivotingSpace pivoting;
};

}  // namespace springtower
