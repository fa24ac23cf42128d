#include "solver/frame/island_modes.h"

#include "core/tuning.h"
#include "solver/contact/approach.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/query.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/implicit/bdf2.h"
#include "solver/rigid/run.h"
#include "solver/world/checkpoint.h"
#include "solver/world/over_island.h"
#include "solver/world/scales.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// Motion of an island.
struct Motion {
  double mass_kg = 0.0;
  double twiceKinetic_j = 0.0;  // of the blocks' centres
  Vec3 momentum = Vec3::Zero();
  double height_m = 0.0;
  double fallTime_s = 0.0;  // sqrt(h / g)

  // Whether the root mean square speed, weighted by mass, is above this one, in sqrt(g h).
  [[nodiscard]] bool isFasterThan(double speed) const {
    const double least = speed * height_m / fallTime_s;
    return twiceKinetic_j > mass_kg * least * least;
  }

  // The same with speeds against that of the centre of mass. A column that topples has half of its speed that way.
  [[nodiscard]] bool topplesFasterThan(double speed) const {
    const double least = 0.5 * speed * height_m / fallTime_s;
    return twiceKinetic_j - momentum.squaredNorm() / mass_kg > mass_kg * least * least;
  }
};

Motion motionOf(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  Motion motion;
  motion.height_m = simulation.lengths.blockHeight_m;
  motion.fallTime_s = simulation.lengths.fallTime_s;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    const Vec3 velocity = centre(simulation.state.velocity, b);
    motion.mass_kg += simulation.model.mass[b];
    motion.twiceKinetic_j += simulation.model.mass[b] * velocity.squaredNorm();
    motion.momentum += simulation.model.mass[b] * velocity;
  }
  return motion;
}

// Whether it lies on something that is no part of it.
bool isSupported(const IslandStep& step) {
  return anyPair(step, [&](std::size_t at) {
    const BlockPair& key = step.engine.pairs.key[at];
    return step.engine.pairs.touches(at) && (key.b < 0 || sleeps(step.simulation, key.a) || sleeps(step.simulation, key.b));
  });
}

bool isLeftAlone(const IslandStep& step) {
  return !holdsTether(step) && !isPushed(step);
}

// Converts the spring forces of a manifold's points to initial impulses.
void penaltyToImpulse(const IslandStep& step, std::int32_t contact, const ContactView& manifold) {
  const PointForces points = forcesNow(step.simulation, manifold);
  const PointRows rows = step.engine.contacts.points(contact);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    const std::size_t lane = laneOf(i);
    PointRow& row = *rows[rowOf(i)];
    const double depth = std::max(0.0, points.depth[i]);
    const double restDepth = row.penalty.touching[lane] != 0.0 ? std::max(0.0, row.penalty.restDepth[lane]) : depth;
    row.impulse.normalForce[lane] = points.normal[i];
    for (std::size_t k = 0; k < 3; ++k) row.impulse.friction[k][lane] = points.friction[i][k];
    row.impulse.restDepth[lane] = restDepth;
    row.impulse.heldDepth[lane] = depth;
    row.impulse.untouched[lane] = 0.0;
  }
  step.engine.contacts.shape(contact).kind = PointKind::impulse;
}

// The inverse: springs with the forces of the last impulses.
void impulseToPenalty(const IslandStep& step, std::int32_t contact, const ContactView& manifold) {
  const PointForces points = forcesNow(step.simulation, manifold);
  const double stiffness = step.law.stiffnessOf(manifold.upper, manifold.lower);
  const double tangential = step.law.tangentialRatio * stiffness;
  const PointRows rows = step.engine.contacts.points(contact);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    const std::size_t lane = laneOf(i);
    PointRow& row = *rows[rowOf(i)];
    const bool touches = points.depth[i] > 0.0;
    const double pressed = springDepthOfForce(step.simulation, manifold, i);
    const double elastic = touches ? std::min(pressed, heldStrain(manifold, i, points.depth[i])) : 0.0;
    const double share = elastic > 0.0 ? -elastic * stiffness / (row.impulse.normalForce[lane] * tangential) : 0.0;
    const Vec3 friction = vectorAt(row.impulse.friction, i);
    row.penalty.touching[lane] = elastic > 0.0 ? 1.0 : (touches ? kTouchingWithoutForce : 0.0);
    row.penalty.stiffening[lane] = 1.0;
    row.penalty.restDepth[lane] = touches ? points.depth[i] - elastic : 0.0;
    row.penalty.maxwellDepth[lane] = elastic;
    setVectorAt(row.penalty.displacement, i, share * friction);
  }
  step.engine.contacts.shape(contact).kind = PointKind::penalty;
}

}  // namespace

