#pragma once

#include "core/lanes.h"
#include "solver/block/affine.h"

#include <algorithm>

namespace springtower {

// Positions of a manifold's points on its blocks, for kernels that process four at a time.

/// A block's face in the form that SIMD kernels use: centre and sides of its place or of its motion.
struct FaceField {
  double centre[3];
  double sideU[3];
  double sideV[3];
};

/// The face of a field of places, m, or velocities, m/s.
SPRINGTOWER_INLINE void faceOf(const AffineField& field, const FaceAxes& face, FaceField& result) {
  for (std::size_t k = 0; k < 3; ++k) {
    result.centre[k] = field.centre[k] + face.side * field.side[face.across][k];
    result.sideU[k] = field.side[face.u][k];
    result.sideV[k] = field.side[face.v][k];
  }
}

/// The field at four places of the face (u, v: -1/2..1/2), one array of lanes a component.
SPRINGTOWER_INLINE void at(const FaceField& face, const Lanes& u, const Lanes& v, Lanes* result) {
  for (int k = 0; k < 3; ++k) result[k] = face.centre[k] + u * face.sideU[k] + v * face.sideV[k];
}

/// An edge of a block: its middle and its side, and its axes (see kEdgeCorners).
struct EdgeAxes {
  std::size_t along;
  std::size_t first;
  std::size_t second;
  double sideFirst;
  double sideSecond;
};

SPRINGTOWER_INLINE EdgeAxes edgeAxes(int edge) {
  const auto along = static_cast<std::size_t>(edge / 4);
  const std::size_t first = along == 0 ? 1 : 0;
  const std::size_t second = along == 2 ? 1 : 2;
  return {along, first, second, (edge & 1) != 0 ? 0.5 : -0.5, (edge & 2) != 0 ? 0.5 : -0.5};
}

/// A component of the field on an edge (t: -1/2..1/2).
SPRINGTOWER_INLINE double onEdge(const AffineField& field, const EdgeAxes& edge, double t, std::size_t k) {
  return field.centre[k] + edge.sideFirst * field.side[edge.first][k] + edge.sideSecond * field.side[edge.second][k] +
         t * field.side[edge.along][k];
}

SPRINGTOWER_INLINE double dot(const double* p, const double* q) {
  return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

/// Two crossing edges: their common normal towards upper, unit; the positions of closest approach on each; and their distance
/// there along the normal, m.
struct Crossing {
  double normal[3];
  double onUpper;
  double onLower;
  double gap;
};

SPRINGTOWER_INLINE void crossingOf(const AffineField& upper, const EdgeAxes& edgeUpper, const AffineField& lower,
                                   const EdgeAxes& edgeLower, Crossing& result) {
  const double* d1 = upper.side[edgeUpper.along].data();
  const double* d2 = lower.side[edgeLower.along].data();
  double arm[3], towardsUpper[3];
  for (std::size_t k = 0; k < 3; ++k) {
    arm[k] = onEdge(upper, edgeUpper, 0.0, k) - onEdge(lower, edgeLower, 0.0, k);
    towardsUpper[k] = upper.centre[k] - lower.centre[k];
  }
  const double cross[3] = {d1[1] * d2[2] - d1[2] * d2[1], d1[2] * d2[0] - d1[0] * d2[2], d1[0] * d2[1] - d1[1] * d2[0]};
  const double squared = dot(cross, cross);
  const double inverse = (dot(cross, towardsUpper) >= 0.0 ? 1.0 : -1.0) / __builtin_sqrt(squared);
  const double b1 = dot(d1, arm);
  const double b2 = dot(d2, arm);
  const double t1 = std::clamp((dot(d1, d2) * b2 - dot(d2, d2) * b1) / squared, -0.5, 0.5);
  const double t2 = std::clamp((dot(d1, d1) * b2 - dot(d1, d2) * b1) / squared, -0.5, 0.5);
  double gap[3];
  for (std::size_t k = 0; k < 3; ++k) {
    result.normal[k] = cross[k] * inverse;
    gap[k] = arm[k] + t1 * d1[k] - t2 * d2[k];
  }
  result.onUpper = t1;
  result.onLower = t2;
  result.gap = dot(gap, result.normal);
}

}  // namespace springtower
