#include "narrowphase/separation.h"

#include "core/elementary.h"
#include "core/lanes.h"
#include "core/tuning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace springtower {

namespace {

// Mean edges and face normals: in a sheared block a face normal is not parallel to the edges that leave the face.
struct Frame {
  Vec3 centre;
  std::array<Vec3, 3> axis;
  std::array<Vec3, 3> normal;
};

Frame frameOf(const CornerView& block) {
  Frame frame;
  Vec3 sum = Vec3::Zero();
  std::array<Vec3, 3> edge = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 p = block.at(static_cast<int>(c));
    sum += p;
    for (std::size_t a = 0; a < 3; ++a) edge[a] += cornerSide(c, a) * p;
  }
  frame.centre = sum / static_cast<double>(kCorners);
  for (std::size_t a = 0; a < 3; ++a) frame.axis[a] = edge[a].normalized();
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 normal = edge[(a + 1) % 3].cross(edge[(a + 2) % 3]);
    frame.normal[a] = normal.normalized();
  }
  return frame;
}

// Positions of a block's corners along a direction, in two groups of four.
SPRINGTOWER_INLINE void project(const Vec3& normal, const CornerView& block, Lanes& first, Lanes& second) {
  Lanes x, y, z;
  load(block.x, x);
  load(block.y, y);
  load(block.z, z);
  first = normal.x() * x + normal.y() * y + normal.z() * z;
  load(block.x + 4, x);
  load(block.y + 4, y);
  load(block.z + 4, z);
  second = normal.x() * x + normal.y() * y + normal.z() * z;
}

SPRINGTOWER_INLINE double gapOf(const Vec3& normal, const CornerView& upper, const CornerView& lower) {
  Lanes first, second;
  project(normal, upper, first, second);
  const Lanes least = first < second ? first : second;
  project(normal, lower, first, second);
  const Lanes most = first > second ? first : second;
  return std::min(std::min(least[0], least[1]), std::min(least[2], least[3])) -
         std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
}

// The edge of a block along an axis that is farthest in a direction.
int extremeEdge(const Frame& frame, std::size_t axis, const Vec3& towards) {
  const std::size_t first = axis == 0 ? 1 : 0;
  const std::size_t second = axis == 2 ? 1 : 2;
  const int low = frame.axis[first].dot(towards) > 0.0 ? 1 : 0;
  const int high = frame.axis[second].dot(towards) > 0.0 ? 1 : 0;
  return static_cast<int>(4 * axis) + low + 2 * high;
}

// The face of a block with a normal of its frame, outwards or inwards.
int faceAlong(std::size_t axis, bool outwards) {
  return static_cast<int>(2 * axis) + (outwards ? 1 : 0);
}

// Fills in `level` from the gaps along the face normals of both. Of two normals that are nearly one, that along which the gap is
// larger: it is the gap where the blocks meet, not at their far ends.
void setLevel(const Frame& frameA, const Frame& frameB, const Vec3& between, const std::array<double, 3>& gapA,
              const std::array<double, 3>& gapB, Separation& result) {
  result.level = -std::numeric_limits<double>::infinity();
  const Vec3& best = result.bestNormal();
  for (std::size_t ofB = 0; ofB < 3; ++ofB) {
    if (2.0 * elementary::square(frameB.normal[ofB].dot(best)) > 1.0) continue;
    for (std::size_t ofA = 0; ofA < 3; ++ofA) {
      const double gap = std::max(gapA[ofA], gapB[ofB]);
      const double along = frameA.normal[ofA].dot(frameB.normal[ofB]);
      if (!(gap > result.level) || std::abs(along) <= tuning::kParallelFaces) continue;
      const Vec3& normal = gapA[ofA] > gapB[ofB] ? frameA.normal[ofA] : frameB.normal[ofB];
      const bool isAboveB = frameB.normal[ofB].dot(between) >= 0.0;  // a over b along it
      result.level = gap;
      result.normalLevel = normal.dot(between) >= 0.0 ? normal : Vec3(-normal);
      result.levelFaceOfB = faceAlong(ofB, isAboveB);
      result.levelFaceOfA = faceAlong(ofA, (along > 0.0) != isAboveB);
    }
  }
}

}  // namespace

SPRINGTOWER_KERNEL
double gapAlong(const Vec3& normal, const CornerView& upper, const CornerView& lower) {
  return gapOf(normal, upper, lower);
}

SPRINGTOWER_KERNEL
Separation findSeparation(const CornerView& a, const CornerView& b) {
  constexpr double kNothing = -std::numeric_limits<double>::infinity();

  const Frame frameA = frameOf(a);
  const Frame frameB = frameOf(b);
  const Vec3 between = frameA.centre - frameB.centre;

  Separation result;
  result.between = between;
  std::array<double, 3> gapA;
  std::array<double, 3> gapB;
  result.faceA = result.faceB = result.edge = kNothing;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool along = frameB.normal[axis].dot(between) >= 0.0;
    const Vec3 normal = along ? frameB.normal[axis] : Vec3(-frameB.normal[axis]);
    const double gap = gapB[axis] = gapOf(normal, a, b);
    if (gap > result.faceB) {
      result.faceB = gap;
      result.faceOfB = static_cast<int>(2 * axis) + (along ? 1 : 0);
      result.normalFaceB = normal;
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool along = frameA.normal[axis].dot(between) >= 0.0;
    const Vec3 normal = along ? frameA.normal[axis] : Vec3(-frameA.normal[axis]);
    const double gap = gapA[axis] = gapOf(normal, a, b);
    if (gap > result.faceA) {
      result.faceA = gap;
      result.faceOfA = static_cast<int>(2 * axis) + (along ? 0 : 1);
      result.normalFaceA = normal;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      Vec3 normal = frameA.axis[i].cross(frameB.axis[j]);
      const double length = normal.norm();
      if (length < tuning::kMinEdgeCross) continue;
      normal /= normal.dot(between) >= 0.0 ? length : -length;
      const double gap = gapOf(normal, a, b);
      if (gap > result.edge) {
        result.edge = gap;
        result.normalEdge = normal;
        result.edgeOfA = extremeEdge(frameA, i, -normal);
        result.edgeOfB = extremeEdge(frameB, j, normal);
      }
    }
  }
  setLevel(frameA, frameB, between, gapA, gapB, result);
  return result;
}

Separation alongLevel(const Separation& apart) {
  Separation level = apart;
  level.faceA = level.faceB = apart.level;
  level.edge = -std::numeric_limits<double>::infinity();
  level.faceOfA = apart.levelFaceOfA;
  level.faceOfB = apart.levelFaceOfB;
  level.normalFaceA = level.normalFaceB = apart.normalLevel;
  return level;
}

}  // namespace springtower
