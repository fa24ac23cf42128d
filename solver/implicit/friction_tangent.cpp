#include "solver/implicit/friction_tangent.h"

#include "solver/law/point_places.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <numeric>

namespace springtower {

namespace {

// The part in the factors is subtracted, that of the present contacts added.
enum class Part { factors, contacts };

Vec3 normalOf(const ContactTangent& tangent) {
  return {tangent.normal[0], tangent.normal[1], tangent.normal[2]};
}

// Normal force of a point on upper without damping, N.
double pushOf(const ContactLaw& law, const ContactView& trial, std::size_t i, double stiffness, double depth) {
  const PenaltyRow& row = trial.penalty(i);
  const std::size_t lane = laneOf(i);
  const double elastic = depth - row.restDepth[lane];
  return std::max(0.0, stiffness * row.stiffening[lane] * (elastic + law.maxwellRatio * (elastic - row.maxwellDepth[lane])));
}

// Tangents of a touching pair with this active set: one for every four points, and another for their friction where it acts
// elsewhere.
std::size_t tangentCount(const IslandStep& step, const NewtonSystem& island, std::size_t at, ActiveSetBits mask) {
  if ((mask & kAllPoints) == 0) return 0;
  const std::int32_t contact = step.engine.pairs.contact[static_cast<std::size_t>(island.touching[at])];
  const auto pair = static_cast<std::size_t>(island.touching[at]);
  const bool nearer = step.engine.contacts.shape(contact).slips && actsNearer(contactOf(step.engine, pair));
  return rowsFor(step.engine.contacts.shape(contact).count) * (nearer ? 2 : 1);
}

// The nodes of a tangent's blocks, and what all its points have in common.
void setPair(const IslandStep& step, const ContactView& m, const double* normal, ContactTangent& tangent) {
  const std::vector<std::uint8_t>& asleep = step.simulation.asleep;
  const Engine& engine = step.engine;
  const auto nodeOf = [&](std::int32_t block) {
    const bool moves = block >= 0 && asleep[static_cast<std::size_t>(block)] == 0;
    return moves ? engine.scratch.nodeOf[static_cast<std::size_t>(block)] : -1;
  };
  tangent = {};
  tangent.upper = nodeOf(m.upper);
  tangent.lower = nodeOf(m.lower);
  for (std::size_t k = 0; k < 3; ++k) tangent.normal[k] = normal[k];
  if (tangent.lower < 0) return;
  const BlockFrame& lower = engine.memo.frames[static_cast<std::size_t>(m.lower)];
  for (std::size_t a = 0; a < 3; ++a) std::copy_n(lower.dual[a].begin(), 3, tangent.dual[a]);
}

// Writes the weights of a row of points.
SPRINGTOWER_INLINE void setWeights(const PlacedPoints& points, bool floor, ContactTangent& tangent) {
  for (std::size_t a = 0; a < 3; ++a) {
    tangent.upperWeight[a] = points.upper[a];
    if (!floor) tangent.lowerWeight[a] = points.lower[a];
  }
}

// Writes what point `lane` resists with: `tangent` along the normal, `across` by its friction; where that acts at the point
// itself, both are one.
void setStiffness(const PointStiffness& resists, double sign, std::size_t lane, ContactTangent& tangent, ContactTangent& across) {
  if (&across != &tangent) {
    tangent.alongNormal[lane] = sign * resists.normal;
    across.alongNormal[lane] = -sign * resists.tangential;
  } else {
    tangent.alongNormal[lane] = sign * (resists.normal - resists.tangential);
  }
  across.isotropic[lane] = sign * resists.tangential;
  for (std::size_t k = 0; k < 3; ++k) tangent.slip[k][lane] = across.slip[k][lane] = resists.slip[static_cast<Eigen::Index>(k)];
  across.alongSlip[lane] = -sign * resists.tangential;
}

// Writes how the friction of a slipping point follows its normal force, `push` (N).
void setCoupling(const PointStiffness& resists, double friction, double push, std::size_t lane, ContactTangent& tangent,
                 ContactTangent& across) {
  across.coupling[lane] = friction * resists.normal;
  const bool nearer = &across != &tangent;
  const Vec3 pushed = nearer ? Vec3(push * normalOf(tangent)) : Vec3(push * (normalOf(tangent) - friction * resists.slip));
  for (std::size_t k = 0; k < 3; ++k) {
    tangent.push[k][lane] = pushed[static_cast<Eigen::Index>(k)];
    if (nearer) across.push[k][lane] = -push * friction * resists.slip[static_cast<Eigen::Index>(k)];
  }
}

// Writes a pair's tangents; returns the place behind them.
SPRINGTOWER_KERNEL
ContactTangent* putPair(const IslandStep& step, const NewtonSystem& island, std::size_t at, ActiveSetBits mask, Part part,
                        double step_s, ContactTangent* to) {
  if ((mask & kAllPoints) == 0) return to;
  const Engine& engine = step.engine;
  const auto pair = static_cast<std::size_t>(island.touching[at]);
  const ContactView m = contactOf(engine, pair);
  const ContactView trial = trialOf(engine, pair, m);
  const bool nearer = actsNearer(m);
  const bool floor = m.lower < 0;
  const PlacedBlocks blocks{engine.memo.frames[static_cast<std::size_t>(m.upper)],
                            floor ? nullptr : &engine.memo.frames[static_cast<std::size_t>(m.lower)]};
  const double stiffness = step.law.stiffnessOf(m.upper, m.lower);
  const double friction = step.law.frictionOf(m);
  double normal[3];
  normalOf(m, blocks, normal);

  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count);) {
    PlacedPoints points;
    placePoints(m, blocks, normal, rowOf(i), points);
    ContactTangent& tangent = *to++;
    setPair(step, m, normal, tangent);
    setWeights(points, floor, tangent);
    ContactTangent& across = nearer ? *to++ : tangent;
    if (nearer) {
      setPair(step, m, normal, across);
      across.followsPush = true;
      PlacedPoints slips;
      placeFriction(m, blocks, normal, rowOf(i), slips);
      setWeights(slips, floor, across);
    }
    const std::size_t end = std::min(i + kRowPoints, static_cast<std::size_t>(m.count));
    for (; i < end; ++i) {
      if ((mask & kPushBit << i) == 0) continue;
      const PointStiffness resists = pointStiffness(step, m, trial, mask, i, step_s);
      setStiffness(resists, part == Part::factors ? 1.0 : -1.0, laneOf(i), tangent, across);
      if (part == Part::factors || (mask & kSlideBit << i) == 0) continue;
      const double push = pushOf(step.law, trial, i, stiffness, points.depth[laneOf(i)]);
      setCoupling(resists, friction, push, laneOf(i), tangent, across);
    }
  }
  return to;
}

