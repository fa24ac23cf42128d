#pragma once

#include "core/block.h"
#include "core/lanes.h"
#include "core/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// Where a rigid block is and how it moves.
struct RigidPose {
  Vec3 place = Vec3::Zero();                           ///< m, of its centre
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< its own axes in the world's, as columns; orthonormal
  Vec3 velocity = Vec3::Zero();                        ///< m/s
  Vec3 spin = Vec3::Zero();                            ///< rad/s, world axes
};

/// A block as the rigid methods see it, while its island is stepped through a frame. Between frames the particles are the state:
/// poses are read from them when a frame begins, and positions written back after every step, velocities when it ends.
struct RigidBody : RigidPose {
  std::array<std::array<double, kCorners>, 3> corner{};      ///< m, of its corners from its centre along its own axes
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();          ///< kg m2, of inertia, own axes
  Eigen::Matrix3d inverseMoment = Eigen::Matrix3d::Zero();   ///< 1/(kg m2)
  double inverseMass = 0.0;                                  ///< 1/kg
  Eigen::Matrix3d inverseInertia = Eigen::Matrix3d::Zero();  ///< 1/(kg m2), world axes
  RigidPose before;                                          ///< when the step began
  Vec3 moved = Vec3::Zero();                                 ///< m, by which the step has moved it so far
  Vec3 turned = Vec3::Zero();                                ///< rad, by which the step has turned it, to first order
  bool pushed = false;                                       ///< whether a contact pushes it in this step
};

/// One point of a manifold as a constraint: along its normal the blocks may part, across it they stick or slide.
struct RigidContact {
  std::int32_t upper = -1;  ///< place of the body in the island; -1 for what does not move: the floor, a sleeping block
  std::int32_t lower = -1;
  std::int32_t pair = 0;  ///< position in engine.pairs
  std::int32_t point = 0;
  std::array<Vec3, 3> direction;     ///< unit: the normal, from lower to upper, and two tangents
  Vec3 armUpper;                     ///< m, from the body's centre to the point
  Vec3 armLower;                     ///< m
  double gap = 0.0;                  ///< m when the step began; negative where the blocks overlap
  double coefficient = 0.0;          ///< of friction, static or kinetic as the point did last
  std::array<double, 3> mass{};      ///< kg, effective along each direction
  std::array<double, 3> impulse{};   ///< N s, accumulated along each direction
  std::array<double, 2> anchor_m{};  ///< m, tangential displacement since the point took hold (position-based method)
  double share = 1.0;                ///< one over the points of its manifold
  double loadBefore = 0.0;           ///< N s2, normal push of the step before (position-based method)
  bool sliding = false;              ///< whether friction is at its bound
};

/// A body as the passes over the contacts see it. Vectors fill three of four lanes.
struct alignas(32) SolverBody {
  Lanes velocity;           ///< m/s
  Lanes spin;               ///< rad/s
  Lanes inverseInertia[3];  ///< 1/(kg m2), columns, world axes
  double inverseMass;       ///< 1/kg; 0 of what does not move
};

/// One point of a manifold as sequential impulses see it. Vectors fill three of four lanes.
struct alignas(32) ContactConstraint {
  Lanes normal;        ///< unit, from lower to upper
  Lanes armUpper;      ///< m, from the body's centre to the point
  Lanes armLower;      ///< m
  Lanes leverUpper;    ///< m, arm x normal
  Lanes leverLower;    ///< m
  Lanes turnUpper;     ///< rad/s that the body gains by an impulse of 1 N s along the normal
  Lanes turnLower;     ///< likewise, with the other sign
  Lanes friction;      ///< N s, on upper, across the normal
  double push;         ///< N s along the normal
  double normalMass;   ///< kg, effective along the normal
  double acrossMass;   ///< kg, effective across it, at least
  double gap;          ///< m when the step began; negative where the blocks overlap by more than is left as it is
  double coefficient;  ///< of friction, static or kinetic as the point did last
  std::int32_t upper;  ///< place of its body among the island's; the last one is what does not move
  std::int32_t lower;
  std::int32_t pair;   ///< position in engine.pairs
  std::int32_t point;  ///< of its manifold
  bool sliding;        ///< whether friction is at its bound
  bool idle;           ///< whether it pushes and rubs not at all so far
};

/// Working space of the pivoting method: rows are the contacts' normals, then their tangents.
struct LcpWorkspace {
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
  std::vector<SolverBody> movers;         ///< those of `bodies`, and what does not move
  std::vector<ContactConstraint> points;  ///< of the method of sequential impulses, in place of `contacts`
  std::vector<ContactConstraint> known;   ///< those of the attempt before, in steps taken again
  double energyBefore_j = 0.0;            ///< kinetic energy before the step, and what gravity has added in it
  bool touches = false;                   ///< whether any contact pushes in the step
  LcpWorkspace pivoting;
};

}  // namespace springtower
