#include "narrowphase/near_points.h"

#include "core/block.h"
#include "core/tuning.h"
#include "narrowphase/manifold.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springtower {

namespace {

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

// Points of the incident block's face over the reference face, none of them deeper than `least` (a gap). `onA`: whether the
// incident block is a.
void addFacePoints(const CornerView& incident, const CornerView& reference, int referenceFace, const ManifoldLimits& limits,
                   double least, bool onA, NearPoints& points) {
  const FaceFrame face = faceFrame(reference, referenceFace);
  Manifold outline;
  buildFaceManifold(incident, reference, incidentFaceOf(incident, face.normal), referenceFace, limits, outline);
  const auto count = static_cast<std::size_t>(outline.count);
  const std::size_t first = firstPoint(outline);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 place = pointOnIncidentFace(outline, incident, (first + i) % count);
    const double gap = face.normal.dot(place - face.centre);
    if (gap > limits.reach || gap < least) continue;
    const Vec3 below = place - gap * face.normal;
    if (onA) {
      points.add({place, below, face.normal, NormalOf::b});
    } else {
      points.add({below, place, -face.normal, NormalOf::a});
    }
  }
}

// Where two edges come nearest, within their ends, if not deeper than `least`. Of edges that are nearly parallel this would be
// anywhere, and the ends of both are among the points of faces.
void addCrossing(const CornerView& a, const CornerView& b, const Separation& apart, double least, NearPoints& points) {
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
  const Vec3 placeA = fromA + std::clamp(onA, 0.0, 1.0) * alongA;
  const Vec3 placeB = fromB + std::clamp(onB, 0.0, 1.0) * alongB;
  if (apart.normalEdge.dot(placeA - placeB) < least) return;
  points.add({placeA, placeB, apart.normalEdge, NormalOf::b});
}

// The points along all directions whose separation is within reach of the best, none deeper than `deepest`.
void addPoints(const CornerView& a, const CornerView& b, const Separation& apart, const ManifoldLimits& limits, double deepest,
               NearPoints& points) {
  const double least = apart.best() - limits.reach;
  const bool isFaceOfB = apart.faceB + limits.mergeRadius >= apart.faceA;  // of two that are alike always the same
  const auto addFaces = [&](bool ofB) {
    if ((ofB ? apart.faceB : apart.faceA) < least) return;
    addFacePoints(ofB ? a : b, ofB ? b : a, ofB ? apart.faceOfB : apart.faceOfA, limits, deepest, ofB, points);
  };
  addFaces(isFaceOfB);
  // Of parallel faces both outlines are the same.
  const bool parallel = apart.normalFaceA.dot(apart.normalFaceB) > tuning::kParallelFaces;
  if (points.count == 0 || !parallel) addFaces(!isFaceOfB);
  if (!std::isfinite(apart.edge) || apart.edge < least) return;
  const Vec3& face = isFaceOfB ? apart.normalFaceB : apart.normalFaceA;
  if (points.count == 0 || apart.normalEdge.dot(face) < tuning::kParallelFaces) addCrossing(a, b, apart, deepest, points);
}

}  // namespace

void findNearPoints(const CornerView& a, const CornerView& b, const Separation& apart, double reach, double mergeRadius,
                    NearPoints& points) {
  points.count = 0;
  if (apart.best() > reach) return;
  const ManifoldLimits limits{mergeRadius, reach};
  // What lies deeper below a face than the blocks are in one another lies beside it: no contact holds it there.
  addPoints(a, b, apart, limits, std::min(apart.best(), 0.0) - mergeRadius, points);
  // Nearly parallel edges have no crossing; then faces hold them.
  if (points.count == 0) addPoints(a, b, apart, limits, -std::numeric_limits<double>::infinity(), points);
}

void findNearFloorPoints(const CornerView& block, double reach, NearPoints& points) {
  points.count = 0;
  for (int c = 0; c < static_cast<int>(kCorners); ++c) {
    const Vec3 corner = block.at(c);
    if (corner.z() > reach) continue;
    points.add({corner, Vec3(corner.x(), corner.y(), 0.0), Vec3::UnitZ(), NormalOf::world});
  }
}

}  // namespace springtower
