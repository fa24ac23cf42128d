#include "narrowphase/manifold.h"

#include "core/lanes.h"
#include "core/tuning.h"

#include <algorithm>
#include <array>
#include <limits>

namespace springtower {

namespace {

// A corner of the clipped polygon: its position on the reference face (the coordinates of the clip), on the incident face, and
// its height.
struct ClipPoint {
  double s;
  double t;
  double u;
  double v;
  double height;
};

using ClippedFace = std::array<ClipPoint, 2 * kManifoldPoints>;

ClipPoint between(const ClipPoint& p, const ClipPoint& q, double fraction) {
  return {p.s + fraction * (q.s - p.s), p.t + fraction * (q.t - p.t), p.u + fraction * (q.u - p.u), p.v + fraction * (q.v - p.v),
          p.height + fraction * (q.height - p.height)};
}

// Keeps the part of the polygon where side * coordinate <= 1/2.
std::size_t clip(const ClippedFace& in, std::size_t count, double ClipPoint::*coordinate, double side, ClippedFace& out) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const ClipPoint& p = in[i];
    const ClipPoint& q = in[i + 1 == count ? 0 : i + 1];
    const double insideP = 0.5 - side * p.*coordinate;
    const double insideQ = 0.5 - side * q.*coordinate;
    if (insideP >= 0.0) out[kept++] = p;
    if ((insideP > 0.0 && insideQ < 0.0) || (insideP < 0.0 && insideQ > 0.0))
      out[kept++] = between(p, q, insideP / (insideP - insideQ));
  }
  return kept;
}

// Lengths of the incident face's sides, m.
struct Lengths {
  double u;
  double v;
};

// Squared distance of a corner from the segment between two others on the incident face, m2.
double squaredDistance(const ClipPoint& corner, const ClipPoint& from, const ClipPoint& to, const Lengths& lengths) {
  const double sideU = (to.u - from.u) * lengths.u;
  const double sideV = (to.v - from.v) * lengths.v;
  double u = (corner.u - from.u) * lengths.u;
  double v = (corner.v - from.v) * lengths.v;
  const double square = sideU * sideU + sideV * sideV;
  const double share = square > 0.0 ? std::clamp((u * sideU + v * sideV) / square, 0.0, 1.0) : 0.0;
  u -= share * sideU;
  v -= share * sideV;
  return u * u + v * v;
}

// Removes corners at which an edge is straight. They add no support to that of their neighbours, and where edges of both faces
// coincide they appear and vanish with rounding errors. Returns how many are left.
std::size_t dropStraight(double radius, const Lengths& lengths, std::size_t count, ClippedFace& corners) {
  std::size_t i = 0;
  while (i < count && count > 2) {
    const ClipPoint& before = corners[i == 0 ? count - 1 : i - 1];
    const ClipPoint& after = corners[i + 1 == count ? 0 : i + 1];
    if (squaredDistance(corners[i], before, after, lengths) < radius * radius) {
      std::copy(corners.data() + i + 1, corners.data() + count, corners.data() + i);
      --count;
    } else {
      ++i;
    }
  }
  return count;
}

constexpr std::array<std::array<double, 2>, 4> kCornerPlaces = {{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};

// Transfers one point of any kind: only the displacement changes its sign where upper and lower were swapped.
void carryPoint(const PenaltyRow& from, std::size_t lane, double side, PenaltyRow& to, std::size_t toLane) {
  for (std::size_t a = 0; a < 3; ++a) to.displacement[a][toLane] = side * from.displacement[a][lane];
  to.maxwellDepth[toLane] = from.maxwellDepth[lane];
  to.restDepth[toLane] = from.restDepth[lane];
  to.stiffening[toLane] = from.stiffening[lane];
  to.touching[toLane] = from.touching[lane];
  to.slipRatio[toLane] = from.slipRatio[lane];
}

// The corners of a face, three of four lanes each: half the operations of vectors of three.
struct FaceCorners {
  Lanes p0, p1, p2, p3;
};

SPRINGTOWER_INLINE void readCorner(const CornerView& block, int corner, Lanes& to) {
  to = Lanes{block.x[corner], block.y[corner], block.z[corner], 0.0};
}

SPRINGTOWER_INLINE FaceCorners cornersOfFace(const CornerView& block, int face) {
  const auto& corners = kFaceCorners[static_cast<std::size_t>(face)];
  FaceCorners result;
  readCorner(block, corners[0], result.p0);
  readCorner(block, corners[1], result.p1);
  readCorner(block, corners[2], result.p2);
  readCorner(block, corners[3], result.p3);
  return result;
}

SPRINGTOWER_INLINE Vec3 vectorOf(const Lanes& lanes) {
  return {lanes[0], lanes[1], lanes[2]};
}

SPRINGTOWER_INLINE void findSides(const FaceCorners& corners, Vec3& sideU, Vec3& sideV) {
  sideU = vectorOf(0.5 * (corners.p1 - corners.p0 + corners.p2 - corners.p3));
  sideV = vectorOf(0.5 * (corners.p3 - corners.p0 + corners.p2 - corners.p1));
}

}  // namespace

