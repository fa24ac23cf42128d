#include "solver/frame/island_modes.h"

#include "core/tuning.h"
#include "solver/contact/approach.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/query.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/implicit/bdf2.h"
#include "solver/rigid/run.h"
#include "solver/world/checkpoint.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// Motion of an island as a whole.
struct Motion {
  double mass_kg = 0.0;
  double twiceKinetic_j = 0.0;  // of the blocks' centres
  double height_m = 0.0;
  double fallTime_s = 0.0;  // sqrt(h / g)

  // Whether the root mean square speed, weighted by mass, is above this one, in sqrt(g h).
  [[nodiscard]] bool isFasterThan(double speed) const {
    const double least = speed * height_m / fallTime_s;
    return twiceKinetic_j > mass_kg * least * least;
  }
};

Motion motionOf(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  Motion motion;
  motion.height_m = simulation.lengths.blockHeight_m;
  motion.fallTime_s = simulation.lengths.fallTime_s;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    motion.mass_kg += simulation.model.mass[b];
    motion.twiceKinetic_j += simulation.model.mass[b] * centre(simulation.state.velocity, b).squaredNorm();
  }
  return motion;
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
    const double restDepth = row.penalty.touching[lane] != 0.0 ? std::max(0.0, row.penalty.restDepth[lane]) : 0.0;
    row.impulse.normalForce[lane] = points.normal[i];
    for (std::size_t k = 0; k < 3; ++k) row.impulse.friction[k][lane] = points.friction[i][k];
    row.impulse.restDepth[lane] = restDepth;
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
    const double elastic = touches ? std::min(pressed, points.depth[i]) : 0.0;
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

bool mayEnterRigidMode(std::size_t blocks) {
  return blocks >= tuning::kMinRigidModeBlocks;
}

IslandFacts islandFacts(const IslandStep& step) {
  IslandFacts facts;
  facts.blocks = step.blocks.size();
  facts.leftAlone = isLeftAlone(step);
  if (!facts.leftAlone) return facts;  // the other facts are not needed then
  const IslandHistory before = mergedHistory(step.engine.memo.islandHistory, step.blocks);
  facts.rigidBefore = before.rigid;
  facts.rigidPinned = before.explicitFrames > 0;
  std::size_t fallen = 0;
  for (const std::int32_t block : step.blocks) {
    const BlockHistory& history = step.engine.memo.blockHistory[static_cast<std::size_t>(block)];
    fallen += history.hasFallen ? 1U : 0U;
  }
  facts.mostlyFallen = 2 * fallen > facts.blocks;
  if (!facts.rigidBefore && !mayEnterRigidMode(facts.blocks)) return facts;
  const Motion motion = motionOf(step);
  facts.fast = motion.isFasterThan(tuning::kRigidEntrySpeed);
  facts.moving = motion.isFasterThan(tuning::kRigidExitSpeed);
  return facts;
}

IslandMode nextMode(ModeChange when, const IslandFacts& facts) {
  if (when == ModeChange::implicitFailed)
    return facts.leftAlone && (facts.mostlyFallen || facts.blocks >= tuning::kParallelBlocks) ? IslandMode::rigid
                                                                                              : IslandMode::explicitFallback;
  if (!facts.leftAlone) return IslandMode::implicit;
  if (when == ModeChange::frameContinues) return facts.rigidBefore ? IslandMode::rigid : IslandMode::implicit;
  const bool rigid = facts.rigidBefore ? facts.rigidPinned || facts.moving : mayEnterRigidMode(facts.blocks) && facts.fast;
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
  for (const std::int32_t block : step.blocks) step.engine.memo.blockHistory[static_cast<std::size_t>(block)].hasFallen = true;
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
  for (const std::int32_t block : step.blocks) {
    BlockHistory& history = step.engine.memo.blockHistory[static_cast<std::size_t>(block)];
    history.lastExplicitStep_s = 0.0;
    history.lastImplicitStep_s = 0.0;
    history.explicitLast = true;
    IslandHistory& island = step.engine.memo.islandHistory[static_cast<std::size_t>(block)];
    if (step.part.begin_s == 0.0) island.explicitFrames = std::max(0, island.explicitFrames - 1);
  }
  step.engine.memo.newtonSystems.of(step.blocks.front()).forcesKnown = false;
  return outcome;
}

}  // namespace springtower
