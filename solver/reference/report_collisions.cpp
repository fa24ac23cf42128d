#include "solver/reference/report_collisions.h"

#include "core/tuning.h"
#include "narrowphase/exact/cubic.h"
#include "narrowphase/exact/time_of_impact.h"
#include "narrowphase/separation.h"
#include "solver/reference/report_response.h"
#include "solver/world/driven_blocks.h"

#include <algorithm>
#include <array>

namespace springtower {

namespace {

// The straight paths of one block's corners. A disabled block does not move.
struct Path {
  std::int32_t block;
  bool moves;
  CornerView from;
  CornerView to;
  CornerView low;  // the box that each corner sweeps
  CornerView high;

  Path(const IslandStep& step, std::int32_t b)
      : block(b), moves(step.simulation.asleep[static_cast<std::size_t>(b)] == 0 || isDriven(step, b)) {
    const auto at = static_cast<std::size_t>(b);
    const ReportState& report = step.engine.report;
    const ParticleArray& lies = step.simulation.state.position;
    from = cornersOf(moves ? report.from : lies, at);
    to = cornersOf(moves ? report.to : lies, at);
    low = cornersOf(moves ? report.low : lies, at);
    high = cornersOf(moves ? report.high : lies, at);
  }
  [[nodiscard]] MovingPoint corner(int c) const { return {from.at(c), to.at(c)}; }
};

// The box swept by a few corners of a block (report 4.4.3).
struct AlignedBox {
  std::array<double, 3> lower;
  std::array<double, 3> upper;
};

template <std::size_t Count>
AlignedBox boxOf(const Path& path, const std::array<int, Count>& corners) {
  const std::array<const double*, 3> low = {path.low.x, path.low.y, path.low.z};
  const std::array<const double*, 3> high = {path.high.x, path.high.y, path.high.z};
  AlignedBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.lower[a] = low[a][corners[0]];
    box.upper[a] = high[a][corners[0]];
    for (std::size_t i = 1; i < Count; ++i) {
      box.lower[a] = std::min(box.lower[a], low[a][corners[i]]);
      box.upper[a] = std::max(box.upper[a], high[a][corners[i]]);
    }
  }
  return box;
}

bool overlap(const AlignedBox& p, const AlignedBox& q) {
  bool all = true;
  for (std::size_t a = 0; a < 3; ++a) all = all && p.lower[a] <= q.upper[a] && q.lower[a] <= p.upper[a];
  return all;
}

constexpr std::array<int, kCorners> kAllCorners = {0, 1, 2, 3, 4, 5, 6, 7};

// The report's plane intersection test (its 4.4.1): in front of the plane at the start of the step, or on it within rounding, and
// behind it at the end.
bool passesToBack(const BernsteinCubic& side) {
  return side.coefficients[0] >= -side.error && side.coefficients[3] <= side.error && mayVanish(side);
}

Vec3 at(const MovingPoint& point, double time) {
  return point.start + time * (point.end - point.start);
}

// Barycentric weights of a point in a triangle's plane (the areas of Eq. 4.15 and 4.16, which are undefined at the first corner).
std::array<double, 3> triangleWeights(const Vec3& point, const Vec3& p1, const Vec3& p2, const Vec3& p3, const Vec3& normal) {
  std::array<double, 3> weight = {normal.dot((p2 - point).cross(p3 - point)), normal.dot((p3 - point).cross(p1 - point)),
                                  normal.dot((p1 - point).cross(p2 - point))};
  for (double& w : weight) w = std::max(w, 0.0);
  const double sum = weight[0] + weight[1] + weight[2];
  for (double& w : weight) w /= sum;
  return weight;
}

bool anyCornerNear(const Path& points, const AlignedBox& box) {
  return std::any_of(kAllCorners.begin(), kAllCorners.end(), [&](int c) { return overlap(boxOf(points, std::array{c}), box); });
}

bool collidePointsWithFaces(IslandStep& step, const Path& points, const Path& faces) {
  Counters& counters = step.counters;
  counters.candidateTests += kCorners * kTriangles;
  bool any = false;
  AlignedBox pointsBox = boxOf(points, kAllCorners);
  if (!anyCornerNear(points, boxOf(faces, kAllCorners))) return false;
  for (const auto& triangle : kTriangleCorners) {
    AlignedBox triangleBox = boxOf(faces, triangle);
    if (!overlap(triangleBox, pointsBox)) continue;
    for (int c = 0; c < static_cast<int>(kCorners); ++c) {
      if (!overlap(triangleBox, boxOf(points, std::array{c}))) continue;
      ++counters.boxOverlaps;
      const MovingPoint point = points.corner(c);
      const MovingPoint p1 = faces.corner(triangle[0]);
      const MovingPoint p2 = faces.corner(triangle[1]);
      const MovingPoint p3 = faces.corner(triangle[2]);
      if (!passesToBack(coplanarityCubic(p1, p2, p3, point))) continue;
      ++counters.planeCrossings;
      ++counters.cubicTests;
      const TimeOfImpact impact = pointTriangleTimeOfImpact(point, p1, p2, p3);
      if (!impact.hit) continue;
      ++counters.cubicHits;
      const Vec3 corners[3] = {at(p1, impact.time), at(p2, impact.time), at(p3, impact.time)};
      const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
      if (!(normal.squaredNorm() > 0.0)) continue;
      const auto weight = triangleWeights(at(point, impact.time), corners[0], corners[1], corners[2], normal);
      ReportContact contact;
      contact.first = points.block;
      contact.second = faces.block;
      contact.firstCount = 1;
      contact.secondCount = 3;
      contact.corner[0] = static_cast<std::int8_t>(c);
      contact.weight[0] = 1.0;
      for (std::size_t i = 0; i < 3; ++i) {
        contact.corner[i + 1] = static_cast<std::int8_t>(triangle[i]);
        contact.weight[i + 1] = weight[i];
      }
      contact.normal = normal.normalized();
      if (!respond(step, contact)) continue;
      any = true;
      pointsBox = boxOf(points, kAllCorners);
      triangleBox = boxOf(faces, triangle);
    }
  }
  return any;
}

// Closest points of two lines p + s u and q + t w, with s and t limited to their edges. Precondition: not parallel.
std::array<double, 2> nearestOnEdges(const Vec3& p, const Vec3& u, const Vec3& q, const Vec3& w) {
  const Vec3 normal = u.cross(w);
  const double squared = normal.squaredNorm();
  const Vec3 offset = q - p;
  return {std::clamp(offset.cross(w).dot(normal) / squared, 0.0, 1.0),
          std::clamp(offset.cross(u).dot(normal) / squared, 0.0, 1.0)};
}

bool collideEdges(IslandStep& step, const Path& a, const Path& b, const Vec3& fromBToA) {
  Counters& counters = step.counters;
  counters.candidateTests += kEdges * kEdges;
  bool any = false;
  AlignedBox boxB = boxOf(b, kAllCorners);
  for (const auto& edgeA : kEdgeCorners) {
    AlignedBox boxEdgeA = boxOf(a, edgeA);
    if (!overlap(boxEdgeA, boxB)) continue;
    for (const auto& edgeB : kEdgeCorners) {
      if (!overlap(boxEdgeA, boxOf(b, edgeB))) continue;
      ++counters.boxOverlaps;
      const MovingPoint a0 = a.corner(edgeA[0]);
      const MovingPoint a1 = a.corner(edgeA[1]);
      const MovingPoint b0 = b.corner(edgeB[0]);
      const MovingPoint b1 = b.corner(edgeB[1]);
      // Two lines have no front side. Here it is the side on which the first block lies relative to the second, as for any two
      // convex bodies that touch.
      const Vec3 across = (a1.start - a0.start).cross(b1.start - b0.start);
      const double parallel = tuning::kReportParallelSine * (a1.start - a0.start).norm() * (b1.start - b0.start).norm();
      if (across.squaredNorm() < parallel * parallel) continue;
      const bool forwards = across.dot(fromBToA) >= 0.0;
      if (!passesToBack(forwards ? coplanarityCubic(a0, a1, b0, b1) : coplanarityCubic(a1, a0, b0, b1))) continue;
      ++counters.planeCrossings;
      ++counters.cubicTests;
      const TimeOfImpact impact = edgeEdgeTimeOfImpact(a0, a1, b0, b1);
      if (!impact.hit) continue;
      ++counters.cubicHits;
      const Vec3 p = at(a0, impact.time);
      const Vec3 u = at(a1, impact.time) - p;
      const Vec3 q = at(b0, impact.time);
      const Vec3 w = at(b1, impact.time) - q;
      const Vec3 normal = forwards ? u.cross(w) : w.cross(u);
      if (!(normal.squaredNorm() > 0.0)) continue;
      const auto [s, t] = nearestOnEdges(p, u, q, w);
      ReportContact contact;
      contact.first = a.block;
      contact.second = b.block;
      contact.firstCount = 2;
      contact.secondCount = 2;
      for (std::size_t i = 0; i < 2; ++i) {
        contact.corner[i] = static_cast<std::int8_t>(edgeA[i]);
        contact.corner[i + 2] = static_cast<std::int8_t>(edgeB[i]);
      }
      contact.weight = {1.0 - s, s, 1.0 - t, t};
      contact.normal = normal.normalized();
      if (!respond(step, contact)) continue;
      any = true;
      boxB = boxOf(b, kAllCorners);
      boxEdgeA = boxOf(a, edgeA);
    }
  }
  return any;
}

bool collideWithFloor(IslandStep& step, std::int32_t block) {
  const auto b = static_cast<std::size_t>(block);
  bool any = false;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const double z = step.simulation.state.position.values(2, b)[c];
    if (z + step.drift_s * step.simulation.state.velocity.values(2, b)[c] >= 0.0) continue;
    ReportContact contact;
    contact.first = block;
    contact.firstCount = 1;
    contact.corner[0] = static_cast<std::int8_t>(c);
    contact.weight[0] = 1.0;
    any = respond(step, contact) || any;
  }
  return any;
}

