#pragma once

#include "core/lanes.h"
#include "narrowphase/manifold.h"
#include "solver/law/pair_geometry.h"

#include <array>

// Where the points of a manifold are on its two blocks, for matrices of contacts: four at a time, without the law. The same
// places as those at which the law's forces act.

namespace springtower {

/// Four points of a manifold: weights of the blocks' sides at each of them (those of `lower` are not set on the floor).
struct PlacedPoints {
  Lanes upper[3];
  Lanes lower[3];
  Lanes depth;  ///< m
};

/// Both blocks of a manifold; `below` is null for the floor.
struct PlacedBlocks {
  const BlockFrame& above;
  const BlockFrame* below;
};

/// The unit normal of a manifold, from lower to upper. Precondition: edges that cross are not parallel.
SPRINGTOWER_INLINE void normalOf(const ContactView& m, const PlacedBlocks& blocks, double* normal) {
  normal[0] = normal[1] = 0.0;
  normal[2] = 1.0;
  if (blocks.below == nullptr) return;
  if (m.phase == PairPhase::edge) {
    Crossing crossing;
    crossingOf(blocks.above.place, edgeAxes(m.incidentFace), blocks.below->place, edgeAxes(m.referenceFace), crossing);
    for (std::size_t k = 0; k < 3; ++k) normal[k] = crossing.normal[k];
    return;
  }
  const FaceAxes& face = kFaceAxes[static_cast<std::size_t>(m.referenceFace)];
  for (std::size_t k = 0; k < 3; ++k) normal[k] = 2.0 * face.side * blocks.below->normal[face.across][k];
}

/// Four points at `u` and `v` (-1/2..1/2) of the upper face; `normal` is the manifold's.
SPRINGTOWER_INLINE void placeOnFaces(const ContactView& m, const PlacedBlocks& blocks, const double* normal, const Lanes& u,
                                     const Lanes& v, PlacedPoints& points) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  const FaceAxes& upper = kFaceAxes[static_cast<std::size_t>(m.incidentFace)];
  points.upper[upper.across] = zero + upper.side;
  points.upper[upper.u] = u;
  points.upper[upper.v] = v;
  FaceField face;
  faceOf(blocks.above.place, upper, face);
  Lanes arm[3];
  at(face, u, v, arm);
  points.depth = -arm[2];
  if (blocks.below == nullptr) return;
  const FaceAxes& lower = kFaceAxes[static_cast<std::size_t>(m.referenceFace)];
  faceOf(blocks.below->place, lower, face);
  for (std::size_t k = 0; k < 3; ++k) arm[k] -= face.centre[k];
  points.depth = -(arm[0] * normal[0] + arm[1] * normal[1] + arm[2] * normal[2]);
  points.lower[lower.across] = zero + lower.side;
  for (const std::size_t a : {lower.u, lower.v}) {
    const std::array<double, 3>& dual = blocks.below->dual[a];
    points.lower[a] = arm[0] * dual[0] + arm[1] * dual[1] + arm[2] * dual[2];
  }
}

/// The point where two edges cross, in all lanes. Preconditions: a manifold of edges, `below` is not null.
SPRINGTOWER_INLINE void placeOnEdges(const ContactView& m, const PlacedBlocks& blocks, PlacedPoints& points) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  const EdgeAxes upper = edgeAxes(m.incidentFace);
  const EdgeAxes lower = edgeAxes(m.referenceFace);
  Crossing crossing;
  crossingOf(blocks.above.place, upper, blocks.below->place, lower, crossing);
  const auto put = [&](const EdgeAxes& edge, double along, Lanes* weight) {
    weight[edge.along] = zero + along;
    weight[edge.first] = zero + edge.sideFirst;
    weight[edge.second] = zero + edge.sideSecond;
  };
  put(upper, crossing.onUpper, points.upper);
  put(lower, crossing.onLower, points.lower);
  points.depth = zero - crossing.gap;
}

/// Whether the friction of a contact's points acts nearer to its centre of pressure than they are.
SPRINGTOWER_INLINE bool actsNearer(const ManifoldShape& contact) {
  return contact.phase != PairPhase::edge && contact.slips && contact.patch.shrink < 1.0F;
}

/// u and v of a row of a manifold's points on the upper face; 0 in lanes without a point.
SPRINGTOWER_INLINE void loadPlaces(const ContactView& m, std::size_t row, Lanes& u, Lanes& v) {
  const Lanes zero = {0.0, 0.0, 0.0, 0.0};
  const LaneMask inUse = Lanes{0.0, 1.0, 2.0, 3.0} < static_cast<double>(m.count) - static_cast<double>(row * kRowPoints);
  load(m.place[row]->u.data(), u);
  load(m.place[row]->v.data(), v);
  u = inUse ? u : zero;
  v = inUse ? v : zero;
}

/// A row of a manifold's points.
SPRINGTOWER_INLINE void placePoints(const ContactView& m, const PlacedBlocks& blocks, const double* normal, std::size_t row,
                                    PlacedPoints& points) {
  if (m.phase == PairPhase::edge) {
    placeOnEdges(m, blocks, points);
    return;
  }
  Lanes u, v;
  loadPlaces(m, row, u, v);
  placeOnFaces(m, blocks, normal, u, v, points);
}

/// Where the friction of a row of points acts. Precondition: actsNearer(m).
SPRINGTOWER_INLINE void placeFriction(const ContactView& m, const PlacedBlocks& blocks, const double* normal, std::size_t row,
                                      PlacedPoints& points) {
  Lanes u, v;
  loadPlaces(m, row, u, v);
  const auto middleU = static_cast<double>(m.patch.u);
  const auto middleV = static_cast<double>(m.patch.v);
  const auto shrink = static_cast<double>(m.patch.shrink);
  placeOnFaces(m, blocks, normal, middleU + shrink * (u - middleU), middleV + shrink * (v - middleV), points);
}

}  // namespace springtower