// Appends the tangents that put(at, place) writes for each touching pair, count(at) of them, in order.
template <class Count, class Put>
void appendTangents(const IslandStep& step, NewtonSystem& island, const Count& count, const Put& put,
                    AlignedVector<ContactTangent>& to) {
  const std::size_t pairs = island.touching.size();
  if (!isWide(step)) {
    for (std::size_t at = 0; at < pairs; ++at) {
      const std::size_t before = to.size();
      to.resize(before + count(at));
      if (to.size() > before) put(at, to.data() + before);
    }
    return;
  }
  std::vector<std::int32_t>& start = island.tangentStart;
  const auto overTouching = [&](const auto& kernel) { forRanges(pairs, tuning::kPairGrain, true, kernel); };
  start.resize(pairs + 1);
  start[0] = static_cast<std::int32_t>(to.size());
  overTouching([&](std::size_t first, std::size_t last) {
    for (std::size_t at = first; at < last; ++at) start[at + 1] = static_cast<std::int32_t>(count(at));
  });
  std::partial_sum(start.begin(), start.end(), start.begin());
  to.resize(static_cast<std::size_t>(start[pairs]));
  overTouching([&](std::size_t first, std::size_t last) {
    for (std::size_t at = first; at < last; ++at) {
      if (start[at + 1] > start[at]) put(at, to.data() + start[at]);
    }
  });
}

