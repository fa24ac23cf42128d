#include "narrowphase/near_points.h"

#include "core/block.h"
#include "core/tuning.h"
#include "narrowphase/manifold.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springtower {

namespace {

// Numbers of the separating axes.
constexpr std::uint8_t kFaceOfA = 0;
constexpr std::uint8_t kFaceOfB = 1;
constexpr std::uint8_t kCrossing = 2;

// The corner of an outline from which its points are listed: rounding may decide with which corner clipping begins, and the order
// of points is that in which they are solved. The first one counterclockwise of a direction in which no corner of rectangles that
// lie flush or across lies, seen from the middle.
std::size_t firstPoint(const Manifold& outline) {
  const auto count = static_cast<std::size_t>(outline.count);
  double u = 0.0;
  double v = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    u += outline.place[rowOf(i)].u[laneOf(i)] / static_cast<double>(count);
    v += outline.place[rowOf(i)].v[laneOf(i)] / static_cast<double>(count);
  }
  std::size_t first = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < count; ++i) {
    const double x = outline.place[rowOf(i)].u[laneOf(i)] - u;
    const double y = outline.place[rowOf(i)].v[laneOf(i)] - v;
    const double along = x + 0.1 * y;
    const double across = y - 0.1 * x;
    const double share = along / (std::abs(along) + std::abs(across));
    const double angle = across >= 0.0 ? 1.0 - share : 3.0 + share;  // grows with the angle, from 0 to 4
    if (angle < least) {
      least = angle;
      first = i;
    }
  }
  return first;
}

// Points of the incident block's face over the reference face. `onA`: whether the incident block is a.
void addFacePoints(const CornerView& incident, const CornerView& reference, int referenceFace, const ManifoldLimits& limits,
                   bool onA, NearPoints& points) {
  const FaceFrame face = faceFrame(reference, referenceFace);
  Manifold outline;
  buildFaceManifold(incident, reference, incidentFaceOf(incident, face.normal), referenceFace, limits, outline);
  const auto count = static_cast<std::size_t>(outline.count);
  const std::size_t first = firstPoint(outline);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 place = pointOnIncidentFace(outline, incident, (first + i) % count);
    const double gap = face.normal.dot(place - face.centre);
    if (gap > limits.reach) continue;
    const Vec3 below = place - gap * face.normal;
    if (onA) {
      points.add({place, below, face.normal, NormalOf::b, kFaceOfB});
    } else {
      points.add({below, place, -face.normal, NormalOf::a, kFaceOfA});
    }
  }
}

// Where two edges come nearest, within their ends. Of edges that are nearly parallel this would be anywhere, and the ends of both
// are among the points of faces.
void addCrossing(const CornerView& a, const CornerView& b, const Separation& apart, NearPoints& points) {
  const auto& cornersA = kEdgeCorners[static_cast<std::size_t>(apart.edgeOfA)];
  const auto& cornersB = kEdgeCorners[static_cast<std::size_t>(apart.edgeOfB)];
  const Vec3 fromA = a.at(cornersA[0]);
  const Vec3 fromB = b.at(cornersB[0]);
  const Vec3 alongA = a.at(cornersA[1]) - fromA;
  const Vec3 alongB = b.at(cornersB[1]) - fromB;
  const Vec3 between = fromB - fromA;
  const double aa = alongA.squaredNorm();
  const double bb = alongB.squaredNorm();
  const double ab = alongA.dot(alongB);
  const double determinant = aa * bb - ab * ab;
  if (determinant < (1.0 - tuning::kParallelFaces * tuning::kParallelFaces) * aa * bb) return;
  const double onA = (bb * between.dot(alongA) - ab * between.dot(alongB)) / determinant;
  const double onB = (ab * between.dot(alongA) - aa * between.dot(alongB)) / determinant;
  points.add({fromA + std::clamp(onA, 0.0, 1.0) * alongA, fromB + std::clamp(onB, 0.0, 1.0) * alongB, apart.normalEdge,
              NormalOf::both, kCrossing});
}

double gapOf(const NearPoint& point) {
  return point.normal.dot(point.onA - point.onB);
}

// By how much the separation along each axis is less than the gaps of its points. Of edges that cross along the normal of a face
// the crossing is somewhere else after a small rotation: that they are apart says nothing.
void setBeside(const Separation& apart, NearPoints& points) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::array<double, kSeparatingAxes> least = {kNone, kNone, kNone};
  for (std::size_t i = 0; i < points.count; ++i)
    least[points.point[i].axis] = std::min(least[points.point[i].axis], gapOf(points.point[i]));
  const double along = std::max(apart.normalEdge.dot(apart.normalFaceA), apart.normalEdge.dot(apart.normalFaceB));
  const double edge = along < tuning::kLastingCrossing ? apart.edge : -kNone;
  const std::array<double, kSeparatingAxes> separation = {apart.faceA, apart.faceB, edge};
  for (std::size_t i = 0; i < points.count; ++i) {
    const std::size_t axis = points.point[i].axis;
    points.point[i].beside = std::min(0.0, separation[axis] - least[axis]);
  }
}

}  // namespace

void findNearPoints(const CornerView& a, const CornerView& b, const Separation& apart, const Vec3& gravity, double reach,
                    double mergeRadius, NearPoints& points) {
  points.count = 0;
  const double least = apart.best() - reach;
  if (apart.best() > reach) return;
  const ManifoldLimits limits{mergeRadius, reach};
  // Of two that are alike always the same.
  const bool prefersB = prefersFaceOfB(apart, gravity, mergeRadius);
  const bool isFaceOfB = prefersB ? apart.faceB + mergeRadius >= apart.faceA : apart.faceB > apart.faceA + mergeRadius;
  const auto addFaces = [&](bool ofB) {
    if ((ofB ? apart.faceB : apart.faceA) < least) return;
    addFacePoints(ofB ? a : b, ofB ? b : a, ofB ? apart.faceOfB : apart.faceOfA, limits, ofB, points);
  };
  addFaces(isFaceOfB);
  // Of parallel faces both outlines are the same.
  const bool parallel = apart.normalFaceA.dot(apart.normalFaceB) > tuning::kParallelFaces;
  if (points.count == 0 || !parallel) addFaces(!isFaceOfB);
  const Vec3& face = isFaceOfB ? apart.normalFaceB : apart.normalFaceA;
  const bool crosses = std::isfinite(apart.edge) && apart.edge >= least;
  if (crosses && (points.count == 0 || apart.normalEdge.dot(face) < tuning::kParallelFaces)) addCrossing(a, b, apart, points);
  setBeside(apart, points);
}

void findNearFloorPoints(const CornerView& block, double reach, NearPoints& points) {
  points.count = 0;
  for (int c = 0; c < static_cast<int>(kCorners); ++c) {
    const Vec3 corner = block.at(c);
    if (corner.z() > reach) continue;
    points.add({corner, Vec3(corner.x(), corner.y(), 0.0), Vec3::UnitZ(), NormalOf::world, kFaceOfB});
  }
}

}  // namespace springtower
