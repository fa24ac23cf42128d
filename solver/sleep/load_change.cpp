#include "solver/sleep/load_change.h"

#include "core/tuning.h"
#include "solver/contact/query.h"
#include "solver/sleep/support_check.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

double weightOf(const Simulation& simulation, std::int32_t block) {
  return simulation.model.mass[static_cast<std::size_t>(block)] * simulation.scene.gravity.magnitude;
}

// Wrench on block a of a pair at present.
ContactWrench pushOnA(const Simulation& simulation, std::size_t at) {
  const ContactView contact = contactOf(*simulation.engine, at);
  ContactWrench push = contactWrenchOnUpper(simulation, contact);
  if (contact.upper == simulation.engine->pairs.key[at].a) return push;
  return {-push.force, -push.torque, -push.direction};
}

// Adds the load change from one awake neighbour to that of a sleeping block.
void addChange(Simulation& simulation, std::size_t at, std::int32_t sleeper) {
  Engine& engine = *simulation.engine;
  const SleepLoad before = sleepLoadOf(engine, at);
  LoadChange& change = engine.scratch.loadChange[static_cast<std::size_t>(sleeper)];
  const double sign = sleeper == engine.pairs.key[at].a ? 1.0 : -1.0;
  const ContactWrench now = pushOnA(simulation, at);
  const Vec3 difference = sign * (now.force - before.force);
  const double least = tuning::kMinLoadChange * weightOf(simulation, sleeper);
  const bool pushed = before.force.norm() > least;
  const bool pushes = now.force.norm() > least;
  change.begunOrLost = change.begunOrLost || pushed != pushes;
  change.force += difference;
  change.torque += sign * (now.torque - before.torque) -
                   centre(simulation.state.position, static_cast<std::size_t>(sleeper)).cross(difference);
  change.shear += sign * (now.force - now.direction.dot(now.force) * now.direction);
  change.side += sign * now.direction;
}

// Sums the contact loads that blocks with a changed load had when they fell asleep, and the friction that can hold them.
void findLoads(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  for (const std::int32_t block : engine.scratch.pushed) {
    LoadChange& change = engine.scratch.loadChange[static_cast<std::size_t>(block)];
    change.load_n = 0.5 * weightOf(simulation, block);
    if (!change.side.isZero(0.0)) change.side.normalize();
    engine.scratch.joined[static_cast<std::size_t>(block)] = 1;
  }
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    const BlockPair& pair = engine.pairs.key[at];
    const Vec3 restForce = sleepLoadOf(engine, at).force;
    const auto add = [&](std::int32_t block, std::int32_t partner, const Vec3& force) {
      if (block < 0 || engine.scratch.joined[static_cast<std::size_t>(block)] == 0) return;
      LoadChange& change = engine.scratch.loadChange[static_cast<std::size_t>(block)];
      change.load_n += 0.5 * force.norm();
      if (sleeps(simulation, partner)) change.hold_n += simulation.friction.of(pair.a, pair.b).staticFriction * force.norm();
    };
    add(pair.a, pair.b, restForce);
    add(pair.b, pair.a, -restForce);
  }
}

// Whether a sleeping block can support the change of its load without moving.
bool isWithinLimits(const Simulation& simulation, std::int32_t block) {
  const auto b = static_cast<std::size_t>(block);
  const LoadChange& change = simulation.engine->scratch.loadChange[b];
  if (change.begunOrLost) return false;
  if (change.force.norm() <= tuning::kMinLoadChange * weightOf(simulation, block)) return true;
  const double longest = simulation.model.dimensions[b].maxCoeff();
  const double middle = simulation.model.dimensions[b].sum() - longest - simulation.model.dimensions[b].minCoeff();
  const Vec3 across = change.force - change.side.dot(change.force) * change.side;
  const double twist = std::abs(change.side.dot(change.torque));
  const Vec3 tilting = change.torque - change.side.dot(change.torque) * change.side;
  if (std::abs(change.side.dot(change.force)) > tuning::kMaxNormalLoadChange * change.load_n) return false;
  if (tilting.norm() > tuning::kMaxNormalLoadChange * change.load_n * middle) return false;
  const double shear = change.shear.norm() + 4.0 * twist / longest;
  return across.norm() <= tuning::kMinLoadChange * weightOf(simulation, block) ||
         shear <= tuning::kMaxFrictionUse * change.hold_n;
}

}  // namespace