// Whether the Maxwell branch of a point that pushes has nothing left to release: its relaxed depth is at the bound that follows
// the elastic depth, so that only the damping resists.
SPRINGTOWER_INLINE bool isSpent(const IslandStep& step, const PenaltyRow& before, const PenaltyRow& now, std::size_t lane) {
  const ContactLaw& law = step.law;
  const double relaxed = now.maxwellDepth[lane];
  if (!(relaxed < before.maxwellDepth[lane]) || !(law.maxwellRatio > 0.0) || now.touching[lane] != 1.0) return false;
  const double elastic = relaxed / (1.0 + 1.0 / law.maxwellRatio);  // if it is at the bound
  const double lag = before.maxwellDepth[lane] - elastic;
  return elastic + lag * law.maxwellTime_s / (law.maxwellTime_s + step.drift_s) >= relaxed;
}

// Adds sign * [sum f, sums f times weight] to one block's forces.
SPRINGTOWER_INLINE void addSums(const Lanes (&f)[3], const Lanes (&weight)[3], double sign, double* force) {
  for (std::size_t k = 0; k < 3; ++k) {
    force[k] += sign * sum(f[k]);
    for (std::size_t a = 0; a < 3; ++a) force[3 + 3 * a + k] += sign * sum(weight[a] * f[k]);
  }
}

SPRINGTOWER_INLINE void addMotion(const double* d, const Lanes (&weight)[3], double sign, Lanes (&g)[3]) {
  for (std::size_t k = 0; k < 3; ++k) g[k] += sign * (d[k] + weight[0] * d[3 + k] + weight[1] * d[6 + k] + weight[2] * d[9 + k]);
}

}  // namespace

ActiveSetBits activeSetBits(const IslandStep& step, const NewtonSystem& island, std::size_t at) {
  const ContactPool& contacts = step.engine.contacts;
  const std::int32_t contact = step.engine.pairs.contact[static_cast<std::size_t>(island.touching[at])];
  const ConstPointRows trial = contacts.trial(contact);
  const ConstPointRows before = contacts.points(contact);
  const ConstPointRows& slid = island.trialIsAhead ? trial : before;
  const auto count = static_cast<std::size_t>(contacts.shape(contact).count);
  if (island.assumesSupport) return allPush(count);
  const double least = island.isNear ? 1.0 : kTouchingWithoutForce;
  ActiveSetBits mask = 0;
  for (std::size_t first = 0; first < count; first += kRowPoints) {
    const PenaltyRow& now = trial[rowOf(first)]->penalty;
    const FourValues& slipRatio = slid[rowOf(first)]->penalty.slipRatio;
    for (std::size_t lane = 0; lane < kRowPoints && first + lane < count; ++lane) {
      if (now.touching[lane] < least) continue;
      mask |= kPushBit << (first + lane);
      if (slipRatio[lane] != 0.0) mask |= kSlideBit << (first + lane);
      if (isSpent(step, before[rowOf(first)]->penalty, now, lane)) mask |= kSpentBit << (first + lane);
    }
  }
  return mask;
}

PointStiffness pointStiffness(const IslandStep& step, const ContactView& manifold, const ContactView& trial, ActiveSetBits mask,
                              std::size_t i, double step_s) {
  const ContactLaw& law = step.law;
  const double stiffness = law.stiffnessOf(manifold.upper, manifold.lower);
  const PenaltyRow& row = trial.penalty(i);
  const std::size_t lane = laneOf(i);
  // First contact in this step: its Maxwell branch has not relaxed.
  const bool born = touchingAt(manifold, i) == 0.0;
  // The damping velocity of a spring that begins to push in this step is its elastic depth over the step.
  const bool pushedBefore = touchingAt(manifold, i) == 1.0;
  const double damping = law.dampingTime_s / step_s;
  const double relaxing = born ? law.maxwellRatio : law.maxwellRatio * law.maxwellTime_s / (law.maxwellTime_s + step.drift_s);
  const bool smoothed = step.smoothing_j > 0.0;
  const double k = stiffness * (smoothed ? row.stiffening[lane] : std::max(1.0, row.stiffening[lane]));
  const double held = smoothed ? stiffness * stiffestOf(manifold.penalty(i)) : k;
  const double spring = (mask & kSpentBit << i) != 0 ? 0.0 : 1.0 + relaxing;
  PointStiffness result;
  result.normal = k * (spring + (pushedBefore ? damping : law.dampingTime_s / step.drift_s));
  result.tangential = held * (law.tangentialRatio * (1.0 + damping));
  if ((mask & kSlideBit << i) != 0) {
    // Before the first displacement the slip of the step before applies.
    result.tangential *= row.slipRatio[lane] > 0.0 ? row.slipRatio[lane] : manifold.penalty(i).slipRatio[lane];
    result.slip = vectorAt(row.displacement, i).normalized();
  }
  return result;
}

