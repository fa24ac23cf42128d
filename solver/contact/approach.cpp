#include "solver/contact/approach.h"

#include "core/tuning.h"
#include "solver/block/affine.h"
#include "solver/block/inertia.h"
#include "solver/contact/create.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/world/checkpoint.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springtower {

namespace {

// Gap of a pair along a direction from b to a, m; to the floor along its normal.
double gapOf(const BlockPair& pair, const Vec3& direction, const ParticleArray& position) {
  const CornerView a = cornersOf(position, static_cast<std::size_t>(pair.a));
  if (pair.b >= 0) return gapAlong(direction, a, cornersOf(position, static_cast<std::size_t>(pair.b)));
  return *std::min_element(a.z, a.z + kCorners);
}

// Closing speed of a separated pair along its stored axis, m/s; and the gap, m.
struct Closing {
  double gap;
  double speed;
};

Closing closingOf(const Simulation& simulation, std::size_t at) {
  const BlockPair& pair = simulation.engine->pairs.key[at];
  const Vec3 axis = simulation.engine->pairs.axisOf(at);
  const auto a = static_cast<std::size_t>(pair.a);
  const ParticleArray& x = simulation.state.position;
  const ParticleArray& v = simulation.state.velocity;
  double least = 1e300;
  double leastSoon = 1e300;
  const double soon = simulation.scene.settings.frame_s;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const double along = axis.dot(x.at(a, c));
    least = std::min(least, along);
    leastSoon = std::min(leastSoon, along + soon * axis.dot(v.at(a, c)));
  }
  double most = 0.0;
  double mostSoon = 0.0;
  if (pair.b >= 0) {
    const auto b = static_cast<std::size_t>(pair.b);
    most = mostSoon = -1e300;
    for (std::size_t c = 0; c < kCorners; ++c) {
      const double along = axis.dot(x.at(b, c));
      most = std::max(most, along);
      mostSoon = std::max(mostSoon, along + soon * axis.dot(v.at(b, c)));
    }
  }
  const double gap = least - most;
  const double gapSoon = leastSoon - mostSoon;
  return {gap, (gap - gapSoon) / soon};
}

// The same along the best separating direction now and at the end of the frame: along a fixed direction, blocks that lie side by
// side and topple together would appear to close.
Closing closingOfShapes(const Simulation& simulation, const BlockPair& pair) {
  const auto a = static_cast<std::size_t>(pair.a);
  const auto b = static_cast<std::size_t>(pair.b);
  const ParticleArray& x = simulation.state.position;
  const double soon = simulation.scene.settings.frame_s;
  double moved[2][3][kCorners];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double* xa = x.values(axis, a);
    const double* xb = x.values(axis, b);
    const double* va = simulation.state.velocity.values(axis, a);
    const double* vb = simulation.state.velocity.values(axis, b);
    for (std::size_t c = 0; c < kCorners; ++c) {
      moved[0][axis][c] = xa[c] + soon * va[c];
      moved[1][axis][c] = xb[c] + soon * vb[c];
    }
  }
  const double gap = findSeparation(cornersOf(x, a), cornersOf(x, b)).best();
  const double gapSoon = findSeparation({moved[0][0], moved[0][1], moved[0][2]}, {moved[1][0], moved[1][1], moved[1][2]}).best();
  return {gap, (gap - gapSoon) / soon};
}

// Upper bound of the displacement of a block's corners in the step just computed, m; 0 for the floor and sleeping blocks.
double displacementOf(const IslandStep& step, std::int32_t block) {
  if (sleeps(step.simulation, block) && !isDriven(step, block)) return 0.0;
  const auto b = static_cast<std::size_t>(block);
  double largest = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double* now = step.simulation.state.position.values(a, b);
    const double* before = step.engine.memo.previous.values(a, b);
    for (std::size_t c = 0; c < kCorners; ++c) largest = std::max(largest, std::abs(now[c] - before[c]));
  }
  return std::sqrt(3.0) * largest;
}

// Largest closing of a pair in the step of its first contact, m: at a quarter of the speed that contacts of resting stiffness
// stop within the target depth of an impact.
double maxFirstClosing(const IslandStep& step, const BlockPair& pair) {
  const double reduced = reducedMass(step.simulation.model, pair.a, pair.b);
  const double stiffness = step.law.stiffnessOf(pair.a, pair.b);
  return tuning::kMaxFirstClosingShare * step.law.impactPenetration_m * std::sqrt(stiffness / reduced) * step.drift_s;
}

