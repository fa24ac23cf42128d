#include "solver/contact/create.h"

#include "core/elementary.h"
#include "core/tuning.h"
#include "narrowphase/turning_face.h"
#include "solver/contact/persistence.h"
#include "solver/contact/update.h"
#include "solver/law/tolerances.h"
#include "solver/world/stage_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace springtower {

namespace {

ManifoldLimits limitsOf(const Simulation& simulation) {
  const double h = simulation.lengths.blockHeight_m;
  return {tuning::kMergeRadius * h, tuning::kManifoldReach * h};
}

double edgeSlackOf(const Simulation& simulation) {
  return tuning::kEdgeSlack * simulation.lengths.blockHeight_m;
}

// The overlap of the faces along the normal of one of them: that of b if `referenceIsB`, otherwise of a.
void faceManifold(const Separation& separation, const CornerView& a, const CornerView& b, const ManifoldLimits& limits,
                  const BlockPair& pair, bool referenceIsB, Manifold& fresh) {
  const CornerView& incidentBlock = referenceIsB ? a : b;
  const Vec3 towardsIncident = referenceIsB ? separation.normalFaceB : Vec3(-separation.normalFaceA);
  fresh.upper = referenceIsB ? pair.a : pair.b;
  fresh.lower = referenceIsB ? pair.b : pair.a;
  buildFaceManifold(incidentBlock, referenceIsB ? b : a, incidentFaceOf(incidentBlock, towardsIncident),
                    referenceIsB ? separation.faceOfB : separation.faceOfA, limits, fresh);
}

// Depth of the deepest point of a face manifold, m, and the number of points within `slack` of it.
struct Deepest {
  double depth = -std::numeric_limits<double>::infinity();
  int count = 0;
};

Deepest deepestPoints(const ContactView& manifold, const CornerView& upper, const CornerView& lower, double slack) {
  const FaceFrame face = faceFrame(lower, manifold.referenceFace);
  std::array<double, kManifoldPoints> depth{};
  const auto end = depth.begin() + manifold.count;
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    depth[i] = -face.normal.dot(pointOnIncidentFace(manifold, upper, i) - face.centre);
  }
  Deepest deepest;
  for (auto d = depth.begin(); d != end; ++d) deepest.depth = std::max(deepest.depth, *d);
  deepest.count = static_cast<int>(std::count_if(depth.begin(), end, [&](double d) { return d > deepest.depth - slack; }));
  return deepest;
}

void edgeManifold(const Separation& separation, const BlockPair& pair, Manifold& fresh) {
  fresh.upper = pair.a;
  fresh.lower = pair.b;
  startManifold(fresh, PairPhase::edge, separation.edgeOfA, separation.edgeOfB);
  fresh.count = 1;
}

// Whether faces touch although edges separate better: at two points or more, as deep as the edges. (The crossing of nearly
// parallel edges would be another point of the outline at each refresh, and give no resistance to sinking.) Faces far from
// parallel touch along a line at most, and then must separate as well as the edges. `shallower`: by how much the points of the
// faces may be less deep than the edges; otherwise they would be open although the blocks overlap at the edges.
bool sharesOutline(const Separation& separation, double face, const CornerView& upper, const CornerView& lower, double slack,
                   double shallower, const Manifold& fresh) {
  if (fresh.count < 2) return false;
  const Deepest deepest = deepestPoints(fresh, upper, lower, slack);
  if (deepest.count < 2 || deepest.depth > slack - separation.edge) return false;
  if (separation.edge < 0.0 && deepest.depth < -separation.edge - shallower) return false;
  const Vec3 incident = faceFrame(upper, fresh.incidentFace).normal;
  const Vec3 reference = faceFrame(lower, fresh.referenceFace).normal;
  return std::abs(incident.dot(reference)) >= tuning::kFaceCosine ||
         (face > separation.edge - slack && deepest.depth > -separation.edge - slack);
}

// Whether the edges that separate best may touch where no faces do: they cross. Edges that lie along one another to within a
// tolerance have the common normal of any two lines in space, which turns over when a block deforms by nanometres. Blocks that
// overlap by more than a tolerance touch in any case.
bool mayTouch(const Simulation& simulation, const Separation& separation, const CornerView& a, const CornerView& b) {
  if (!std::isfinite(separation.edge)) return false;
  if (separation.best() < -simulation.tolerance_m) return true;
  const auto along = [](const CornerView& block, int edge) {
    const auto& corners = kEdgeCorners[static_cast<std::size_t>(edge)];
    return Vec3(block.at(corners[1]) - block.at(corners[0]));
  };
  const Vec3 edgeA = along(a, separation.edgeOfA);
  const Vec3 edgeB = along(b, separation.edgeOfB);
  return edgeA.cross(edgeB).norm() > simulation.tolerance_m * std::max(edgeA.norm(), edgeB.norm());
}