void findFactorTangents(const IslandStep& step, NewtonSystem& island, double step_s) {
  island.factorTangents.clear();
  if (std::none_of(island.mask.begin(), island.mask.end(), anySlides)) return;
  appendTangents(
      step, island,
      [&](std::size_t at) { return anySlides(island.mask[at]) ? tangentCount(step, island, at, island.mask[at]) : 0; },
      [&](std::size_t at, ContactTangent* to) { putPair(step, island, at, island.mask[at], Part::factors, step_s, to); },
      island.factorTangents);
}

void findTangents(const IslandStep& step, NewtonSystem& island, double step_s) {
  island.tangents = island.factorTangents;
  // The part in the factors, unless factorTangents has it already, and that of the present contacts.
  const auto count = [&](std::size_t at) {
    const ActiveSetBits mask = island.active[at];
    if (mask == island.mask[at] && !anySlides(mask)) return std::size_t{0};
    const std::size_t known = anySlides(island.mask[at]) ? 0 : tangentCount(step, island, at, island.mask[at]);
    return known + tangentCount(step, island, at, mask);
  };
  const auto put = [&](std::size_t at, ContactTangent* to) {
    if (!anySlides(island.mask[at])) to = putPair(step, island, at, island.mask[at], Part::factors, step_s, to);
    putPair(step, island, at, island.active[at], Part::contacts, step_s, to);
  };
  appendTangents(step, island, count, put, island.tangents);
}

SPRINGTOWER_KERNEL
void addTangentForces(std::span<const ContactTangent> tangents, std::span<const double> displacement, std::span<double> force) {
  Lanes push = {};  // motion along the normal where the last tangent's points push
  for (const ContactTangent& tangent : tangents) {
    Lanes g[3] = {};
    if (tangent.upper >= 0)
      addMotion(displacement.data() + kNodeSize * static_cast<std::size_t>(tangent.upper), tangent.upperWeight, 1.0, g);
    if (tangent.lower >= 0)
      addMotion(displacement.data() + kNodeSize * static_cast<std::size_t>(tangent.lower), tangent.lowerWeight, -1.0, g);
    const Lanes along = g[0] * tangent.normal[0] + g[1] * tangent.normal[1] + g[2] * tangent.normal[2];
    const Lanes slid = g[0] * tangent.slip[0] + g[1] * tangent.slip[1] + g[2] * tangent.slip[2];
    const Lanes onNormal = tangent.alongNormal * along;
    if (!tangent.followsPush) push = along;
    const Lanes onSlip = tangent.alongSlip * slid + tangent.coupling * push;
    Lanes f[3];
    for (std::size_t k = 0; k < 3; ++k) f[k] = tangent.isotropic * g[k] + onNormal * tangent.normal[k] + onSlip * tangent.slip[k];
    if (tangent.upper >= 0)
      addSums(f, tangent.upperWeight, 1.0, force.data() + kNodeSize * static_cast<std::size_t>(tangent.upper));
    if (tangent.lower < 0) continue;
    double* onLower = force.data() + kNodeSize * static_cast<std::size_t>(tangent.lower);
    addSums(f, tangent.lowerWeight, -1.0, onLower);
    for (std::size_t a = 0; a < 3; ++a) {
      const Lanes moved = g[0] * tangent.dual[a][0] + g[1] * tangent.dual[a][1] + g[2] * tangent.dual[a][2];
      for (std::size_t k = 0; k < 3; ++k) onLower[3 + 3 * a + k] -= sum(moved * tangent.push[k]);
    }
  }
}

}  // namespace springtower