// First contact of a separated pair in the step just computed: overlap at its end, m, negative where there is none, and the
// distance by which the blocks closed, m. `displacement`: upper bound of that distance.
struct FirstTouch {
  double overlap = -1.0;
  double closed = 0.0;
};

FirstTouch firstTouchOf(const IslandStep& step, std::size_t at, double displacement) {
  const Engine& engine = step.engine;
  const BlockPair& pair = engine.pairs.key[at];
  if (travelOf(engine, at) - engine.pairs.travelAtCheck[at] + displacement < engine.pairs.clearance[at]) return {};
  const ParticleArray& now = step.simulation.state.position;
  Vec3 direction = pair.b >= 0 ? engine.pairs.axisOf(at) : Vec3(Vec3::UnitZ());
  if (gapOf(pair, direction, now) > 0.0) return {};
  if (pair.b >= 0) {  // another direction may still separate them
    direction = findSeparation(cornersOf(engine.memo.previous, static_cast<std::size_t>(pair.a)),
                               cornersOf(engine.memo.previous, static_cast<std::size_t>(pair.b)))
                    .bestNormal();
  }
  const double gap = gapOf(pair, direction, now);
  return {-gap, gapOf(pair, direction, engine.memo.previous) - gap};
}

// Depth of every point of a manifold with the blocks at these positions, m.
std::array<double, kManifoldPoints> depthsAt(const IslandStep& step, const ContactView& manifold, const ParticleArray& position) {
  const AffineField still{};
  const BlockFrame upper = blockFrame(position, static_cast<std::size_t>(manifold.upper));
  const BlockFrame lower = manifold.lower < 0 ? upper : blockFrame(position, static_cast<std::size_t>(manifold.lower));
  return pointForces(manifold, {&upper, &still, &still}, {manifold.lower < 0 ? nullptr : &lower, &still, &still}, step.law).depth;
}

// Overlap of the blocks of a pair along their best separating direction, or of a block and the floor, m; negative where they are
// apart.
double overlapAt(const BlockPair& pair, const ParticleArray& position) {
  if (pair.b < 0) return -gapOf(pair, Vec3::UnitZ(), position);
  return -findSeparation(cornersOf(position, static_cast<std::size_t>(pair.a)),
                         cornersOf(position, static_cast<std::size_t>(pair.b)))
              .best();
}

// Whether a touching pair has an impact in the step just computed: points that first touch in it closed too fast, or the blocks
// overlap by more than `most` beyond their deepest point and beyond what they overlapped before. `displacement`: upper bound of
// their relative displacement, m.
bool hasImpact(const IslandStep& step, std::size_t at, double displacement, double most) {
  const BlockPair& pair = step.engine.pairs.key[at];
  const ContactView manifold = contactOf(step.engine, at);
  const ContactView trial = trialOf(step.engine, at, manifold);
  const auto count = static_cast<std::size_t>(manifold.count);
  bool begins = false;
  bool touches = false;
  for (std::size_t i = 0; i < count; ++i) {
    touches = touches || touchingAt(trial, i) != 0.0;
    begins = begins || (touchingAt(trial, i) != 0.0 && touchingAt(manifold, i) == 0.0);
  }
  const bool listIsOld = !touches || displacement > refreshTravel(step.simulation);
  if (!begins && !listIsOld) return false;
  const ParticleArray& now = step.simulation.state.position;
  const std::array<double, kManifoldPoints> depth = depthsAt(step, manifold, now);
  if (begins) {
    const std::array<double, kManifoldPoints> before = depthsAt(step, manifold, step.engine.memo.previous);
    const double maxClosing = maxFirstClosing(step, pair);
    for (std::size_t i = 0; i < count; ++i) {
      if (touchingAt(trial, i) != 0.0 && touchingAt(manifold, i) == 0.0 && depth[i] - before[i] > maxClosing) return true;
    }
  }
  if (!listIsOld) return false;
  const double known = std::max(0.0, *std::max_element(depth.begin(), depth.begin() + manifold.count));
  const double overlap = overlapAt(pair, now);
  return overlap > known + most && overlap > overlapAt(pair, step.engine.memo.previous) + most;
}

