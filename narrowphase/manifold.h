#pragma once

#include "core/ids.h"
#include "narrowphase/separation.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace springtower {

inline constexpr std::size_t kManifoldPoints = 8;  // two rectangles overlap in a polygon of at most eight corners
inline constexpr std::size_t kRowPoints = 4;       // points that fill one SIMD register
inline constexpr std::size_t kManifoldRows = kManifoldPoints / kRowPoints;

/// Contact state of a pair of blocks (or a block and the floor).
enum class PairPhase : std::uint8_t { separated, face, edge };

/// What the points of a contact store, depending on the steps that move its blocks.
enum class PointKind : std::uint8_t { penalty, impulse, anchor };

/// `touching` of a point that touches without a normal force: it overlaps, but damping cancels the spring while the blocks
/// separate.
inline constexpr double kTouchingWithoutForce = 0.5;

using FourValues = std::array<double, kRowPoints>;
using FourVectors = std::array<FourValues, 3>;  // [axis][point], world axes

/// Four points as springs and dashpots (explicit and implicit steps).
struct PenaltyRow {
  FourVectors displacement;  ///< m, elastic tangential displacement of upper from the friction anchor
  FourValues maxwellDepth;   ///< m, relaxed part of the elastic depth in the Maxwell branch; its force is k_v (elastic - relaxed)
  FourValues restDepth;      ///< m, depth of zero force
  FourValues stiffening;     ///< stiffness over the resting one, >= 1 after an impact
  FourValues
      touching;  ///< 1 where it pushes, kTouchingWithoutForce where it only touches, otherwise 0 (a double, to serve as a lane)
  FourValues slipRatio;  ///< 0 where it sticks; otherwise the share of friction left by the cone
};

/// The largest stiffening of four points.
inline double stiffestOf(const PenaltyRow& row) {
  return *std::max_element(row.stiffening.begin(), row.stiffening.end());
}

/// Four points as impulses (methods rigid-pgs and rigid-lcp, and islands in rigid mode).
struct ImpulseRow {
  FourVectors friction;    ///< N, mean over the step, on upper
  FourValues normalForce;  ///< N, mean over the step
  FourValues restDepth;    ///< m, overlap without force
  FourValues lasting;      ///< N, normal force, its mean over about a frame
  FourValues untouched;    ///< 0: no springs store energy
  FourValues slipping;     ///< non-zero where friction is at its bound
};

/// Four points as position constraints (method xpbd).
struct AnchorRow {
  FourVectors displacement;   ///< m, tangential, since the point began to stick
  FourValues normalForce;     ///< N, mean over the step
  FourValues firstFriction;   ///< N, on upper along the first tangent
  FourValues secondFriction;  ///< N, along the second
  FourValues untouched;       ///< 0: no springs store energy
  FourValues slipping;        ///< 1 where friction is at its bound, otherwise 0
};

/// Four points of a contact. `kind` of the manifold selects the member; as all members have one layout, any may be read (copies,
/// hashes) whichever was written.
union alignas(32) PointRow {
  PenaltyRow penalty{};
  ImpulseRow impulse;
  AnchorRow anchor;
};
using PointRows = std::array<PointRow*, kManifoldRows>;
using ConstPointRows = std::array<const PointRow*, kManifoldRows>;

/// Positions of four points on the incident face.
struct alignas(32) PlaceRow {
  FourValues u{};  ///< along its first side, -1/2..1/2
  FourValues v{};  ///< along its second side
};

/// Where friction acts on a contact all of whose points slip. Four corners that push would brake a turning face about twice as
/// much as pressure that is spread evenly over it; so each point's friction acts nearer to the centre of pressure, by a factor.
struct SlipPatch {
  float u = 0.0F;       ///< the centre of pressure on the incident face, -1/2..1/2
  float v = 0.0F;       ///< along its second side
  float shrink = 1.0F;  ///< distance from there at which friction acts, over the point's own
};

/// Which features of which blocks touch: `upper` rests on `lower` (labels only: upwards is along the normal). A face manifold has
/// points of upper's incident face against the plane of lower's reference face (or the floor); its points are corners of the
/// overlap of the two faces: corners of one block over the other's face, and crossings of their edges. An edge manifold is one
/// point where two edges cross.
struct ManifoldShape {
  std::int32_t upper = -1;
  std::int32_t lower = -1;  ///< -1: the floor
  std::int32_t count = 0;
  std::int8_t incidentFace = 0;   ///< of upper; for an edge manifold its edge
  std::int8_t referenceFace = 0;  ///< of lower; for an edge manifold its edge
  PairPhase phase = PairPhase::separated;
  PointKind kind = PointKind::penalty;
  bool slips = false;  ///< whether all of its points slip, so that kinetic friction acts at them
  SlipPatch patch;     ///< where, if they do
};

/// Number of rows for this many points.
constexpr std::size_t rowsFor(std::int32_t count) {
  return (static_cast<std::size_t>(count) + kRowPoints - 1) / kRowPoints;
}