bool collideBlocks(IslandStep& step, std::size_t pairAt) {
  const BlockPair& pair = step.engine.pairs.key[pairAt];
  std::vector<std::uint32_t>& version = step.engine.report.version;
  const auto a = static_cast<std::size_t>(pair.a);
  const auto b = static_cast<std::size_t>(pair.b);
  const Path pathA(step, pair.a);
  const Path pathB(step, pair.b);
  const std::array<std::uint32_t, 2> before = {version[a], version[b]};
  bool any = false;
  if (overlap(boxOf(pathA, kAllCorners), boxOf(pathB, kAllCorners))) {
    const Vec3 fromBToA = centre(step.simulation.state.position, a) - centre(step.simulation.state.position, b);
    any = collidePointsWithFaces(step, pathA, pathB);
    any = collidePointsWithFaces(step, pathB, pathA) || any;
    any = collideEdges(step, pathA, pathB, fromBToA) || any;
  }
  if (!any) step.engine.report.testedAt[pairAt] = before;
  return any;
}

}  // namespace

void resolveCollisions(IslandStep& step) {
  const Engine& engine = step.engine;
  for (const std::int32_t block : step.blocks) layPath(step, static_cast<std::size_t>(block));
  for (const BlockPair& driven : step.driven) layPath(step, static_cast<std::size_t>(driven.b));
  bool any = true;
  for (int pass = 0; any && pass < step.simulation.scene.settings.reportIterations; ++pass) {
    ++step.counters.responseIterations;
    any = false;
    for (const std::int32_t pairAt : step.pairs) {
      const BlockPair& pair = engine.pairs.key[static_cast<std::size_t>(pairAt)];
      if (pair.b < 0) any = collideWithFloor(step, pair.a) || any;
    }
    for (const std::int32_t pairAt : step.pairs) {
      const BlockPair& pair = engine.pairs.key[static_cast<std::size_t>(pairAt)];
      if (pair.b < 0) continue;
      // A pair found free of collisions remains so while neither path changes.
      const std::array<std::uint32_t, 2> now = {engine.report.version[static_cast<std::size_t>(pair.a)],
                                                engine.report.version[static_cast<std::size_t>(pair.b)]};
      if (pass > 0 && now == engine.report.testedAt[static_cast<std::size_t>(pairAt)]) continue;
      any = collideBlocks(step, static_cast<std::size_t>(pairAt)) || any;
    }
  }
}

void moveByVelocities(IslandStep& step) {
  MotionState& state = step.simulation.state;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t a = 0; a < 3; ++a) {
      double* x = state.position.values(a, b);
      const double* v = state.velocity.values(a, b);
      double* before = step.engine.memo.previous.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) {
        before[c] = x[c];
        x[c] += step.drift_s * v[c];
      }
    }
  }
}

}  // namespace springtower
