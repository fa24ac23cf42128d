#pragma once

#include "core/block.h"
#include "core/lanes.h"
#include "core/vector.h"
#include "narrowphase/near_points.h"
#include "solver/world/packed_points.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace springtower {

/// Pose and motion of a rigid block.
struct RigidPose {
  Vec3 place = Vec3::Zero();                           ///< m, of its centre
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: its own axes in world axes; orthonormal
  Vec3 velocity = Vec3::Zero();                        ///< m/s
  Vec3 spin = Vec3::Zero();                            ///< rad/s, world axes
};

/// A block in the rigid methods, while its island is stepped through a frame. Between frames the particles are the state: poses
/// are read from them when a frame begins; positions are written back after every step, velocities at the end of the frame.
struct RigidBody : RigidPose {
  std::array<std::array<double, kCorners>, 3> corner{};      ///< m, corners relative to the centre along its own axes
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();          ///< kg m2, of inertia, own axes
  Eigen::Matrix3d inverseMoment = Eigen::Matrix3d::Zero();   ///< 1/(kg m2)
  double inverseMass = 0.0;                                  ///< 1/kg
  double radius_m = 0.0;                                     ///< of its farthest corner from the centre
  Eigen::Matrix3d load = Eigen::Matrix3d::Zero();            ///< J, of what lasts of its contacts (solver/block/static_shape.h)
  Eigen::Matrix3d inverseInertia = Eigen::Matrix3d::Zero();  ///< 1/(kg m2), world axes
  RigidPose before;                                          ///< at the start of the step
  Vec3 velocityBefore = Vec3::Zero();                        ///< m/s, at the start of the substep
  bool struck = false;                                       ///< whether an impact acts on it in the substep
  double removed = 0.0;                                      ///< N s of an impact with which its contacts do not start again
  Vec3 moved = Vec3::Zero();                                 ///< m, displacement so far in the step
  Vec3 turned = Vec3::Zero();                                ///< rad, rotation so far in the step, to first order
  double given_j = 0.0;                                      ///< J, most that contacts have added to its motion in the substep
  double handedOn_j = 0.0;                                   ///< J, likewise through a lighter block that pushes on it
  double mostGiven_j = 0.0;                                  ///< J, both together, one sweep before
  bool pushed = false;                                       ///< whether a contact pushes it in this step
  double fastestPoint_m_s = 0.0;                             ///< upper bound of the speed of its points at the start of the step
};

/// One point of a manifold as a constraint: along the normal the blocks may separate, in the tangents they stick or slip.
struct RigidContact {
  std::int32_t upper = -1;  ///< index of the body in the island; -1 for what does not move: the floor, a sleeping block
  std::int32_t lower = -1;
  std::int32_t pair = 0;  ///< position in engine.pairs
  std::int32_t point = 0;
  std::array<Vec3, 3> direction;     ///< unit: the normal, from lower to upper, and two tangents
  Vec3 armUpper;                     ///< m, from the body's centre to the point
  Vec3 armLower;                     ///< m
  double gap = 0.0;                  ///< m at the start of the step; negative where the blocks overlap
  double coefficient = 0.0;          ///< of friction: static, or kinetic where all points of the manifold slip
  std::array<double, 3> mass{};      ///< kg, effective along each direction
  std::array<double, 3> impulse{};   ///< N s, accumulated along each direction
  std::array<double, 2> anchor_m{};  ///< m, tangential displacement since the point began to stick (position-based method)
  double share = 1.0;                ///< one over the number of points of its manifold
  double loadBefore = 0.0;           ///< N s2, normal position impulse of the step before (position-based method)
  bool sliding = false;              ///< whether friction is at its bound
  double impact = 0.0;               ///< m/s, speed at which the blocks meet if they do in the step; 0: too slow to rebound
  double restitution = 0.0;          ///< of the pair
};

/// One point of two blocks in sequential impulses, as it lasts from substep to substep; `upper` is the pair's first block, or
/// what does not move. The point is fixed to its blocks.
struct ContactConstraint {
  Vec3 placeUpper;               ///< m, in the body's axes from its centre; in the world on what does not move
  Vec3 placeLower;               ///< m, likewise
  Vec3 ownNormal;                ///< the normal in the axes of the body that it turns with, or in the world's
  Vec3 friction = Vec3::Zero();  ///< N s, on upper, tangential
  double push = 0.0;             ///< N s along the normal
  double gap;                    ///< m as it was found; negative where the blocks overlap
  double rest = 0.0;             ///< m, overlap without force
  double before = 0.0;           ///< N s, push of the substep before the last
  double lasting = 0.0;          ///< N s along the normal, mean over about a frame without impacts
  double beside = 0.0;           ///< m, of its separating axis (NearPoint::beside)
  double restitution;            ///< of the pair
  std::int32_t upper;            ///< index of its body in the island; the last index stands for what does not move
  std::int32_t lower;
  NormalOf normalOf;     ///< a: upper, b: lower
  std::uint8_t axis;     ///< number of its separating axis
  bool sliding = false;  ///< whether friction is at its bound
  bool idle = true;      ///< whether its normal and friction impulses are zero so far
};

/// The points of a pair in a list.
struct PointGroup {
  std::int32_t pair;  ///< position in engine.pairs
  std::int32_t first;
  std::int32_t count;
  double reach_m;          ///< all points have been listed that may touch after relative motion by this
  double moved_m;          ///< upper bound of the relative motion since
  std::int32_t pack = -1;  ///< where its points are packed: place in packed.pairs
  std::int32_t lane = 0;
};

