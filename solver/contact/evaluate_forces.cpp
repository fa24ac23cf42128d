#include "solver/contact/evaluate_forces.h"

#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/block/springs.h"
#include "solver/contact/pushes.h"
#include "solver/law/user_force.h"
#include "solver/world/over_island.h"
#include "solver/world/stage_clock.h"

#include <algorithm>
#include <functional>

namespace springtower {

namespace {

ContactSide sideOf(const Engine& engine, std::int32_t block, bool sameMotion) {
  if (block < 0) return {};
  const auto b = static_cast<std::size_t>(block);
  const AffineField* motion = &engine.memo.motion[b];
  return {&engine.memo.frames[b], motion, sameMotion ? motion : &engine.memo.carriedMotion[b]};
}

struct Evaluation {
  ContactStep contactStep;
  bool sameMotion;
  PointUpdate update;
};

SPRINGTOWER_INLINE void evaluatePair(IslandStep& step, const Evaluation& evaluation, const ContactPool::Editable& contact,
                                     PairForce& force) {
  const ContactView& manifold = contact.view;
  const PointRows* keep = nullptr;
  if (evaluation.update == PointUpdate::store) keep = &contact.points;
  if (evaluation.update == PointUpdate::trial) keep = &contact.trial;
  const ContactSide upper = sideOf(step.engine, manifold.upper, evaluation.sameMotion);
  const ContactSide lower = sideOf(step.engine, manifold.lower, evaluation.sameMotion);
  manifoldForces(manifold, upper, lower, step.law, evaluation.contactStep, reducedMass(step.simulation.model, manifold), keep,
                 force);
}

// Returns the number of points evaluated.
std::uint64_t contactsInOrder(IslandStep& step, const Evaluation& evaluation) {
  Engine& engine = step.engine;
  const std::vector<std::uint8_t>& asleep = step.simulation.asleep;
  for (const std::int32_t block : step.blocks) engine.scratch.contactForce[static_cast<std::size_t>(block)] = AffineField{};
  std::uint64_t points = 0;
  for (const std::int32_t pair : step.activePairs) {
    const auto at = static_cast<std::size_t>(pair);
    if (!engine.pairs.touches(at)) continue;
    const ContactPool::Editable contact = engine.contacts.edit(engine.pairs.contact[at], engine.pairs[at]);
    const ContactView& manifold = contact.view;
    PairForce force;
    evaluatePair(step, evaluation, contact, force);
    points += static_cast<std::uint64_t>(manifold.count);
    const auto upper = static_cast<std::size_t>(manifold.upper);
    if (asleep[upper] == 0) addForce(force.upper, engine.scratch.contactForce[upper]);
    if (manifold.lower < 0) continue;
    const auto lower = static_cast<std::size_t>(manifold.lower);
    if (asleep[lower] == 0) addForce(force.lower, engine.scratch.contactForce[lower]);
  }
  return points;
}

// The same sums in the same order: first all pairs, then each block sums its own.
std::uint64_t contactsInParallel(IslandStep& step, const Evaluation& evaluation) {
  Engine& engine = step.engine;
  forRanges(step.activePairs.size(), tuning::kPairGrain, true, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto at = static_cast<std::size_t>(step.activePairs[i]);
      if (!engine.pairs.touches(at)) continue;
      const std::int32_t contact = engine.pairs.contact[at];
      evaluatePair(step, evaluation, engine.contacts.edit(contact, engine.pairs[at]), engine.contacts.pairForce(contact));
    }
  });
  forRanges(step.blocks.size(), tuning::kBlockGrain, true, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const std::int32_t block = step.blocks[i];
      const auto b = static_cast<std::size_t>(block);
      AffineField sum{};
      for (std::int32_t k = engine.memo.blockPairStart[b]; k < engine.memo.blockPairStart[b + 1]; ++k) {
        const auto at = static_cast<std::size_t>(engine.memo.blockPairs[static_cast<std::size_t>(k)]);
        if (!engine.pairs.touches(at)) continue;
        const PairForce& force = engine.contacts.pairForce(engine.pairs.contact[at]);
        const bool isUpper = shapeOf(engine, at).upper == block;
        addForce(isUpper ? force.upper : force.lower, sum);
      }
      engine.scratch.contactForce[b] = sum;
    }
  });
  const auto pointsIn = [&](std::size_t first, std::size_t last) {
    std::uint64_t points = 0;
    for (std::size_t i = first; i < last; ++i) {
      const auto at = static_cast<std::size_t>(step.activePairs[i]);
      if (engine.pairs.touches(at)) points += static_cast<std::uint64_t>(engine.contacts.shape(engine.pairs.contact[at]).count);
    }
    return points;
  };
  return mergeRanges(step.activePairs.size(), tuning::kPairGrain, true, std::uint64_t{0}, pointsIn, std::plus<>());
}