// The touching faces or edges, from the best separating directions. The reference face changes only if the other is clearly
// better. Faces are preferred to edges that separate better, if they touch as well. If the outlines do not overlap, the next best
// direction is taken.
void chooseManifold(const IslandStep& step, const Separation& apart, const CornerView& a, const CornerView& b, double slack,
                    const BlockPair& pair, const ContactView& old, Manifold& fresh) {
  const Simulation& simulation = step.simulation;
  const ParticleArray& velocity = simulation.state.velocity;
  const Vec3 relative = centre(velocity, static_cast<std::size_t>(pair.a)) - centre(velocity, static_cast<std::size_t>(pair.b));
  const Separation separation = grazes(apart, grazingLimits(simulation), relative) ? alongLevel(apart) : apart;
  const ManifoldLimits limits = limitsOf(simulation);
  const double edgeSlack = edgeSlackOf(simulation);
  const bool wasA = old.phase == PairPhase::face && old.lower == pair.a;
  const bool wasB = old.phase == PairPhase::face && old.lower == pair.b;
  // Of two faces that separate as well it is that of a fixed block, or else of the higher one. (Along z in the first contacts of
  // a scene: no step has set its gravity yet.)
  const double ofA = simulation.model.isFixed(static_cast<std::size_t>(pair.a)) ? edgeSlack : 0.0;
  const double ofB = simulation.model.isFixed(static_cast<std::size_t>(pair.b)) ? edgeSlack : 0.0;
  const double alike = tuning::kAlikeFaces * simulation.lengths.blockHeight_m;
  const double preferred = prefersFaceOfB(separation, step.gravity, limits.mergeRadius) ? alike : -alike;
  const bool referenceIsB =
      separation.faceB + ofB + (wasB ? slack : 0.0) + preferred >= separation.faceA + ofA + (wasA ? slack : 0.0);
  const double face = referenceIsB ? separation.faceB : separation.faceA;
  const bool crossed = separation.edge > face + slack;
  faceManifold(separation, a, b, limits, pair, referenceIsB, fresh);
  const bool upperIsA = fresh.upper == pair.a;
  const double shallower = tuning::kEdgeDepthSlack * simulation.tolerance_m;
  const bool edgesTouch = crossed && (fresh.count > 0 || mayTouch(simulation, separation, a, b));
  if (edgesTouch && !sharesOutline(separation, face, upperIsA ? a : b, upperIsA ? b : a, edgeSlack, shallower, fresh)) {
    edgeManifold(separation, pair, fresh);
    return;
  }
  if (fresh.count == 0) faceManifold(separation, a, b, limits, pair, !referenceIsB, fresh);
  if (fresh.count == 0 && mayTouch(simulation, separation, a, b)) edgeManifold(separation, pair, fresh);
}

// The contact remains the pair's until the frame ends: the frame may be run again, or the blocks may touch again.
void markSeparated(PairTable& pairs, std::size_t at, const Vec3& axis, double clearance) {
  pairs.phase[at] = PairPhase::separated;
  pairs.setAxis(at, axis);
  pairs.clearance[at] = clearance;
}

void storeContact(Engine& engine, std::size_t at, const Manifold& manifold) {
  std::int32_t& contact = engine.pairs.contact[at];
  const bool parted = contact >= 0 && engine.pairs.phase[at] == PairPhase::separated;
  if (contact < 0) contact = engine.contacts.take();
  engine.pairs.phase[at] = manifold.phase;
  engine.contacts.store(contact, engine.pairs[at], manifold);
  if (parted) engine.contacts.setSticking(contact);  // how it slipped before is that of another face
}

// Largest distance of a block's corners from its affine part, m. Separating axes are exact for the affine parts, from
// which both corners and faces may differ by this distance: an apparent overlap of up to twice the sum of both warps may be no
// overlap of the faces.
double warp(const ParticleArray& position, std::size_t block) {
  const AffineField field = affineField(position, block);
  double largest = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) {
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      double place = field.centre[a];
      for (std::size_t k = 0; k < 3; ++k) place += 0.5 * cornerSide(c, k) * field.side[k][a];
      const double apart = position.values(a, block)[c] - place;
      squared += apart * apart;
    }
    largest = std::max(largest, squared);
  }
  return std::sqrt(largest);
}

// Gap up to which blocks touch, m: zero, except in the first frame, where it is the rounding of the placement.
double touchingGap(const Simulation& simulation) {
  return simulation.frame == 0 ? simulation.lengths.contactError_m : 0.0;
}

double lowestCorner(const CornerView& block) {
  return *std::min_element(block.z, block.z + kCorners);
}