/// Row and lane of a point.
constexpr std::size_t rowOf(std::size_t point) {
  return point / kRowPoints;
}
constexpr std::size_t laneOf(std::size_t point) {
  return point % kRowPoints;
}

/// A contact manifold by value: its features, the places of its points and what they store.
struct Manifold : ManifoldShape {
  std::array<PlaceRow, kManifoldRows> place;
  std::array<PointRow, kManifoldRows> points;
};

/// A read-only view of a stored contact manifold. Rows past those of its points may be null.
struct ContactView : ManifoldShape {
  std::array<const PlaceRow*, kManifoldRows> place{};
  ConstPointRows points{};

  ContactView() = default;
  ContactView(const Manifold& m)  // NOLINT(google-explicit-constructor): a manifold by value is one way to hold a contact
      : ManifoldShape(m), place{m.place.data(), m.place.data() + 1}, points{m.points.data(), m.points.data() + 1} {}
  [[nodiscard]] double u(std::size_t point) const { return place[rowOf(point)]->u[laneOf(point)]; }
  [[nodiscard]] double v(std::size_t point) const { return place[rowOf(point)]->v[laneOf(point)]; }
  [[nodiscard]] const PenaltyRow& penalty(std::size_t point) const { return points[rowOf(point)]->penalty; }
  [[nodiscard]] const ImpulseRow& impulse(std::size_t point) const { return points[rowOf(point)]->impulse; }
  [[nodiscard]] const AnchorRow& anchor(std::size_t point) const { return points[rowOf(point)]->anchor; }
};

/// A copy by value.
inline Manifold copyOf(const ContactView& contact) {
  Manifold manifold;
  static_cast<ManifoldShape&>(manifold) = contact;
  for (std::size_t r = 0; r < rowsFor(contact.count); ++r) {
    manifold.place[r] = *contact.place[r];
    manifold.points[r] = *contact.points[r];
  }
  return manifold;
}

/// The vector of a point in a row of four.
inline Vec3 vectorAt(const FourVectors& values, std::size_t point) {
  return {values[0][laneOf(point)], values[1][laneOf(point)], values[2][laneOf(point)]};
}
inline void setVectorAt(FourVectors& values, std::size_t point, const Vec3& value) {
  for (std::size_t a = 0; a < 3; ++a) values[a][laneOf(point)] = value[static_cast<Eigen::Index>(a)];
}

/// `touching` of a penalty point: 1, kTouchingWithoutForce or 0; 0 of impulses and anchors.
inline double touchingAt(const ContactView& manifold, std::size_t point) {
  return manifold.penalty(point).touching[laneOf(point)];
}

/// Whether friction of a point is at its bound, for any kind of point.
inline bool slipsAt(const ContactView& manifold, std::size_t point) {
  return manifold.penalty(point).slipRatio[laneOf(point)] != 0.0;
}

/// Whether any point of a manifold touches; none of impulses or anchors does.
inline bool anyPointTouches(const ContactView& manifold) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    if (touchingAt(manifold, i) != 0.0) return true;
  }
  return false;
}

/// A face's frame: its centre, its two mean sides and its unit outward normal, from its four corners.
struct FaceFrame {
  Vec3 centre;
  Vec3 sideU;
  Vec3 sideV;
  Vec3 normal;
};
FaceFrame faceFrame(const CornerView& block, int face);

/// The face of a block whose outward normal is most opposed to a direction.
int incidentFaceOf(const CornerView& block, const Vec3& normal);

/// Length limits for the construction of manifolds, m. Edges that bend by less than a twentieth of mergeRadius count as straight.
struct ManifoldLimits {
  double mergeRadius;  ///< points closer than this on the incident face are merged
  double reach;        ///< points farther than this above the reference plane are omitted
};

/// Resets a manifold to one without points; `upper`, `lower` and `kind` are kept. Points added later start as unloaded springs,
/// or as impulses and anchors without forces.
void startManifold(Manifold& manifold, PairPhase phase, int incidentFace, int referenceFace);

/// Overlap of upper's incident face with lower's reference face: clips the one against the sides of the other (Sutherland &
/// Hodgman 1974), merges coinciding points and drops those along a straight edge. Fills u, v, count and features; the state of
/// all points is reset. Without overlap count is 0.
void buildFaceManifold(const CornerView& upper, const CornerView& lower, int incidentFace, int referenceFace,
                       const ManifoldLimits& limits, Manifold& manifold);

/// The four corners of a block's lowest face against the floor z = 0, without those higher than limits.reach.
void buildFloorManifold(const CornerView& upper, const ManifoldLimits& limits, Manifold& manifold);

/// Transfers the state of the points of an old manifold to a new one of the same pair (warm start): each new point takes that of
/// the nearest old point within `radius` (m, in space). Upper and lower may have been swapped. The corners are those of each
/// manifold's upper block.
void carryPoints(const ContactView& old, const CornerView& oldUpper, Manifold& fresh, const CornerView& freshUpper,
                 double radius);

/// Position of a manifold's point in space, m: on the incident face (face manifolds only).
Vec3 pointOnIncidentFace(const ContactView& manifold, const CornerView& upper, std::size_t point);

}  // namespace springtower