IslandFacts islandFacts(const IslandStep& step) {
  IslandFacts facts;
  facts.leftAlone = isLeftAlone(step);
  const IslandHistory before = mergedHistory(step.engine.memo.islandHistory, step.blocks);
  facts.rigidBefore = before.rigid;
  std::size_t pinned = 0;
  for (const std::int32_t block : step.blocks)
    pinned += step.engine.memo.islandHistory[static_cast<std::size_t>(block)].explicitFrames > 0 ? 1U : 0U;
  facts.rigidPinned = 2 * pinned > step.blocks.size();
  facts.mostlyFallen = isMostlyFallen(step);
  if (!facts.leftAlone || facts.rigidPinned) return facts;
  const Motion motion = motionOf(step);
  facts.fast =
      motion.isFasterThan(tuning::kRigidEntrySpeed) && (!isSupported(step) || motion.topplesFasterThan(tuning::kRigidEntrySpeed));
  return facts;
}

bool stands(const IslandStep& step, const IslandFacts& facts) {
  const std::size_t count = step.blocks.size();
  if (facts.mostlyFallen || count < tuning::kMinRigidModeBlocks || count >= tuning::kParallelBlocks) return false;
  return isSupported(step) && !isAboutToRebound(step);
}

IslandMode nextMode(ModeChange when, const IslandFacts& facts) {
  bool rigid = false;
  switch (when) {
    case ModeChange::frameBegins:
      rigid = facts.leftAlone && (facts.rigidPinned || facts.fast);
      break;
    case ModeChange::frameContinues:
      rigid = facts.rigidBefore;
      break;
    case ModeChange::implicitFailed:
      if (facts.stands) return IslandMode::explicitFallback;
      rigid = true;
      break;
  }
  return rigid ? IslandMode::rigid : IslandMode::implicit;
}

void setMode(IslandStep& step, IslandMode mode) {
  const bool falling = mode == IslandMode::rigid;
  std::vector<IslandHistory>& history = step.engine.memo.islandHistory;
  const auto forEachContact = [&](PointKind kind, const auto& change) {
    for (const std::int32_t pair : step.pairs) {
      const auto at = static_cast<std::size_t>(pair);
      const std::int32_t contact = step.engine.pairs.contact[at];
      if (!step.engine.pairs.touches(at) || step.engine.contacts.shape(contact).kind != kind) continue;
      savePair(step.engine, at);
      change(step, contact, contactOf(step.engine, at));
    }
  };
  const bool all = std::all_of(step.blocks.begin(), step.blocks.end(),
                               [&](std::int32_t block) { return history[static_cast<std::size_t>(block)].rigid; });
  if (falling && all) {
    forEachContact(PointKind::penalty, penaltyToImpulse);  // of blocks that slept while a neighbour returned to springs
    return;
  }
  forEachContact(PointKind::impulse, impulseToPenalty);
  for (const std::int32_t block : step.blocks) history[static_cast<std::size_t>(block)].rigid = falling;
  if (!falling) return;
  step.time_s = step.simulation.time_s;
  step.gravity = step.simulation.scene.gravity.at(step.time_s);
  synchronise(step);
  forEachContact(PointKind::penalty, penaltyToImpulse);
}

IslandOutcome runRigidMode(IslandStep& step, double begin_s) {
  const Simulation& simulation = step.simulation;
  double fastest = 0.0;
  for (const std::int32_t block : step.blocks)
    fastest = std::max(fastest, fastestCorner(simulation.state.velocity, static_cast<std::size_t>(block), Vec3::Zero()));
  const double steps =
      fastest * simulation.scene.settings.frame_s / (tuning::kMaxRigidModeDisplacement * simulation.lengths.blockHeight_m);
  const double share = (step.part.end_s - begin_s) / simulation.scene.settings.frame_s;
  const double most =
      std::clamp(steps, static_cast<double>(tuning::kMinRigidModeSteps), static_cast<double>(tuning::kMaxRigidModeSteps));
  const int groups = static_cast<int>(std::ceil(most * share / tuning::kSubstepsPerStep));
  const IslandOutcome outcome = runRigidSteps(step, groups * tuning::kSubstepsPerStep, begin_s);
  // A block that rocks is slow for a moment at each turn.
  const bool moving =
      motionOf(step).isFasterThan(tuning::kRigidExitSpeed) && step.engine.scratch.rigidIslands.of(step.blocks.front()).rebounds;
  const std::int32_t least = moving ? framesOf(simulation, tuning::kRigidRestTime) : 0;
  for (const std::int32_t block : step.blocks) {
    BlockHistory& history = step.engine.memo.blockHistory[static_cast<std::size_t>(block)];
    history.lastExplicitStep_s = 0.0;
    history.lastImplicitStep_s = 0.0;
    history.explicitLast = true;
    IslandHistory& island = step.engine.memo.islandHistory[static_cast<std::size_t>(block)];
    if (step.part.begin_s == 0.0) island.explicitFrames = std::max(0, island.explicitFrames - 1);
    island.explicitFrames = std::max(least, island.explicitFrames);
  }
  step.engine.memo.newtonSystems.of(step.blocks.front()).forcesKnown = false;
  return outcome;
}

}  // namespace springtower