void startManifold(Manifold& manifold, PairPhase phase, int incidentFace, int referenceFace) {
  const ManifoldShape before = manifold;
  manifold = Manifold{};
  static_cast<ManifoldShape&>(manifold) = before;
  manifold.count = 0;
  manifold.phase = phase;
  manifold.incidentFace = static_cast<std::int8_t>(incidentFace);
  manifold.referenceFace = static_cast<std::int8_t>(referenceFace);
  if (manifold.kind != PointKind::penalty) return;
  for (PointRow& row : manifold.points) row.penalty.stiffening.fill(1.0);
}

FaceFrame faceFrame(const CornerView& block, int face) {
  const FaceCorners corners = cornersOfFace(block, face);
  FaceFrame frame;
  frame.centre = vectorOf(0.25 * (corners.p0 + corners.p1 + corners.p2 + corners.p3));
  findSides(corners, frame.sideU, frame.sideV);
  frame.normal = frame.sideU.cross(frame.sideV).normalized();
  return frame;
}

int incidentFaceOf(const CornerView& block, const Vec3& normal) {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int face = 0; face < static_cast<int>(kFaces); ++face) {
    Vec3 sideU;
    Vec3 sideV;
    findSides(cornersOfFace(block, face), sideU, sideV);
    const double along = sideU.cross(sideV).normalized().dot(normal);
    if (along < least) {
      least = along;
      best = face;
    }
  }
  return best;
}

Vec3 pointOnIncidentFace(const ContactView& manifold, const CornerView& upper, std::size_t point) {
  const FaceFrame face = faceFrame(upper, manifold.incidentFace);
  return face.centre + manifold.u(point) * face.sideU + manifold.v(point) * face.sideV;
}

void buildFaceManifold(const CornerView& upper, const CornerView& lower, int incidentFace, int referenceFace,
                       const ManifoldLimits& limits, Manifold& manifold) {
  startManifold(manifold, PairPhase::face, incidentFace, referenceFace);
  const FaceFrame incident = faceFrame(upper, incidentFace);
  const FaceFrame reference = faceFrame(lower, referenceFace);
  const Vec3 alongS = reference.sideU / reference.sideU.squaredNorm();
  const Vec3 alongT = reference.sideV / reference.sideV.squaredNorm();

  ClippedFace polygon;
  ClippedFace other;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto [u, v] = kCornerPlaces[i];
    const Vec3 offset = incident.centre + u * incident.sideU + v * incident.sideV - reference.centre;
    polygon[i] = {offset.dot(alongS), offset.dot(alongT), u, v, offset.dot(reference.normal)};
  }
  std::size_t count = clip(polygon, 4, &ClipPoint::s, 1.0, other);
  count = clip(other, count, &ClipPoint::s, -1.0, polygon);
  count = clip(polygon, count, &ClipPoint::t, 1.0, other);
  count = clip(other, count, &ClipPoint::t, -1.0, polygon);

  const Lengths lengths{incident.sideU.norm(), incident.sideV.norm()};
  const double merged = limits.mergeRadius * limits.mergeRadius;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count && kept < kManifoldPoints; ++i) {
    const ClipPoint& p = polygon[i];
    if (p.height > limits.reach) continue;
    bool known = false;
    for (std::size_t j = 0; j < kept && !known; ++j) known = squaredDistance(p, other[j], other[j], lengths) < merged;
    if (!known) other[kept++] = p;
  }
  kept = dropStraight(tuning::kStraightEdgeBend * limits.mergeRadius, lengths, kept, other);
  for (std::size_t i = 0; i < kept; ++i) {
    manifold.place[rowOf(i)].u[laneOf(i)] = other[i].u;
    manifold.place[rowOf(i)].v[laneOf(i)] = other[i].v;
  }
  manifold.count = static_cast<std::int32_t>(kept);
}

void buildFloorManifold(const CornerView& upper, const ManifoldLimits& limits, Manifold& manifold) {
  const int face = incidentFaceOf(upper, Vec3::UnitZ());
  startManifold(manifold, PairPhase::face, face, 0);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (upper.z[kFaceCorners[static_cast<std::size_t>(face)][i]] > limits.reach) continue;
    manifold.place[0].u[kept] = kCornerPlaces[i][0];
    manifold.place[0].v[kept] = kCornerPlaces[i][1];
    ++kept;
  }
  manifold.count = static_cast<std::int32_t>(kept);
}

void carryPoints(const ContactView& old, const CornerView& oldUpper, Manifold& fresh, const CornerView& freshUpper,
                 double radius) {
  if (old.phase != PairPhase::face || fresh.phase != PairPhase::face) return;
  std::array<Vec3, kManifoldPoints> place;
  const auto oldCount = static_cast<std::size_t>(old.count);
  for (std::size_t j = 0; j < oldCount; ++j) place[j] = pointOnIncidentFace(old, oldUpper, j);
  std::array<bool, kManifoldPoints> taken{};
  const double side = old.upper == fresh.upper ? 1.0 : -1.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(fresh.count); ++i) {
    const Vec3 at = pointOnIncidentFace(fresh, freshUpper, i);
    double nearest = radius * radius;
    std::size_t best = kManifoldPoints;
    for (std::size_t j = 0; j < oldCount; ++j) {
      const double distance = (place[j] - at).squaredNorm();
      if (!taken[j] && distance < nearest) {
        nearest = distance;
        best = j;
      }
    }
    if (best == kManifoldPoints) continue;
    taken[best] = true;
    carryPoint(old.penalty(best), laneOf(best), side, fresh.points[rowOf(i)].penalty, laneOf(i));
  }
}

}  // namespace springtower