void updateSeparatedFloor(IslandStep& step, std::size_t at, Counters& counters) {
  PairTable& pairs = step.engine.pairs;
  const auto block = static_cast<std::size_t>(pairs.key[at].a);
  const CornerView now = cornersOf(step.simulation.state.position, block);
  const double gap = lowestCorner(now);
  if (gap > touchingGap(step.simulation)) {
    pairs.clearance[at] = gap;
    return;
  }
  // Against a plane the cubic is linear: a corner that was above it and no longer is has crossed it.
  ++counters.cubicTests;
  pairs.clearance[at] = 0.0;
  if (!step.simulation.scene.settings.continuousTests) return;
  ++counters.cubicHits;
  const double before = lowestCorner(cornersOf(step.engine.memo.previous, block));
  if (step.simulation.frame > 0 && before < -step.simulation.lengths.contactError_m) ++counters.contactsCreatedPenetrating;
  ++counters.contactsCreated;
  Manifold fresh;
  fresh.upper = pairs.key[at].a;
  fresh.kind = step.pointKind;
  buildFloorManifold(now, limitsOf(step.simulation), fresh);
  storeContact(step.engine, at, fresh);
}

// Whether the face nearest to a direction separates the blocks throughout a step, turning with its block; if so, sets the
// clearance.
bool isSeparatedByTurningFace(const Vec3& normal, const MovingBlock& a, const MovingBlock& b, double touching, PairTable& pairs,
                              std::size_t at) {
  const TurningGap turning = gapAlongTurningFace(normal, a, b);
  if (!(turning.least > touching)) return false;
  pairs.setAxis(at, turning.normalAtEnd);
  pairs.clearance[at] = std::max(0.0, gapAlong(turning.normalAtEnd, a.end, b.end));
  return true;
}

// Stores the manifold of a separated pair at the present positions; returns whether it has any point.
bool storeManifoldNow(IslandStep& step, std::size_t at) {
  const BlockPair pair = step.engine.pairs.key[at];
  const ParticleArray& position = step.simulation.state.position;
  const CornerView a = cornersOf(position, static_cast<std::size_t>(pair.a));
  Manifold fresh;
  fresh.kind = step.pointKind;
  if (pair.b < 0) {
    fresh.upper = pair.a;
    buildFloorManifold(a, limitsOf(step.simulation), fresh);
  } else {
    const CornerView b = cornersOf(position, static_cast<std::size_t>(pair.b));
    chooseManifold(step, findSeparation(a, b), a, b, 0.0, pair, {}, fresh);
  }
  if (fresh.count > 0) storeContact(step.engine, at, fresh);
  return fresh.count > 0;
}

}  // namespace

GrazingLimits grazingLimits(const Simulation& simulation) {
  return {tuning::kGrazingOverlap * simulation.tolerance_m,
          tuning::kQuiescentDisplacement * simulation.tolerance_m / simulation.scene.settings.frame_s};
}

double refreshTravel(const Simulation& simulation) {
  return tuning::kRefreshTravel * simulation.lengths.blockHeight_m;
}

RefreshTravel refreshTravelOfExplicitSteps(const Simulation& simulation) {
  const double travel_m = refreshTravel(simulation);
  return {travel_m, travel_m, tuning::kRollingRefreshTravel * simulation.lengths.blockHeight_m};
}

RefreshTravel refreshTravelOfImplicitSteps(const Simulation& simulation) {
  const double travel_m = refreshTravel(simulation);
  return {travel_m, tuning::kSlidingRefreshTravel * simulation.lengths.blockHeight_m, travel_m};
}