// BDF2 gives in a step a third of the mean acceleration of the step before and two thirds of what acts now. So that it gives the
// impulse of the user forces exactly, half of their change since the step before acts beside them.
void addUserForces(IslandStep& step, const MotionState& state) {
  const bool carriesOn = step.pushedBefore_s > 0.0;
  const auto add = [&](double factor) {
    return [&step, &state, factor](const UserForce& user, const Load& mean) {
      addUserForce(step.simulation.model, state.position, user, {factor * mean.force, factor * mean.torque},
                   step.engine.memo.force);
    };
  };
  forEachPush(step, step.pushedFrom_s, step.pushedUntil_s, add(carriesOn ? 1.5 : 1.0));
  if (carriesOn) forEachPush(step, step.pushedFrom_s - step.pushedBefore_s, step.pushedFrom_s, add(-0.5));
}

void addTether(IslandStep& step, const MotionState& state, double time_s) {
  if (!holdsTether(step)) return;
  const Tether& tether = step.simulation.tether;
  std::array<Vec3, kCorners> corner;
  step.engine.memo.tetherForce = tetherForces(tether, step.simulation.model, state, time_s, corner);
  for (std::size_t c = 0; c < kCorners; ++c) step.engine.memo.force.add(index(tether.block), c, corner[c]);
}

// `carried`: null where engine.memo.carriedMotion is filled already.
void evaluate(IslandStep& step, const MotionState& state, const ParticleArray* carried, double advance_s, PointUpdate update) {
  StageClock clock(step.times);
  Engine& engine = step.engine;
  const bool sameMotion = carried == &state.velocity;
  const double kick_s = sameMotion && update == PointUpdate::store ? step.kick_s : 0.0;
  const Evaluation evaluation{
      {advance_s, step.maxStiffening, update == PointUpdate::trial, step.sticks, kick_s, step.smoothing_j}, sameMotion, update};
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    const auto blocks = step.blocks.subspan(first, last - first);
    computeFrames(state.position, blocks, engine.memo.frames);
    computeMotions(state.velocity, blocks, engine.memo.motion);
    if (!sameMotion && carried != nullptr) computeMotions(*carried, blocks, engine.memo.carriedMotion);
  });
  step.counters.contactEvaluations += isWide(step) ? contactsInParallel(step, evaluation) : contactsInOrder(step, evaluation);
  clock.lap(Stage::contacts);
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    springForces(step.simulation.model, state, step.blocks.subspan(first, last - first), engine.scratch.contactForce,
                 engine.memo.force);
  });
  if (!step.unforced) addUserForces(step, state);
  // Implicit steps evaluate forces at their end.
  addTether(step, state, step.time_s + (update == PointUpdate::trial ? advance_s : 0.0));
  clock.lap(Stage::springs);
  step.counters.springEvaluations += kSprings * step.blocks.size();
}

}  // namespace

void evaluateForces(IslandStep& step, const MotionState& state, const ParticleArray& carried, double advance_s,
                    PointUpdate update) {
  evaluate(step, state, &carried, advance_s, update);
}

void evaluateTrialForces(IslandStep& step) {
  evaluate(step, step.simulation.state, nullptr, step.drift_s, PointUpdate::trial);
}

bool isPushed(const IslandStep& step) {
  const std::vector<std::int32_t>& islandOf = step.engine.memo.islands.islandOf;
  const double end_s = step.simulation.time_s + step.simulation.scene.settings.frame_s;
  return std::any_of(step.simulation.scene.forces.begin(), step.simulation.scene.forces.end(), [&](const UserForce& user) {
    return user.actsWithin(step.simulation.time_s, end_s) &&
           islandOf[static_cast<std::size_t>(user.block)] == islandOf[static_cast<std::size_t>(step.blocks.front())];
  });
}

bool holdsTether(const IslandStep& step) {
  const BlockId held = step.simulation.tether.block;
  if (held == kFloor || step.unforced) return false;
  const std::vector<std::int32_t>& islandOf = step.engine.memo.islands.islandOf;
  return islandOf[index(held)] >= 0 && islandOf[index(held)] == islandOf[static_cast<std::size_t>(step.blocks.front())];
}

bool isWorkedOn(const IslandStep& step) {
  return holdsTether(step) || isPushed(step) || !step.driven.empty();
}

void accelerate(const IslandStep& step, std::size_t block, double (&acceleration)[3][kCorners]) {
  const InverseMass inverse = inverseMass(step.simulation.scene.settings.inertia);
  const double own = inverse.own / step.simulation.model.mass[block];
  const double shared = inverse.shared / step.simulation.model.mass[block];
  for (std::size_t a = 0; a < 3; ++a) {
    const double* f = step.engine.memo.force.values(a, block);
    const double sum = ((f[0] + f[1]) + (f[2] + f[3])) + ((f[4] + f[5]) + (f[6] + f[7]));
    const double uniform = step.gravity[static_cast<Eigen::Index>(a)] - shared * sum;
    for (std::size_t c = 0; c < kCorners; ++c) acceleration[a][c] = own * f[c] + uniform;
  }
}

}  // namespace springtower
