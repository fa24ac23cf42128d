#include "solver/contact/persistence.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// Depth of every point of a manifold at the blocks' present positions, m.
std::array<double, kManifoldPoints> depthsOf(const ContactView& manifold, const BlockFrame& a, const BlockFrame& b, bool upperIsA,
                                             const ContactLaw& law) {
  const AffineField still{};
  const ContactSide upper{upperIsA ? &a : &b, &still, &still};
  const ContactSide lower{manifold.lower < 0 ? nullptr : (upperIsA ? &b : &a), &still, &still};
  return pointForces(manifold, upper, lower, law).depth;
}

double elasticOf(const ContactView& manifold, std::size_t point, double depth) {
  const PenaltyRow& row = manifold.penalty(point);
  return row.touching[laneOf(point)] != 0.0 ? std::max(0.0, depth - row.restDepth[laneOf(point)]) : 0.0;
}

// Normal energy of one point over half its resting stiffness, m2.
double energyOf(const ContactView& manifold, std::size_t point, double elastic, const ContactLaw& law) {
  const PenaltyRow& row = manifold.penalty(point);
  const double lag = std::max(0.0, elastic - row.maxwellDepth[laneOf(point)]);
  return row.stiffening[laneOf(point)] * (elastic * elastic + law.maxwellRatio * lag * lag);
}

// Gives all new points that are already below the surface one rest depth (at most their own depth), so that together they store
// `budget`.
void shareAmongNew(const std::array<double, kManifoldPoints>& depth, double scale, double budget, const ContactLaw& law,
                   Manifold& fresh) {
  std::array<double, kManifoldPoints> found{};
  std::size_t count = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(fresh.count); ++i) {
    if (fresh.points[rowOf(i)].penalty.touching[laneOf(i)] != 0.0 || depth[i] <= 0.0) continue;
    std::size_t at = count++;  // deepest first
    for (; at > 0 && found[at - 1] < depth[i]; --at) found[at] = found[at - 1];
    found[at] = depth[i];
  }
  if (count == 0) return;
  const double target = budget / (scale * (1.0 + law.maxwellRatio));  // sum of (depth - surface)^2 over points below `surface`
  double surface = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t n = 1; n <= count; ++n) {
    sum += found[n - 1];
    squares += found[n - 1] * found[n - 1];
    const auto number = static_cast<double>(n);
    // n s^2 - 2 sum s + squares = target, the smaller root; the n deepest points suffice if the next one lies above that surface.
    const double root = sum * sum - number * (squares - target);
    surface = (sum - std::sqrt(std::max(0.0, root))) / number;
    if (n == count || found[n] <= surface) break;
  }
  surface = std::max(0.0, surface);
  for (std::size_t i = 0; i < static_cast<std::size_t>(fresh.count); ++i) {
    PenaltyRow& row = fresh.points[rowOf(i)].penalty;
    if (row.touching[laneOf(i)] != 0.0 || depth[i] <= 0.0) continue;
    row.touching[laneOf(i)] = 1.0;
    row.restDepth[laneOf(i)] = std::min(surface, depth[i]);
    row.stiffening[laneOf(i)] = scale;
  }
}

void keepEdge(const ContactView& old, Manifold& fresh) {
  const std::int8_t incident = fresh.incidentFace;
  const std::int8_t reference = fresh.referenceFace;
  fresh = copyOf(old);
  fresh.incidentFace = incident;
  fresh.referenceFace = reference;
}

}  // namespace

void transferPointState(const ContactView& old, const ParticleArray& position, const ContactLaw& law, double radius,
                        Manifold& fresh) {
  const auto oldUpper = static_cast<std::size_t>(old.upper);
  const auto freshUpper = static_cast<std::size_t>(fresh.upper);
  if (old.phase == PairPhase::edge && fresh.phase == PairPhase::edge) {
    keepEdge(old, fresh);
    if (fresh.incidentFace == old.incidentFace && fresh.referenceFace == old.referenceFace) return;
  } else {
    carryPoints(old, cornersOf(position, oldUpper), fresh, cornersOf(position, freshUpper), radius);
  }
  if (!anyPointTouches(old)) return;

  const BlockFrame a = blockFrame(position, oldUpper);
  const BlockFrame b = old.lower < 0 ? a : blockFrame(position, static_cast<std::size_t>(old.lower));
  const std::array<double, kManifoldPoints> depthBefore = depthsOf(old, a, b, true, law);
  const std::array<double, kManifoldPoints> depth = depthsOf(fresh, a, b, oldUpper == freshUpper, law);

  double stored = 0.0;
  double scale = 1.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(old.count); ++i) {
    stored += energyOf(old, i, elasticOf(old, i, depthBefore[i]), law);
    if (old.penalty(i).touching[laneOf(i)] != 0.0) scale = std::max(scale, old.penalty(i).stiffening[laneOf(i)]);
  }
  double kept = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(fresh.count); ++i)
    kept += energyOf(fresh, i, elasticOf(fresh, i, depth[i]), law);
  if (kept <= stored) {
    shareAmongNew(depth, scale, stored - kept, law, fresh);
    return;
  }
  const double share = std::sqrt(stored / kept);
  for (std::size_t i = 0; i < static_cast<std::size_t>(fresh.count); ++i) {
    const double elastic = elasticOf(fresh, i, depth[i]);
    if (elastic <= 0.0) continue;
    PenaltyRow& row = fresh.points[rowOf(i)].penalty;
    row.restDepth[laneOf(i)] = depth[i] - share * elastic;
    row.maxwellDepth[laneOf(i)] *= share;
  }
}

}  // namespace springtower