void updateSeparated(IslandStep& step, std::size_t at, Counters& counters, StageTimes& times) {
  PairTable& pairs = step.engine.pairs;
  const BlockPair pair = pairs.key[at];
  if (pair.b < 0) {
    updateSeparatedFloor(step, at, counters);
    return;
  }
  const auto a = static_cast<std::size_t>(pair.a);
  const auto b = static_cast<std::size_t>(pair.b);
  const MovingBlock movingA{cornersOf(step.engine.memo.previous, a), cornersOf(step.simulation.state.position, a)};
  const MovingBlock movingB{cornersOf(step.engine.memo.previous, b), cornersOf(step.simulation.state.position, b)};

  // The clearance is the gap at the step's end: along a fixed direction no pair of points can close it with less travel.
  const double touching = touchingGap(step.simulation);
  const Vec3 axis = pairs.axisOf(at);
  const double gap = gapAlong(axis, movingA.end, movingB.end);
  if (gap > touching && gapAlong(axis, movingA.start, movingB.start) > touching) {
    pairs.clearance[at] = gap;
    return;
  }
  if (isSeparatedByTurningFace(axis, movingA, movingB, touching, pairs, at)) return;
  const Separation before = findSeparation(movingA.start, movingB.start);
  const Vec3& bestAxis = before.bestNormal();
  const double newGap = gapAlong(bestAxis, movingA.end, movingB.end);
  pairs.clearance[at] = std::max(0.0, newGap);
  pairs.setAxis(at, bestAxis);
  if (before.best() > touching && newGap > touching) return;
  const Vec3& face = before.faceA > before.faceB ? before.normalFaceA : before.normalFaceB;
  if (isSeparatedByTurningFace(face, movingA, movingB, touching, pairs, at)) return;
  // In the first frame nothing has moved, and features of touching blocks need not share a point: rounding may have placed them
  // slightly inside one another.
  const bool touchesAtStart = step.simulation.frame == 0 && before.best() <= touching;
  bool meet = false;
  if (step.simulation.scene.settings.continuousTests) {
    StageClock clock(times);
    meet = featuresMeet(movingA, movingB, counters) || touchesAtStart;
    clock.lap(Stage::cubicTests);
  }
  if (!meet) {
    pairs.clearance[at] = 0.0;
    return;
  }
  const double overlapError =
      step.simulation.lengths.contactError_m + 2.0 * (warp(step.engine.memo.previous, a) + warp(step.engine.memo.previous, b));
  if (step.simulation.frame > 0 && before.best() < -overlapError) ++counters.contactsCreatedPenetrating;
  Manifold fresh;
  fresh.kind = step.pointKind;
  chooseManifold(step, before, movingA.end, movingB.end, 0.0, pair, {}, fresh);
  pairs.clearance[at] = 0.0;
  if (fresh.count == 0) return;
  ++counters.contactsCreated;
  storeContact(step.engine, at, fresh);
}

void createAhead(IslandStep& step, std::size_t at, double reach_m) {
  const BlockPair pair = step.engine.pairs.key[at];
  const ParticleArray& position = step.simulation.state.position;
  const CornerView a = cornersOf(position, static_cast<std::size_t>(pair.a));
  if (pair.b < 0) {
    if (lowestCorner(a) <= reach_m) storeManifoldNow(step, at);
    return;
  }
  const Separation apart = findSeparation(a, cornersOf(position, static_cast<std::size_t>(pair.b)));
  if (apart.best() > reach_m || 2.0 * elementary::square(apart.bestNormal().dot(step.gravity.normalized())) < 1.0) return;
  storeManifoldNow(step, at);
}

void createTouching(IslandStep& step, std::size_t at, Counters& counters) {
  if (storeManifoldNow(step, at)) ++counters.contactsCreated;
}

double clearanceNow(const Simulation& simulation, std::size_t at) {
  const PairTable& pairs = simulation.engine->pairs;
  const BlockPair& pair = pairs.key[at];
  const CornerView a = cornersOf(simulation.state.position, static_cast<std::size_t>(pair.a));
  if (pair.b < 0) return std::max(0.0, lowestCorner(a));
  return std::max(0.0, gapAlong(pairs.axisOf(at), a, cornersOf(simulation.state.position, static_cast<std::size_t>(pair.b))));
}

void refreshManifold(IslandStep& step, std::size_t at, Counters& counters) {
  const Simulation& simulation = step.simulation;
  PairTable& pairs = step.engine.pairs;
  const BlockPair pair = pairs.key[at];
  const ContactView old = contactOf(step.engine, at);
  const ParticleArray& position = simulation.state.position;
  const ManifoldLimits limits = limitsOf(simulation);
  const double partingGap = simulation.lengths.partingGap_m;
  const double radius = tuning::kPointMatchRadius * simulation.lengths.blockHeight_m;
  ++counters.manifoldRefreshes;
  Manifold fresh;
  fresh.kind = old.kind;
  if (pair.b < 0) {
    const CornerView block = cornersOf(position, static_cast<std::size_t>(pair.a));
    const double gap = lowestCorner(block);
    if (gap > partingGap && !anyPointTouches(old)) {
      markSeparated(pairs, at, Vec3::UnitZ(), gap);
      return;
    }
    fresh.upper = pair.a;
    buildFloorManifold(block, limits, fresh);
  } else {
    const CornerView a = cornersOf(position, static_cast<std::size_t>(pair.a));
    const CornerView b = cornersOf(position, static_cast<std::size_t>(pair.b));
    const Separation separation = findSeparation(a, b);
    if (separation.best() > partingGap && !anyPointTouches(old)) {
      markSeparated(pairs, at, separation.bestNormal(), separation.best());
      return;
    }
    chooseManifold(step, separation, a, b, tuning::kReferenceFaceSlack * simulation.lengths.blockHeight_m, pair, old, fresh);
    if (fresh.count == 0) {
      markSeparated(pairs, at, separation.bestNormal(), std::max(0.0, separation.best()));
      return;
    }
  }
  transferPointState(old, position, step.law, radius, fresh);
  storeContact(step.engine, at, fresh);
}

}  // namespace springtower
