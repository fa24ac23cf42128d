#include "narrowphase/crossing.h"

#include "narrowphase/exact/time_of_impact.h"

#include <algorithm>
#include <array>

namespace springtower {

namespace {

// The box swept by a group of corners.
struct Sweep {
  double lower[3];
  double upper[3];
};

template <std::size_t Count>
Sweep sweepOf(const MovingBlock& block, const std::array<int, Count>& corners) {
  Sweep sweep;
  const double* start[3] = {block.start.x, block.start.y, block.start.z};
  const double* end[3] = {block.end.x, block.end.y, block.end.z};
  for (int a = 0; a < 3; ++a) {
    double low = start[a][corners[0]];
    double high = low;
    for (const int c : corners) {
      low = std::min({low, start[a][c], end[a][c]});
      high = std::max({high, start[a][c], end[a][c]});
    }
    sweep.lower[a] = low;
    sweep.upper[a] = high;
  }
  return sweep;
}

bool overlap(const Sweep& p, const Sweep& q) {
  for (int a = 0; a < 3; ++a) {
    if (p.upper[a] < q.lower[a] || p.lower[a] > q.upper[a]) return false;
  }
  return true;
}

MovingPoint moving(const MovingBlock& block, int corner) {
  return {block.start.at(corner), block.end.at(corner)};
}

// The features of one block near the other's whole sweep: few, where two blocks stand side by side.
template <std::size_t Features, std::size_t Count>
struct NearFeatures {
  std::array<Sweep, Features> sweep;
  std::array<int, Features> which;
  std::size_t count = 0;

  NearFeatures(const MovingBlock& block, const std::array<std::array<int, Count>, Features>& corners, const Sweep& other) {
    for (std::size_t f = 0; f < Features; ++f) {
      const Sweep mine = sweepOf(block, corners[f]);
      if (!overlap(mine, other)) continue;
      sweep[count] = mine;
      which[count++] = static_cast<int>(f);
    }
  }
};

constexpr std::array<int, kCorners> kAllCorners = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr std::array<std::array<int, 1>, kCorners> kSingleCorners = {{{0}, {1}, {2}, {3}, {4}, {5}, {6}, {7}}};

bool pointsMeetFaces(const MovingBlock& points, const Sweep& pointsSweep, const MovingBlock& faces, const Sweep& facesSweep,
                     Counters& counters) {
  counters.candidateTests += kCorners * kTriangles;
  const NearFeatures<kCorners, 1> corners(points, kSingleCorners, facesSweep);
  if (corners.count == 0) return false;
  const NearFeatures<kTriangles, 3> triangles(faces, kTriangleCorners, pointsSweep);
  for (std::size_t t = 0; t < triangles.count; ++t) {
    const auto& triangle = kTriangleCorners[static_cast<std::size_t>(triangles.which[t])];
    for (std::size_t c = 0; c < corners.count; ++c) {
      if (!overlap(corners.sweep[c], triangles.sweep[t])) continue;
      ++counters.boxOverlaps;
      const MovingPoint point = moving(points, corners.which[c]);
      const MovingPoint p0 = moving(faces, triangle[0]);
      const MovingPoint p1 = moving(faces, triangle[1]);
      const MovingPoint p2 = moving(faces, triangle[2]);
      if (!coplanarityCubicMayVanish(point, p0, p1, p2)) continue;
      ++counters.planeCrossings;
      ++counters.cubicTests;
      if (!pointTriangleTimeOfImpact(point, p0, p1, p2).hit) continue;
      ++counters.cubicHits;
      return true;
    }
  }
  return false;
}

bool edgesMeet(const MovingBlock& a, const Sweep& sweepA, const MovingBlock& b, const Sweep& sweepB, Counters& counters) {
  counters.candidateTests += kEdges * kEdges;
  const NearFeatures<kEdges, 2> edgesA(a, kEdgeCorners, sweepB);
  if (edgesA.count == 0) return false;
  const NearFeatures<kEdges, 2> edgesB(b, kEdgeCorners, sweepA);
  for (std::size_t i = 0; i < edgesA.count; ++i) {
    const auto& edgeA = kEdgeCorners[static_cast<std::size_t>(edgesA.which[i])];
    for (std::size_t j = 0; j < edgesB.count; ++j) {
      if (!overlap(edgesA.sweep[i], edgesB.sweep[j])) continue;
      ++counters.boxOverlaps;
      const auto& edgeB = kEdgeCorners[static_cast<std::size_t>(edgesB.which[j])];
      const MovingPoint a0 = moving(a, edgeA[0]);
      const MovingPoint a1 = moving(a, edgeA[1]);
      const MovingPoint b0 = moving(b, edgeB[0]);
      const MovingPoint b1 = moving(b, edgeB[1]);
      if (!coplanarityCubicMayVanish(a0, a1, b0, b1)) continue;
      ++counters.planeCrossings;
      ++counters.cubicTests;
      if (!edgeEdgeTimeOfImpact(a0, a1, b0, b1).hit) continue;
      ++counters.cubicHits;
      return true;
    }
  }
  return false;
}

}  // namespace

bool featuresMeet(const MovingBlock& a, const MovingBlock& b, Counters& counters) {
  const Sweep sweepA = sweepOf(a, kAllCorners);
  const Sweep sweepB = sweepOf(b, kAllCorners);
  if (!overlap(sweepA, sweepB)) return false;
  return pointsMeetFaces(a, sweepA, b, sweepB, counters) || pointsMeetFaces(b, sweepB, a, sweepA, counters) ||
         edgesMeet(a, sweepA, b, sweepB, counters);
}

}  // namespace springtower