// Smallest opening or closing speed over the points of a manifold, m/s; over those that touched last, if any did. A point that is
// open and opens further counts as 0: it has parted, as where the end of a drawn block leaves its support. After rigid steps
// it counts in full, because it may be rebounding.
double slowestRate(const IslandStep& step, const ContactView& manifold) {
  const MotionState& state = step.simulation.state;
  const auto u = static_cast<std::size_t>(manifold.upper);
  // Of the floor nothing is used. The block in its place is this island's own: another one might be moving meanwhile.
  const auto l = static_cast<std::size_t>(manifold.lower < 0 ? manifold.upper : manifold.lower);
  const AffineField still{};
  const BlockFrame upper = blockFrame(state.position, u);
  const BlockFrame lower = blockFrame(state.position, l);
  const AffineField upperMotion = affineField(state.velocity, u);
  const AffineField lowerMotion = manifold.lower < 0 ? still : affineField(state.velocity, l);
  const PointForces points =
      pointForces(manifold, {&upper, &still, &still}, {manifold.lower < 0 ? nullptr : &lower, &still, &still}, step.law);
  const bool any = anyPointTouches(manifold);
  const bool rebounds =
      step.engine.memo.blockHistory[u].explicitLast || (manifold.lower >= 0 && step.engine.memo.blockHistory[l].explicitLast);
  double slowest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    if (any && touchingAt(manifold, i) == 0.0) continue;
    const Vec3 apart = velocityAt(upper, upperMotion, points.place[i]) - velocityAt(lower, lowerMotion, points.lowerPlace[i]);
    const double opening = points.direction.dot(apart);
    const bool parted = !rebounds && points.depth[i] <= 0.0 && opening > 0.0;
    slowest = std::min(slowest, parted ? 0.0 : std::abs(opening));
  }
  return slowest;
}

double speedOf(const IslandStep& step, std::int32_t block) {
  if (sleeps(step.simulation, block) && !isDriven(step, block)) return 0.0;
  return fastestCorner(step.simulation.state.velocity, static_cast<std::size_t>(block), Vec3::Zero());
}

}  // namespace

double fastestCorner(const ParticleArray& velocity, std::size_t block, const Vec3& against) {
  double squared = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) squared = std::max(squared, (velocity.at(block, c) - against).squaredNorm());
  return std::sqrt(squared);
}

namespace {

// What an estimate of approach takes of the blocks of a pair.
struct PairMotion {
  double speed;    // m/s, upper bound of that at which they approach
  double reduced;  // kg, mass
  double inverse;  // 1/kg, of a point on which a contact acts
  bool resting;    // whether both have been at rest and so are supported: any other may be in free fall
};

PairMotion pairMotion(const Simulation& simulation, const BlockPair& pair) {
  const ParticleArray& velocity = simulation.state.velocity;
  const double corner = affineCornerInverseMass(simulation.scene.settings.inertia);
  const double reduced = reducedMass(simulation.model, pair.a, pair.b);
  if (isFixed(simulation, pair.b) || isFixed(simulation, pair.a)) {
    const auto moving = static_cast<std::size_t>(isFixed(simulation, pair.b) ? pair.a : pair.b);
    const std::int32_t other = isFixed(simulation, pair.b) ? pair.b : pair.a;
    const double driven = other < 0 ? 0.0 : fastestCorner(velocity, static_cast<std::size_t>(other), Vec3::Zero());
    return {fastestCorner(velocity, moving, Vec3::Zero()) + driven, reduced, corner / reduced,
            simulation.restTime_s[moving] > 0.0};
  }
  const auto a = static_cast<std::size_t>(pair.a);
  const auto b = static_cast<std::size_t>(pair.b);
  const Vec3 common = 0.5 * (centre(velocity, a) + centre(velocity, b));
  return {fastestCorner(velocity, a, common) + fastestCorner(velocity, b, common), reduced,
          corner / simulation.model.mass[a] + corner / simulation.model.mass[b],
          simulation.restTime_s[a] > 0.0 && simulation.restTime_s[b] > 0.0};
}

}  // namespace

