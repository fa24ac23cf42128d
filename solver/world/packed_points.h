#pragma once

#include "core/lane_vector.h"
#include "narrowphase/near_points.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

// Points of rigid blocks as constraints, four pairs of blocks side by side in lanes. Pairs are coloured so that no body that
// moves is in two pairs of one colour: those of a colour may be solved in any order, and on any threads.

/// Pairs of blocks side by side.
inline constexpr int kPackedPairs = 4;
using PackedIndex = std::array<std::int32_t, kPackedPairs>;

/// Velocity of a body (m/s; rad/s), or how far it has moved in a substep (m; rad). Vectors fill three of four lanes.
struct alignas(32) BodyMotion {
  Lanes linear;
  Lanes angular;
};

/// Place and mass of a body as constraints need them. Vectors fill three of four lanes.
struct alignas(32) BodyPlace {
  Lanes centre;             ///< m
  Lanes axes[3];            ///< columns: its own axes in the world's
  Lanes inverseInertia[3];  ///< 1/(kg m2), columns, world axes
  double inverseMass;       ///< 1/kg; 0 of what does not move
  double flies;             ///< 1 where it moves and no contact pushed it in the substep before, else 0
};

/// Symmetric 3 x 3 matrices.
struct LaneMatrix {
  Lanes xx, xy, xz, yy, yz, zz;
};

/// Four pairs. A lane without one has bodies that do not move, and points without mass.
struct alignas(32) PackedPair {
  PackedIndex upper;        ///< index of the body; the last index stands for what does not move
  PackedIndex lower;        ///< likewise
  PackedIndex group;        ///< place in the list of groups; -1: none
  std::int32_t first;       ///< place of its first packed points
  std::int32_t rows;        ///< and how many these are: the most points of any of the four
  std::int32_t pushing;     ///< points that push or have pushed, as of the first pass of a substep
  std::int32_t nearby;      ///< these and others that nearly touch, at which the further passes look; of all four
  PackedIndex active;       ///< and of each; at most so many where an impact has reached points that were not near
  std::uint8_t movesUpper;  ///< bit by lane: whether the upper body moves by impulses
  std::uint8_t movesLower;
  bool slips;  ///< whether friction acts elsewhere than at the points in any lane
  Lanes staticFriction;
  Lanes kineticFriction;
  Lanes restitution;
  Lanes inverseMassUpper;  ///< 1/kg
  Lanes inverseMassLower;
  LaneMatrix inertiaUpper;  ///< 1/(kg m2), inverse, world axes
  LaneMatrix inertiaLower;
};

/// A point of each of four pairs, in a substep.
struct alignas(32) PackedPoint {
  LaneVector normal;    ///< unit, from lower to upper
  LaneVector armUpper;  ///< m, from the body's centre to half way between the point's two places
  LaneVector armLower;
  LaneVector turnUpper;      ///< rad/s, change of the body's spin by an impulse of 1 N s along the normal
  LaneVector turnLower;      ///< likewise, with opposite sign
  LaneVector friction;       ///< N s, on upper, tangential
  Lanes push;                ///< N s along the normal
  Lanes normalMass;          ///< kg, effective along the normal; 0 of a lane without a point
  Lanes acrossMass;          ///< kg, lower bound of the effective tangential mass
  Lanes gap;                 ///< m at the start of the substep; negative where the blocks overlap by more than without force
  Lanes closing;             ///< m, <= 0: what turning closes of it within the substep beyond what velocities at its start say
  Lanes coefficient;         ///< of friction: static, or kinetic where all points of the pair slip
  Lanes rebound;             ///< m/s, speed at which the blocks part after an impact; the lowest number where there is none
  LaneMask idle;             ///< whether its normal and friction impulses are zero so far
  LaneMask sliding;          ///< whether friction is at its bound
  Lanes impact;              ///< m/s, speed at which the blocks meet if they do in the substep; 0: too slow to rebound
  Lanes before;              ///< N s, push with which the substep began
  Lanes softness;            ///< m/(N s), compliance of its springs over the substep; 0 in the rigid methods
  Lanes deepest;             ///< m, how deep they are at most by it: what is more than its mean over about a frame is an impact
  LaneVector towardsCentre;  ///< m, from the point to where its friction acts; read where PackedPair::slips is set
};

/// Where its blocks have it. Own axes are those of a body; of what does not move the world's.
struct alignas(32) PackedPlace {
  LaneVector upper;   ///< m, from the upper body's centre in its axes
  LaneVector lower;   ///< m, likewise
  LaneVector normal;  ///< in the axes of the body that it turns with, or the world's
  LaneMask kind;      ///< bits: kTurnsUpper or kTurnsLower, and of its separating axis kAxisBit << 0, 1 or 2
  Lanes rest;         ///< m, overlap without force
  Lanes beside;       ///< m, of its separating axis (NearPoint::beside)
  Lanes compliance;   ///< m/N, of its springs; 0 in the rigid methods
  Lanes lasting;      ///< N s along the normal, mean over about a frame
};

inline constexpr std::int64_t kTurnsUpper = 1;  ///< the normal turns with the upper body
inline constexpr std::int64_t kTurnsLower = 2;  ///< or with the lower one
inline constexpr std::int64_t kAxisBit = 4;

/// The points of a list, packed for the substeps of a step.
struct PackedPoints {
  std::vector<PackedPair> pairs;  ///< by colour
  std::vector<PackedPoint> points;
  std::vector<PackedPlace> places;        ///< of each of `points`
  std::vector<std::int32_t> colourStart;  ///< of each colour in `pairs`, and their end
  std::vector<std::int32_t> active;       ///< of `pairs`, those with points that touch in the substep or nearly do
  std::vector<std::int32_t> activeStart;  ///< of each colour in `active`, and their end
  std::size_t activePoints = 0;           ///< points that touch or nearly do
  std::vector<std::int32_t> bodyStart;    ///< of each body in `bodyPairs`, and their end; empty before listPairsOfBodies()
  std::vector<std::int32_t> bodyPairs;    ///< of `pairs`, those in which it is
  std::vector<int> due;                   ///< of each of `pairs`, the last pass of an impact that is to look at it
  // Working space of packPoints().
  std::vector<std::array<std::uint64_t, 2>> taken;  ///< colours of each body, by bit: among what moves, with what does not
  std::vector<std::uint8_t> kind;
  std::vector<std::int32_t> key;
  std::vector<std::int32_t> keyStart;
  std::vector<std::int32_t> order;
};

}  // namespace springtower