/// A pair with its blocks.
struct PairBodies {
  std::int32_t pair;                  ///< position in engine.pairs
  std::array<std::int32_t, 2> block;  ///< the floor -1
  std::array<std::int32_t, 2> body;   ///< indices of their bodies; the last index stands for what does not move
};

/// A pair that was looked at before a step.
struct ListedPair : PairBodies {
  double motion_m = 0.0;  ///< upper bound of its relative motion in the step, at the speeds so far
  double reach_m = 0.0;   ///< its points listed, or that it has none, hold up to this relative motion in the step
};

/// What scratch.covered says of a pair whose blocks have met in the step.
inline constexpr std::uint8_t kCoveredAndMet = 2;

/// Points of an island, pair by pair, ascending.
struct PointList {
  std::vector<ContactConstraint> points;
  std::vector<PointGroup> groups;
};

/// What a range of pairs adds to a list, where ranges are on many threads.
struct ListedRange {
  PointList list;
  std::vector<PairBodies> fastPairs;
};

/// Points on which impulses act.
struct ActingPoints : PointList {
  PackedPoints packed;  ///< impulses are those of the packs from packPoints() to unpackPoints()
};

inline void clear(PointList& list) {
  list.points.clear();
  list.groups.clear();
}

/// Working space of the pivoting method: rows are the contacts' normals, then their tangents.
struct LcpWorkspace {
  std::vector<double> matrix;          ///< 1/kg, velocity change along one row by a unit impulse along another, [rows][rows]
  std::vector<double> inverse;         ///< kg, inverse of the submatrix of clamped rows, [rows][rows], the first of them in use
  std::vector<double> impulse;         ///< N s, [rows]
  std::vector<double> velocity;        ///< m/s, along each row with these impulses
  std::vector<double> least;           ///< N s, bounds of the impulses
  std::vector<double> most;            ///< N s
  std::vector<double> impulseChange;   ///< for a unit change of the driven row
  std::vector<double> velocityChange;  ///< likewise
  std::vector<double> column;          ///< a product with the inverse, [clamped]
  std::vector<std::int32_t> clamped;   ///< rows whose velocity is held at zero
  std::vector<std::int32_t> placeOf;   ///< index of each row in `clamped`, or -1
};

/// Working data of an island of rigid blocks in the part of a frame that is run. Nothing in it outlives that; another island may
/// have it next (WorkPool).
struct RigidIsland {
  std::vector<RigidBody> bodies;  ///< [blocks of the island], then the driven blocks near it, whose inverse mass is 0
  std::vector<RigidContact> contacts;
  // Of `bodies`, and one for what does not move.
  std::vector<BodyPlace> places;
  std::vector<BodyMotion> motions;  ///< velocities in the passes; how far they have moved while gaps are moved
  std::vector<int> changed;         ///< the last pass of an impact that changed a body's velocity
  // Of sequential impulses, in place of `contacts` (solver/rigid/list_points.h).
  ActingPoints steady;                      ///< points found before a step
  ActingPoints fast;                        ///< points found before a substep
  PointList steadyKnown;                    ///< the same of the step before,
  PointList fastKnown;                      ///< of its last substep,
  PointList fastBefore;                     ///< and of the substep before
  std::vector<ListedPair> listedPairs;      ///< looked at for the step, ascending
  std::vector<PairBodies> fastPairs;        ///< of these, whose points are found before a substep
  std::vector<PairBodies> fastPairsBefore;  ///< working space
  std::vector<std::uint8_t> outruns;  ///< of each body: 1 where its velocity has changed in the step by more than the listed
                                      ///< points allow; and 0 for what does not move
  std::vector<ListedRange> ranges;    ///< working space, where points are listed on many threads
  bool knowsManifolds = false;        ///< points start with the forces of manifolds where no others are known
  double energyBefore_j = 0.0;        ///< kinetic energy before the step plus the work of gravity, forces and the hand in it
  Vec3 handForce = Vec3::Zero();      ///< N, in the step
  Vec3 handTorque = Vec3::Zero();     ///< N m, about the centre of the block that it holds
  bool rebounds = false;              ///< whether blocks have met in the frame so fast that they rebound
  bool stands = false;                ///< whether half of the blocks at least have not fallen since they slept last
  double massRatio = 1.0;             ///< of its heaviest to its lightest body, of those that impulses move
  double gained_j = 0.0;              ///< kinetic energy in the frame so far beyond this work; < 0: lost
  bool touches = false;               ///< whether any contact pushes in the step
  LcpWorkspace pivoting;
};

template <class Island>
auto listsOf(Island& island) {
  using List = std::conditional_t<std::is_const_v<Island>, const PointList, PointList>;
  return std::array<List*, 5>{&island.steady, &island.fast, &island.steadyKnown, &island.fastKnown, &island.fastBefore};
}

template <class Island>
auto packsOf(Island& island) {
  return std::array{&island.steady.packed, &island.fast.packed};
}

/// The index that stands for what does not move: the floor, sleeping blocks.
inline std::int32_t unmovedBody(const RigidIsland& island) {
  return static_cast<std::int32_t>(island.bodies.size());
}

}  // namespace springtower
