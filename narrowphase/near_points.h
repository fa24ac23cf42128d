#pragma once

#include "narrowphase/separation.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace springtower {

/// Which of two blocks a normal turns with: the one whose face it is perpendicular to, or both, where two edges cross.
enum class NormalOf : std::uint8_t { a, b, both, world };

/// A point at which two blocks touch, or may touch after a short way: a place on each, and the unit normal from b to a. The gap
/// there is normal . (onA - onB), m, negative where they overlap.
struct NearPoint {
  Vec3 onA;
  Vec3 onB;
  Vec3 normal;
  NormalOf normalOf = NormalOf::world;
  std::uint8_t axis = 0;  ///< points of one separating axis have one number: a face of a, one of b or the floor, two edges
  double beside = 0.0;    ///< m, separation along that axis less the least gap of its points: 0 where its nearest corner is one
};

inline constexpr std::size_t kSeparatingAxes = 3;

/// The outlines of both blocks' nearest faces have at most eight corners each, and a pair of edges crosses once.
inline constexpr std::size_t kMostNearPoints = 17;

struct NearPoints {
  std::array<NearPoint, kMostNearPoints> point;
  std::size_t count = 0;
  bool grazes = false;  ///< whether the blocks graze: the points are those along which they are level, and there may be none
  void add(const NearPoint& one) { point[count++] = one; }
};

/// The points at which two blocks may touch before any of their points has moved by `reach` (m, > 0) against the other block:
/// corners of the overlap of a's nearest face with b's outline along the normal of that face, likewise of b's face with a's, and
/// the crossing of the nearest edges; as far as their gap is at most `reach`, and only along directions whose separation is
/// within `reach` of the best. Of parallel faces those over the face of the block that is higher against `gravity` (m/s2). A
/// manifold (narrowphase/manifold.h) has the points of one of these directions alone, which is enough where it is renewed before
/// another direction matters. `apart`: their separation; `mergeRadius`: points of a face closer than this (m) are one.
/// Preconditions: as of findSeparation.
void findNearPoints(const CornerView& a, const CornerView& b, const Separation& apart, const Vec3& gravity, double reach,
                    double mergeRadius, NearPoints& points);

/// The same against the floor z = 0: the corners no higher than `reach`. The block is a, the floor is b.
void findNearFloorPoints(const CornerView& block, double reach, NearPoints& points);

}  // namespace springtower
