#include "narrowphase/turning_face.h"

#include "core/lanes.h"

#include <algorithm>
#include <limits>

namespace springtower {

namespace {

struct Edges {
  Vec3 along[3];
};

// Four times the mean edges.
SPRINGTOWER_INLINE void edgesOf(const CornerView& block, Edges& edges) {
  const double* corners[3] = {block.x, block.y, block.z};
  for (int k = 0; k < 3; ++k) {
    Lanes low, high;
    load(corners[k], low);
    load(corners[k] + 4, high);
    const Lanes both = low + high;
    edges.along[0][k] = (both[1] + both[3]) - (both[0] + both[2]);
    edges.along[1][k] = (both[2] + both[3]) - (both[0] + both[1]);
    edges.along[2][k] = sum(high) - sum(low);
  }
}

SPRINGTOWER_INLINE void project(const Vec3& direction, const CornerView& block, std::size_t half, Lanes& height) {
  Lanes x, y, z;
  load(block.x + 4 * half, x);
  load(block.y + 4 * half, y);
  load(block.z + 4 * half, z);
  height = direction.x() * x + direction.y() * y + direction.z() * z;
}

// Bernstein coefficients of the heights of a block's corners along a normal that is itself quadratic.
SPRINGTOWER_INLINE void heights(const Vec3* normal, const MovingBlock& block, std::size_t half, Lanes* coefficient) {
  Lanes middleOfStart, startOfEnd, endOfStart, middleOfEnd;
  project(normal[0], block.start, half, coefficient[0]);
  project(normal[1], block.start, half, middleOfStart);
  project(normal[2], block.start, half, endOfStart);
  project(normal[0], block.end, half, startOfEnd);
  project(normal[1], block.end, half, middleOfEnd);
  project(normal[2], block.end, half, coefficient[3]);
  coefficient[1] = (2.0 * middleOfStart + startOfEnd) / 3.0;
  coefficient[2] = (endOfStart + 2.0 * middleOfEnd) / 3.0;
}

}  // namespace

SPRINGTOWER_KERNEL
TurningGap gapAlongTurningFace(const Vec3& normal, const MovingBlock& a, const MovingBlock& b) {
  Edges start[2], end[2];
  edgesOf(a.start, start[0]);
  edgesOf(b.start, start[1]);
  double nearest = -1.0;
  std::size_t block = 0, first = 0, second = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vec3 face = start[i].along[(axis + 1) % 3].cross(start[i].along[(axis + 2) % 3]);
      const double cosine = face.dot(normal);
      const double near = cosine * cosine / face.squaredNorm();
      if (!(near > nearest)) continue;
      nearest = near;
      block = i;
      first = (axis + 1) % 3;
      second = (axis + 2) % 3;
    }
  }
  edgesOf(block == 0 ? a.end : b.end, end[block]);
  const Vec3 &u0 = start[block].along[first], &v0 = start[block].along[second];
  const Vec3 &u1 = end[block].along[first], &v1 = end[block].along[second];
  Vec3 turning[3] = {u0.cross(v0), 0.5 * (u0.cross(v1) + u1.cross(v0)), u1.cross(v1)};
  const double scale = (turning[0].dot(normal) >= 0.0 ? 1.0 : -1.0) / turning[0].norm();
  for (Vec3& n : turning) n *= scale;

  Lanes upper[2][4], lower[2][4];
  for (std::size_t half = 0; half < 2; ++half) {
    heights(turning, a, half, upper[half]);
    heights(turning, b, half, lower[half]);
  }
  TurningGap gap{std::numeric_limits<double>::infinity(), turning[2].normalized()};
  for (std::size_t k = 0; k < 4; ++k) {
    const Lanes least = upper[0][k] < upper[1][k] ? upper[0][k] : upper[1][k];
    const Lanes most = lower[0][k] > lower[1][k] ? lower[0][k] : lower[1][k];
    const double here = std::min(std::min(least[0], least[1]), std::min(least[2], least[3])) -
                        std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
    gap.least = std::min(here, gap.least);  // NaN for a face without area
  }
  return gap;
}

}  // namespace springtower