void recordSleepLoads(Simulation& simulation, std::span<const std::uint8_t> staysAwake) {
  Engine& engine = *simulation.engine;
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    const BlockPair& pair = engine.pairs.key[at];
    const auto falls = [&](std::int32_t block) {
      return !sleeps(simulation, block) && staysAwake[static_cast<std::size_t>(block)] == 0;
    };
    if (!falls(pair.a) && !falls(pair.b)) continue;
    const ContactWrench now = pushOnA(simulation, at);
    const SleepLoad before = sleepLoadOf(engine, at);
    const std::int32_t sleeper = isSleeper(simulation, pair.a) ? pair.a : (isSleeper(simulation, pair.b) ? pair.b : -1);
    if (sleeper >= 0) {
      const auto s = static_cast<std::size_t>(sleeper);
      const double most = tuning::kSleepImbalance * weightOf(simulation, sleeper);
      const Vec3 force = now.force - before.force;
      const Vec3 torque = now.torque - before.torque - centre(simulation.state.position, s).cross(force);
      if (force.norm() <= most && torque.norm() <= most * simulation.model.dimensions[s].minCoeff()) continue;
      engine.scratch.toWake.push_back({sleeper, WakeReason::unbalanced});
    }
    if (engine.pairs.contact[at] < 0) continue;
    // Without negative zeros, which only a row that is there would keep.
    engine.contacts.setSleepLoad(engine.pairs.contact[at], {now.force + Vec3::Zero(), now.torque + Vec3::Zero()});
  }
}

bool findWakeCandidates(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  engine.scratch.toWake.clear();
  engine.scratch.pushed.clear();
  engine.scratch.loadChange.resize(simulation.asleep.size());
  engine.scratch.joined.assign(simulation.asleep.size(), 0);
  bool changed = false;
  bool failed = false;
  for (const std::int32_t position : engine.memo.islandPairs) {
    const auto at = static_cast<std::size_t>(position);
    const BlockPair& pair = engine.pairs.key[at];
    if (isFixed(simulation, pair.a) || isFixed(simulation, pair.b) || sleeps(simulation, pair.a) == sleeps(simulation, pair.b))
      continue;
    const std::int32_t sleeper = sleeps(simulation, pair.a) ? pair.a : pair.b;
    LoadChange& change = engine.scratch.loadChange[static_cast<std::size_t>(sleeper)];
    if (engine.scratch.joined[static_cast<std::size_t>(sleeper)] == 0) {
      engine.scratch.joined[static_cast<std::size_t>(sleeper)] = 1;
      engine.scratch.pushed.push_back(sleeper);
      change = {};
    }
    addChange(simulation, at, sleeper);
    const double least = tuning::kMinLoadChange * weightOf(simulation, sleeper);
    changed = changed || change.begunOrLost || change.force.norm() > least ||
              change.torque.norm() > least * simulation.model.dimensions[static_cast<std::size_t>(sleeper)].minCoeff();
  }
  if (changed) {
    findLoads(simulation);
    for (const std::int32_t block : engine.scratch.pushed) {
      if (!isWithinLimits(simulation, block)) engine.scratch.toWake.push_back({block, WakeReason::loadChange});
    }
    if (simulation.scene.settings.sleep == Sleep::on) failed = findFailedSupports(simulation);
  }
  // A pair that the sweep has dropped has no contact force any more.
  for (const std::int32_t block : engine.scratch.lostNeighbours)
    engine.scratch.toWake.push_back({block, WakeReason::lostNeighbour});
  return failed;
}

}  // namespace springtower
