#include "solver/frame/island_modes.h"

#include "core/tuning.h"
#include "solver/contact/approach.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/query.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/implicit/step_count.h"
#include "solver/rigid/run.h"
#include "solver/world/checkpoint.h"
#include "solver/world/over_island.h"
#include "solver/world/scales.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

Vec3 centreVelocity(const IslandStep& step, std::int32_t block) {
  return centre(step.simulation.state.velocity, static_cast<std::size_t>(block));
}

double massOf(const IslandStep& step, std::int32_t block) {
  return step.simulation.model.mass[static_cast<std::size_t>(block)];
}

// Speed in m/s of one in sqrt(g h).
double speedOf(const IslandStep& step, double speed) {
  return speed * step.simulation.lengths.blockHeight_m / step.simulation.lengths.fallTime_s;
}

// Whether the root mean square speed, weighted by mass, is above this one.
bool isFasterThan(const IslandStep& step, double least_m_s) {
  double mass_kg = 0.0;
  double twiceKinetic_j = 0.0;
  for (const std::int32_t block : step.blocks) {
    mass_kg += massOf(step, block);
    twiceKinetic_j += massOf(step, block) * centreVelocity(step, block).squaredNorm();
  }
  return twiceKinetic_j > mass_kg * least_m_s * least_m_s;
}

bool isLeftAlone(const IslandStep& step) {
  return !holdsTether(step) && !isPushed(step);
}

// Whether blocks that have more than half of the mass move faster than this against a velocity, m/s. What a hand holds does not
// count: it moves as fast as the hand does.
bool mostIsFasterThan(const IslandStep& step, double least_m_s, const Vec3& against) {
  const std::int32_t held = holdsTether(step) ? static_cast<std::int32_t>(index(step.simulation.tether.block)) : -1;
  double mass_kg = 0.0;
  double fast_kg = 0.0;
  for (const std::int32_t block : step.blocks) {
    if (block == held) continue;
    mass_kg += massOf(step, block);
    if ((centreVelocity(step, block) - against).squaredNorm() > least_m_s * least_m_s) fast_kg += massOf(step, block);
  }
  return 2.0 * fast_kg > mass_kg;
}

Vec3 meanVelocity(const IslandStep& step) {
  double mass_kg = 0.0;
  Vec3 momentum = Vec3::Zero();
  for (const std::int32_t block : step.blocks) {
    mass_kg += massOf(step, block);
    momentum += massOf(step, block) * centreVelocity(step, block);
  }
  return momentum / mass_kg;
}

// Whether it lies on something that is no part of it.
bool isSupported(const IslandStep& step) {
  return anyPair(step, [&](std::size_t at) {
    const BlockPair& key = step.engine.pairs.key[at];
    return step.engine.pairs.touches(at) && (key.b < 0 || sleeps(step.simulation, key.a) || sleeps(step.simulation, key.b));
  });
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
    row.impulse.normalForce[lane] = row.impulse.lasting[lane] = points.normal[i];
    for (std::size_t k = 0; k < 3; ++k) row.impulse.friction[k][lane] = points.friction[i][k];
    // As deep as it is, whatever the force is now: to push it out because that has become less would be energy out of nothing.
    row.impulse.restDepth[lane] = std::max(restDepth, depth - springDepthOfForce(step.simulation, manifold, i));
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
    const double elastic = touches ? springStrain(step.simulation, manifold, i, points.depth[i]) : 0.0;
    const double force = row.impulse.normalForce[lane];
    const double share = force > 0.0 ? -elastic * stiffness / (force * tangential) : 0.0;
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

void noteFallen(const IslandStep& step) {
  const double least = speedOf(step, tuning::kRigidEntrySpeed);
  const std::int32_t held = holdsTether(step) ? static_cast<std::int32_t>(index(step.simulation.tether.block)) : -1;
  for (const std::int32_t block : step.blocks) {
    if (block != held && centreVelocity(step, block).squaredNorm() > least * least)
      step.engine.memo.blockHistory[static_cast<std::size_t>(block)].hasFallen = true;
  }
}

IslandFacts islandFacts(const IslandStep& step) {
  IslandFacts facts;
  facts.leftAlone = isLeftAlone(step);
  const IslandHistory before = mergedHistory(step.engine.memo.islandHistory, step.blocks);
  facts.rigidBefore = before.rigid;
  std::size_t pinned = 0;
  for (const std::int32_t block : step.blocks)
    pinned += step.engine.memo.islandHistory[static_cast<std::size_t>(block)].rigidFrames > 0 ? 1U : 0U;
  facts.staysRigid = 2 * pinned > step.blocks.size();
  facts.mostlyFallen = isMostlyFallen(step);
  if (facts.leftAlone && facts.staysRigid) return facts;
  facts.moves = isFasterThan(step, quiescentSpeed(step.simulation));
  const double entry = speedOf(step, tuning::kRigidEntrySpeed);
  facts.fast = mostIsFasterThan(step, entry, Vec3::Zero()) &&
               (!isSupported(step) || mostIsFasterThan(step, 0.5 * entry, meanVelocity(step)));
  // What a hand carries moves with it.
  if (facts.fast && holdsTether(step))
    facts.fast =
        mostIsFasterThan(step, 0.5 * entry, centreVelocity(step, static_cast<std::int32_t>(index(step.simulation.tether.block))));
  return facts;
}

bool stands(const IslandStep& step, bool mostlyFallen) {
  const std::size_t count = step.blocks.size();
  if (mostlyFallen || count >= tuning::kParallelBlocks) return false;
  return isSupported(step) && !isAboutToRebound(step);
}

IslandMode nextMode(ModeChange when, const IslandFacts& facts) {
  bool rigid = false;
  switch (when) {
    case ModeChange::frameBegins:
      rigid = facts.fast || (facts.leftAlone && facts.staysRigid);
      break;
    case ModeChange::frameContinues:
      rigid = facts.rigidBefore;
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
      step.modeChanged = true;
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
  forEachContact(PointKind::penalty, penaltyToImpulse);
}

IslandOutcome runRigidMode(IslandStep& step, double begin_s, bool stands) {
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
  const bool moving = isFasterThan(step, speedOf(step, tuning::kRigidExitSpeed)) && outcome.rebounds;
  const bool forced = isWorkedOn(step);
  const std::int32_t least = moving ? framesOf(simulation, tuning::kRigidRestTime) : 0;
  for (const std::int32_t block : step.blocks) {
    BlockHistory& history = step.engine.memo.blockHistory[static_cast<std::size_t>(block)];
    history.lastExplicitStep_s = 0.0;
    history.lastImplicitStep_s = 0.0;
    history.explicitLast = true;
    IslandHistory& island = step.engine.memo.islandHistory[static_cast<std::size_t>(block)];
    island.implicitSteps = std::min(island.implicitSteps, tuning::kMaxFrequencySteps);  // those after a kick are done with
    island.forced = forced;
    if (step.part.begin_s == 0.0) island.rigidFrames = std::max(0, island.rigidFrames - 1);
    island.rigidFrames = stands ? 0 : std::max(history.hasFallen ? least : 0, island.rigidFrames);
  }
  step.engine.memo.newtonSystems.of(step.blocks.front()).forcesKnown = false;
  return outcome;
}

}  // namespace springtower
