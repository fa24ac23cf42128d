#pragma once

#include "core/state.h"

#include <algorithm>
#include <cmath>

namespace springtower {

/// The eight corners of one block inside a ParticleArray: three runs of eight doubles.
struct CornerView {
  const double* x;
  const double* y;
  const double* z;
  [[nodiscard]] Vec3 at(int corner) const { return {x[corner], y[corner], z[corner]}; }
};

/// A view of a block's corners. Valid while the array is not resized.
inline CornerView cornersOf(const ParticleArray& array, std::size_t block) {
  return {array.values(0, block), array.values(1, block), array.values(2, block)};
}

/// Gap between two blocks along a unit direction `normal` that points from `lower` to `upper`, m; negative where they overlap.
/// For corners that move linearly the gap along a fixed direction is concave in time (a minimum of linear functions), so a
/// direction that separates at both ends of a step separates throughout it: Baraff's witness (report 2.3.4).
double gapAlong(const Vec3& normal, const CornerView& upper, const CornerView& lower);

/// The best separating directions of two blocks, from the fifteen separating axes of two cuboids (report 2.3.3), for the blocks'
/// actual corners. Separations are gaps in m (negative: overlap along that axis). Normals are unit and point from block b to
/// block a.
struct Separation {
  double faceA = 0.0;  ///< best over a's face normals
  double faceB = 0.0;  ///< best over b's face normals
  double edge = 0.0;   ///< best over crossed edges; minus infinity where all are nearly parallel
  int faceOfA = 0;     ///< a's face towards b
  int faceOfB = 0;     ///< b's face towards a
  int edgeOfA = 0;
  int edgeOfB = 0;
  Vec3 normalFaceA;
  Vec3 normalFaceB;
  Vec3 normalEdge;
  // The largest separation along a face normal of both blocks more than 45 degrees from the best one; minus infinity if there is
  // none. Negative: overlap.
  double level = 0.0;
  int levelFaceOfA = 0;
  int levelFaceOfB = 0;
  Vec3 normalLevel;
  Vec3 between;  ///< from b's centre to a's, m

  /// The largest of the three: where positive, a lower bound of the distance.
  [[nodiscard]] double best() const { return std::max(edge, std::max(faceA, faceB)); }
  [[nodiscard]] const Vec3& bestNormal() const {
    if (edge > faceA && edge > faceB) return normalEdge;
    return faceA > faceB ? normalFaceA : normalFaceB;
  }
};

/// Whether b's face counts where faces of both separate as well: that of the block that is higher against gravity (m/s2); b's
/// where their centres are level to within `level_m`. So it matters which block is named first only for blocks side by side.
/// Without gravity "higher" is along z.
inline bool prefersFaceOfB(const Separation& apart, const Vec3& gravity, double level_m) {
  const double size = gravity.norm();
  return (size > 0.0 ? -apart.between.dot(gravity) / size : apart.between.z()) <= level_m;
}

/// Computes it for blocks a and b. Precondition: no block is turned inside out.
Separation findSeparation(const CornerView& a, const CornerView& b);

/// When two blocks graze rather than meet.
struct GrazingLimits {
  double overlap_m;  ///< most overlap along the direction along which they are level, and most gap
  double speed_m_s;  ///< least speed across it
};

/// Whether two blocks only graze along their best direction: level with one another across it, they overlap there by little or
/// are apart by as little, and move faster along the best direction. A block that slides over a seam has sunk a little into what
/// it slides on, and would run into the side of what comes next. `velocity`: of a against b, m/s.
inline bool grazes(const Separation& apart, const GrazingLimits& limits, const Vec3& velocity) {
  const double across = std::abs(velocity.dot(apart.bestNormal()));
  return std::abs(apart.level) <= limits.overlap_m && apart.best() > apart.level && across > limits.speed_m_s &&
         across > std::abs(velocity.dot(apart.normalLevel));
}

/// The separation with that direction alone, along which they are level. Precondition: they graze.
Separation alongLevel(const Separation& apart);

}  // namespace springtower
