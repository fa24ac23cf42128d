#pragma once

#include "core/ids.h"
#include "narrowphase/separation.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace springtower {

inline constexpr std::size_t kManifoldPoints = 8;  // two rectangles overlap in a polygon of at most eight corners

/// What a pair of blocks (or a block and the floor) is to one another.
enum class PairPhase : std::uint8_t { separated, face, edge };

/// `live` of a point that touches without a normal force: it overlaps, but damping cancels the spring while the blocks separate.
inline constexpr double kUnpressed = 0.5;

/// What the points of a manifold remember from step to step, structure of arrays, so that four points fill one SIMD register.
struct PointMemory {
  alignas(32) std::array<double, kManifoldPoints> stretchX{};  ///< friction anchor: elastic tangential displacement of upper, m
  alignas(32) std::array<double, kManifoldPoints> stretchY{};
  alignas(32) std::array<double, kManifoldPoints> stretchZ{};
  alignas(32) std::array<double, kManifoldPoints> relaxed{};  ///< Maxwell branch: relaxed part of the elastic depth, m; its force
                                                              ///< is k_v (elastic - relaxed)
  alignas(32) std::array<double, kManifoldPoints> offset{};   ///< depth of zero force, m
  alignas(32) std::array<double, kManifoldPoints> scale{};    ///< its stiffness over the resting one, >= 1 after an impact
  alignas(32) std::array<double, kManifoldPoints> live{};     ///< 1 where it pushes, kUnpressed where it only touches, else 0 (a
                                                              ///< double, to serve as a lane)
  alignas(32) std::array<double, kManifoldPoints> sliding{};  ///< 0 where it sticks; else the share of friction left by the cone
};

/// The contact manifold of a pair: where `upper` rests on `lower` (names only: up is along the normal), and the memory of each
/// point. A face manifold holds points of upper's incident face against the plane of lower's reference face (or the floor); its
/// points are corners of the overlap of the two faces: corners of one block over the other's face, and crossings of their edges.
/// An edge manifold is one point where two edges cross.
struct Manifold : PointMemory {
  alignas(32) std::array<double, kManifoldPoints> u{};  ///< place on the incident face along its first side, -1/2..1/2
  alignas(32) std::array<double, kManifoldPoints> v{};  ///< and along its second side
  std::int32_t upper = -1;
  std::int32_t lower = -1;  ///< -1: the floor
  std::int32_t count = 0;
  std::int8_t incidentFace = 0;   ///< of upper; for an edge manifold its edge
  std::int8_t referenceFace = 0;  ///< of lower; for an edge manifold its edge
  PairPhase touch = PairPhase::separated;
  bool rigid = false;  ///< whether rigid steps move its blocks: `relaxed` and `stretch` are forces then (N, friction on upper)
};

/// Whether any point of a manifold touches.
inline bool anyPointTouches(const Manifold& manifold) {
  return std::any_of(manifold.live.begin(), manifold.live.begin() + manifold.count, [](double live) { return live != 0.0; });
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

/// Sizes the geometry of manifolds is judged by, m. Edges that bend by less than a twentieth of mergeRadius are straight.
struct ManifoldLimits {
  double mergeRadius;  ///< points closer than this on the incident face are one
  double reach;        ///< points farther than this above the reference plane are left out
};

/// Overlap of upper's incident face with lower's reference face: clips the one against the sides of the other (Sutherland &
/// Hodgman 1974), merges points that coincide and leaves out those along a straight edge. Fills u, v, count and names; the memory
/// of all points starts empty. No overlap gives count 0.
void buildFaceManifold(const CornerView& upper, const CornerView& lower, int incidentFace, int referenceFace,
                       const ManifoldLimits& limits, Manifold& manifold);

/// The four corners of a block's lowest face against the floor z = 0; those higher than limits.reach are left out.
void buildFloorManifold(const CornerView& upper, const ManifoldLimits& limits, Manifold& manifold);

/// Hands the memory of an old manifold to the points of a new one of the same pair: each new point takes that of the nearest old
/// point within `radius` (m, in space). Roles may have swapped. The corners are those of the blocks a manifold names as upper.
void carryMemory(const Manifold& old, const CornerView& oldUpper, Manifold& fresh, const CornerView& freshUpper, double radius);

/// Place of a manifold's point in space, m: on the incident face (face manifolds only).
Vec3 pointOnIncidentFace(const Manifold& manifold, const CornerView& upper, std::size_t point);

}  // namespace springtower