ApproachEstimate estimateApproach(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  std::vector<std::uint16_t>& newContacts = step.engine.scratch.newContactCount;
  for (const std::int32_t block : step.blocks) newContacts[static_cast<std::size_t>(block)] = 0;
  const double frame_s = simulation.scene.settings.frame_s;
  const double fall = simulation.scene.gravity.magnitude * frame_s;
  ApproachEstimate approach;
  const PairTable& pairs = step.engine.pairs;
  for (const std::int32_t position : step.pairs) {
    const auto at = static_cast<std::size_t>(position);
    const BlockPair& pair = pairs.key[at];
    const PairMotion motion = pairMotion(simulation, pair);
    double speed = motion.speed;
    if (!motion.resting) speed += fall;
    const bool apart = !pairs.touches(at);
    const bool mayMeet = apart && pairs.clearance[at] - (travelOf(step.engine, at) - pairs.travelAtCheck[at]) < speed * frame_s;
    if (apart && !mayMeet) continue;
    if (apart || !anyPointTouches(contactOf(step.engine, at))) {
      for (const std::int32_t block : {pair.a, pair.b}) {  // sleeping blocks may belong to other islands as well, and do not move
        if (!sleeps(simulation, block))
          approach.together = std::max<std::int32_t>(approach.together, ++newContacts[static_cast<std::size_t>(block)]);
      }
    }
    approach.meeting = approach.meeting || mayMeet;
    const double stiffness = step.law.stiffnessOf(pair.a, pair.b);
    const double depth = step.law.impactPenetration_m;
    approach.stiffening = std::max(approach.stiffening, motion.reduced * speed * speed / (depth * depth * stiffness));
    approach.pointRate = std::max(approach.pointRate, 2.0 * stiffness * (1.0 + step.law.maxwellRatio) * motion.inverse);
  }
  return approach;
}

bool bounces(const IslandStep& step, double step_s) {
  const double most = tuning::kMaxImplicitClosing * step.simulation.tolerance_m / step_s;
  const double fastest = largestOfBlocks(step, [&](std::size_t b) { return speedOf(step, static_cast<std::int32_t>(b)); });
  if (2.0 * fastest <= most) return false;
  return anyPair(step, [&](std::size_t at) {
    if (!step.engine.pairs.touches(at)) return false;
    const BlockPair& key = step.engine.pairs.key[at];
    if (speedOf(step, key.a) + speedOf(step, key.b) <= most) return false;
    return slowestRate(step, contactOf(step.engine, at)) > most;
  });
}

namespace {

// Whether two blocks that do not touch will meet before long, faster than `most` (m/s).
bool isAboutToMeet(const IslandStep& step, double most) {
  const Simulation& simulation = step.simulation;
  const double frame_s = simulation.scene.settings.frame_s;
  const auto soon = [&](const Closing& closing) {
    const double reach = frame_s * (std::max(0.0, closing.speed) + 0.5 * frame_s * simulation.scene.gravity.magnitude);
    return closing.gap < reach && closing.speed > most;
  };
  return anyPair(step, [&](std::size_t at) {
    if (step.engine.pairs.touches(at)) return false;
    const BlockPair& key = step.engine.pairs.key[at];
    return soon(closingOf(simulation, at)) && (key.b < 0 || soon(closingOfShapes(simulation, key)));
  });
}

}  // namespace

bool isAboutToCollide(const IslandStep& step, double step_s) {
  // Faster ones rebound, which implicit steps do not resolve; what a hand leads or a force pushes does not get away.
  const double resolved = tuning::kMaxImplicitClosing * step.simulation.tolerance_m / step_s;
  const bool led = holdsTether(step) || isPushed(step);
  return isAboutToMeet(step, led ? resolved : std::min(resolved, leastReboundSpeed(step.simulation)));
}

bool isAboutToRebound(const IslandStep& step) {
  return isAboutToMeet(step, leastReboundSpeed(step.simulation));
}

FirstContact findFirstContacts(IslandStep& step) {
  const double most = tuning::kMaxFirstOverlap * step.simulation.tolerance_m;
  const double longest = largestOfBlocks(step, [&](std::size_t b) { return displacementOf(step, static_cast<std::int32_t>(b)); });
  if (2.0 * longest <= most) return FirstContact::none;
  FirstContact found = FirstContact::none;
  PairTable& pairs = step.engine.pairs;
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    const BlockPair& key = pairs.key[at];
    const double displacement = displacementOf(step, key.a) + displacementOf(step, key.b);
    if (displacement <= most) continue;
    if (pairs.touches(at)) {
      if (hasImpact(step, at, displacement, most)) return FirstContact::impact;
      continue;
    }
    const FirstTouch touch = firstTouchOf(step, at, displacement);
    if (touch.overlap <= 0.0) continue;
    if (touch.closed > maxFirstClosing(step, key)) return FirstContact::impact;
    if (touch.overlap <= most) continue;
    savePair(step.engine, at);
    pairs.travelAtCheck[at] = travelOf(step.engine, at);
    updateSeparated(step, at, step.counters, step.times);
    if (pairs.touches(at)) {
      found = FirstContact::added;
    } else {
      pairs.clearance[at] = 0.0;  // belongs to the end of this step, which may be solved again
    }
  }
  return found;
}

}  // namespace springtower
