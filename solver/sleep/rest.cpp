#include "solver/sleep/rest.h"

#include "core/parallel.h"
#include "core/tuning.h"
#include "narrowphase/separation.h"
#include "solver/block/inertia.h"
#include "solver/contact/approach.h"
#include "solver/sleep/load_change.h"
#include "solver/world/checkpoint.h"
#include "solver/world/scales.h"
#include "solver/world/stage_clock.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace springtower {

namespace {

// An upper bound of the speed of a block's fastest corner in its rigid motion, m/s: that motion has at most the kinetic energy of
// the corners, and the least moment of inertia is that about the longest axis.
double fastestRigidCorner(const Simulation& simulation, std::size_t b) {
  double squared = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double* v = simulation.state.velocity.values(a, b);
    for (std::size_t c = 0; c < kCorners; ++c) squared += v[c] * v[c];
  }
  const Vec3& size = simulation.model.dimensions[b];
  const double diagonal = size.squaredNorm();
  const double inertia = (diagonal - size.maxCoeff() * size.maxCoeff()) / 12.0;
  return std::sqrt(squared / static_cast<double>(kCorners)) * (1.0 + std::sqrt(0.25 * diagonal / inertia));
}

// Updates the sleep timer. A block is at rest while its rigid motion is slow; compression and vibration do not keep it awake. It
// also has to be in balance: over each window the mean force and torque, as accelerations of its corners, stay below a small
// share of gravity. A block that starts to tip is slow but out of balance.
void updateSleepTimer(Simulation& simulation, std::size_t b) {
  const Settings& settings = simulation.scene.settings;
  SleepWindow& window = simulation.engine->sleep.windows[b];
  const double slow = settings.sleepSpeed * speedScale_m_s(simulation);
  const bool ends = window.age_s + settings.frame_s >= settings.sleepTime * restTimeScale_s(simulation);
  if (!ends && fastestRigidCorner(simulation, b) < slow) {  // the common case, without computing the rigid motion
    simulation.restTime_s[b] += settings.frame_s;
    window.age_s += settings.frame_s;
    return;
  }
  const RigidMotion motion = rigidMotion(simulation.state, b);
  const double arm = 0.5 * simulation.model.dimensions[b].norm();
  const auto begin = [&] { window = {motion.centre, motion.velocity, motion.spin, 0.0}; };
  if (!(motion.cornerSpeed < slow)) {
    simulation.restTime_s[b] = 0.0;
    begin();
    return;
  }
  simulation.restTime_s[b] += settings.frame_s;
  window.age_s += settings.frame_s;
  if (window.age_s < settings.sleepTime * restTimeScale_s(simulation)) return;
  const double change = (motion.velocity - window.velocity).norm() + arm * (motion.spin - window.spin).norm();
  if (change > settings.sleepImbalance * simulation.scene.gravity.magnitude * window.age_s) simulation.restTime_s[b] = 0.0;
  begin();
}

// The report's test (its appendix 2.5): the displacement of the block's particles over one frame, compression included.
void updateSleepTimerOfReport(Simulation& simulation, std::size_t b) {
  double moved = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c)
    moved += (simulation.state.position.at(b, c) - frameStartPosition(simulation, b, c)).norm();
  simulation.restTime_s[b] = moved < simulation.scene.settings.reportDisableDistance_m ? simulation.scene.settings.frame_s : 0.0;
}

// Whether an awake block slides on the sleeping one of a pair too fast for the support check, or may hit it in this frame faster
// than a hand puts a block down. `supported`: whether anything touches the awake block.
bool mayBeHit(const Simulation& simulation, std::size_t at, std::int32_t awake, bool supported) {
  const BlockPair& pair = simulation.engine->pairs.key[at];
  const auto block = static_cast<std::size_t>(awake);
  const double scale = speedScale_m_s(simulation);
  const bool held = simulation.tether.block == blockId(block);
  const double speed =
      std::max(fastestCorner(simulation.state.velocity, block, Vec3::Zero()), held ? simulation.tether.velocity.norm() : 0.0);
  if (anyPointTouches(contactOf(*simulation.engine, at))) return speed > tuning::kWakeSlideSpeed * scale;
  const bool falls = !supported && !held;
  if (!falls && speed <= tuning::kWakeImpactSpeed * scale) return false;
  const double frame_s = simulation.scene.settings.frame_s;
  const ParticleArray& position = simulation.state.position;
  const Separation separation = findSeparation(cornersOf(position, static_cast<std::size_t>(pair.a)),
                                               cornersOf(position, static_cast<std::size_t>(pair.b)));
  const double gap = std::max(0.0, separation.best());
  const Vec3 towards = pair.a == awake ? Vec3(-separation.bestNormal()) : separation.bestNormal();
  double closing = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) closing = std::max(closing, simulation.state.velocity.at(block, c).dot(towards));
  const double fall = falls ? std::max(0.0, simulation.scene.gravity.at(simulation.time_s).dot(towards)) : 0.0;
  if (gap > frame_s * (closing + 0.5 * fall * frame_s)) return false;
  return std::sqrt(closing * closing + 2.0 * fall * gap) > tuning::kWakeImpactSpeed * scale;
}

double restNeeded(const Simulation& simulation) {
  return simulation.scene.settings.sleep == Sleep::report ? simulation.scene.settings.frame_s
                                                          : simulation.scene.settings.sleepTime * restTimeScale_s(simulation);
}

// Whether a block has been at rest for so long. For 0 s it has to be at rest as well.
bool restsFor(const Simulation& simulation, std::size_t block, double needed_s) {
  const double rest_s = simulation.restTime_s[block];
  return rest_s > 0.0 && rest_s >= needed_s;
}

void fallAsleep(Simulation& simulation, std::size_t b) {
  Engine& engine = *simulation.engine;
  simulation.asleep[b] = 1;
  engine.sleep.checkedLoads.clear();
  engine.memo.blockHistory[b].hasFallen = false;
  IslandHistory& history = engine.memo.islandHistory[b];
  history.rigid = history.forced = false;
  history.rigidFrames = 0;
  history.implicitSteps = std::min(history.implicitSteps, tuning::kMaxFrequencySteps);
  --engine.sleep.awakeCount;
  for (std::size_t a = 0; a < 3; ++a) std::fill_n(simulation.state.velocity.values(a, b), kCorners, 0.0);
  engine.memo.frames[b] = blockFrame(simulation.state.position, b);
  engine.memo.motion[b] = AffineField{};
  if (!engine.memo.carriedMotion.empty()) engine.memo.carriedMotion[b] = AffineField{};
  if (!engine.report.contacts.empty()) engine.report.contacts[b].clear();
}

void findRoots(Engine& engine) {
  engine.scratch.wakeRoots.clear();
  for (const WakeRequest& request : engine.scratch.toWake) engine.scratch.wakeRoots.push_back(request.block);
}

void wakeRequested(Simulation& simulation) {
  for (const WakeRequest& request : simulation.engine->scratch.toWake)
    wake(simulation, static_cast<std::size_t>(request.block), request.reason);
}

// If a whole touching cluster is at rest but the recorded loads of some sleepers no longer balance, wakes the cluster at once.
// Waking one row at a time would need one rest period a row.
void wakeUnbalancedCluster(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  engine.scratch.touchingEdges.clear();
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    const BlockPair& pair = engine.pairs.key[at];
    const bool fixed = isFixed(simulation, pair.a) || isFixed(simulation, pair.b);
    if (!fixed && engine.pairs.touches(at)) engine.scratch.touchingEdges.push_back({pair.a, pair.b});
  }
  engine.scratch.touched.resize(simulation.asleep.size());
  findRoots(engine);
  connectedBlocks(engine.scratch.touchingEdges, engine.scratch.wakeRoots, engine.scratch.parent, engine.scratch.touched);
  const auto touches = [&](std::int32_t block) { return engine.scratch.touched[static_cast<std::size_t>(block)] != 0; };
  if (std::any_of(engine.scratch.restless.begin(), engine.scratch.restless.end(), touches)) return;
  for (std::size_t b = 0; b < engine.scratch.touched.size(); ++b) {
    if (engine.scratch.touched[b] == 0) continue;
    engine.scratch.joined[b] = 1;
    engine.scratch.toWake.push_back({static_cast<std::int32_t>(b), WakeReason::unbalanced});
  }
}

// Puts blocks to sleep: connected groups that are all at rest, at once; and a block that has been at rest for long beside moving
// ones by itself, because later changes of its load are checked in every frame. Method `report` has no persistent contacts: there
// near pairs count as touching, and no block sleeps beside one that is not at rest.
void putToSleep(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const double needed = restNeeded(simulation);
  const auto ready = [&](std::int32_t block) {
    if (!restsFor(simulation, static_cast<std::size_t>(block), needed) ||
        block == static_cast<std::int32_t>(simulation.tether.block)) {
      return false;
    }
    const double frame_s = simulation.scene.settings.frame_s;
    return std::none_of(simulation.scene.forces.begin(), simulation.scene.forces.end(), [&](const UserForce& user) {
      return user.block == block && user.actsWithin(simulation.time_s - frame_s, simulation.time_s - frame_s + frame_s);
    });
  };
  if (std::none_of(engine.scratch.awakeBlocks.begin(), engine.scratch.awakeBlocks.end(), ready)) return;

  engine.scratch.restless.clear();
  engine.scratch.touchingEdges.clear();
  for (const std::int32_t block : engine.scratch.awakeBlocks) {
    if (!ready(block)) engine.scratch.restless.push_back(block);
  }
  const Settings& settings = simulation.scene.settings;
  const bool nearCounts = traitsOf(settings.method).family == MethodFamily::report;
  if (settings.sleep == Sleep::on) {
    for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
      const BlockPair& pair = engine.pairs.key[at];
      if (pair.b < 0 || (!engine.pairs.touches(at) && !nearCounts)) continue;
      const bool bothAwake =
          simulation.asleep[static_cast<std::size_t>(pair.a)] == 0 && simulation.asleep[static_cast<std::size_t>(pair.b)] == 0;
      if (bothAwake) engine.scratch.touchingEdges.push_back({pair.a, pair.b});
    }
  }
  engine.scratch.joined.resize(simulation.asleep.size());
  connectedBlocks(engine.scratch.touchingEdges, engine.scratch.restless, engine.scratch.parent, engine.scratch.joined);
  for (const std::int32_t block : engine.scratch.awakeBlocks) {
    const bool restsLong = simulation.restTime_s[static_cast<std::size_t>(block)] >= tuning::kSingleSleepFactor * needed;
    if (restsLong && ready(block) && !nearCounts) engine.scratch.joined[static_cast<std::size_t>(block)] = 0;
  }
  engine.scratch.toWake.clear();
  recordSleepLoads(simulation, engine.scratch.joined);
  if (!engine.scratch.toWake.empty() && settings.sleep == Sleep::on) wakeUnbalancedCluster(simulation);
  // Those that sleep already keep the gravity under which they came to rest: it may turn slowly.
  if (engine.sleep.awakeCount == engine.sleep.movableCount) engine.sleep.gravity = simulation.scene.gravity.at(simulation.time_s);
  for (const std::int32_t block : engine.scratch.awakeBlocks) {
    if (engine.scratch.joined[static_cast<std::size_t>(block)] == 0) fallAsleep(simulation, static_cast<std::size_t>(block));
  }
  wakeRequested(simulation);
}

}  // namespace

void wake(Simulation& simulation, std::size_t block, WakeReason reason) {
  if (simulation.asleep[block] == 0 || simulation.model.isFixed(block)) return;
  ++simulation.wakes[static_cast<std::size_t>(reason)];
  simulation.asleep[block] = 0;
  simulation.engine->scratch.inParts[block] = simulation.engine->scratch.part.begin_s > 0.0 ? 1 : 0;  // at rest at any time
  simulation.engine->sleep.checkedLoads.clear();
  simulation.restTime_s[block] = 0.0;
  ++simulation.engine->sleep.awakeCount;
  const RigidMotion motion = rigidMotion(simulation.state, block);
  simulation.engine->sleep.windows[block] = {motion.centre, motion.velocity, motion.spin, 0.0};
}

void wakeForInputs(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  if (engine.sleep.awakeCount == engine.sleep.movableCount) return;
  const double frame_s = simulation.scene.settings.frame_s;
  const Vec3 gravity = simulation.scene.gravity.at(simulation.time_s + frame_s);
  if ((gravity - engine.sleep.gravity).norm() > tuning::kWakeGravityChange * simulation.scene.gravity.magnitude) {
    for (std::size_t b = 0; b < simulation.asleep.size(); ++b) wake(simulation, b, WakeReason::gravity);
    return;
  }
  for (const UserForce& user : simulation.scene.forces) {
    if (user.actsWithin(simulation.time_s, simulation.time_s + frame_s))
      wake(simulation, static_cast<std::size_t>(user.block), WakeReason::force);
  }
  if (simulation.tether.block != kFloor) wake(simulation, index(simulation.tether.block), WakeReason::hand);
}

namespace {

// Adds the sleeping blocks to engine.scratch.toWake that awake ones may hit in this frame, or slide on.
void findStruck(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  engine.scratch.touched.assign(simulation.asleep.size(), 0);
  for (const std::int32_t position : engine.memo.islandPairs) {
    const auto at = static_cast<std::size_t>(position);
    const BlockPair& pair = engine.pairs.key[at];
    if (!anyPointTouches(contactOf(engine, at))) continue;
    engine.scratch.touched[static_cast<std::size_t>(pair.a)] = 1;
    if (pair.b >= 0) engine.scratch.touched[static_cast<std::size_t>(pair.b)] = 1;
  }
  for (const std::int32_t position : engine.memo.islandPairs) {
    const auto at = static_cast<std::size_t>(position);
    const BlockPair& pair = engine.pairs.key[at];
    if (isSleeper(simulation, pair.a) == isSleeper(simulation, pair.b)) continue;
    const bool sleepsA = isSleeper(simulation, pair.a);
    const std::int32_t awake = sleepsA ? pair.b : pair.a;
    if (isFixed(simulation, awake)) continue;
    if (mayBeHit(simulation, at, awake, engine.scratch.touched[static_cast<std::size_t>(awake)] != 0))
      engine.scratch.toWake.push_back({sleepsA ? pair.a : pair.b, WakeReason::impact});
  }
}

// Whether an awake block is at another time of the frame than those that are stepped now: what moves through it in parts is ahead
// of the rest when that takes the whole frame, and in all parts but the first the rest is behind.
bool isAtOtherTime(const Simulation& simulation, std::int32_t block) {
  const Scratch& scratch = simulation.engine->scratch;
  if (sleeps(simulation, block)) return false;
  const bool inParts = scratch.inParts[static_cast<std::size_t>(block)] != 0;
  if (scratch.part.begin_s > 0.0) return !inParts;
  return inParts && scratch.part.end_s == simulation.scene.settings.frame_s;
}

// Marks in `held` the sleeping blocks that touch such blocks, and all that are connected to them by contacts. Awake, they would
// be without the forces of that contact until the frame ends, so they wake afterwards. Precondition: engine.scratch.touchingEdges
// are the contacts of sleeping blocks.
void findHeld(Simulation& simulation, std::vector<std::uint8_t>& held) {
  Engine& engine = *simulation.engine;
  engine.scratch.wakeRoots.clear();
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    const BlockPair& pair = engine.pairs.key[at];
    if (!engine.pairs.touches(at)) continue;
    if (isSleeper(simulation, pair.a) && isAtOtherTime(simulation, pair.b)) engine.scratch.wakeRoots.push_back(pair.a);
    if (isSleeper(simulation, pair.b) && isAtOtherTime(simulation, pair.a)) engine.scratch.wakeRoots.push_back(pair.b);
  }
  held.resize(simulation.asleep.size());
  connectedBlocks(engine.scratch.touchingEdges, engine.scratch.wakeRoots, engine.scratch.parent, held);
}

void listContactsOfSleepers(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  engine.scratch.touchingEdges.clear();
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    const BlockPair& pair = engine.pairs.key[at];
    if (engine.pairs.touches(at) && isSleeper(simulation, pair.a) && isSleeper(simulation, pair.b))
      engine.scratch.touchingEdges.push_back({pair.a, pair.b});
  }
}

}  // namespace

bool wakeOnImpact(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const bool anyMayBeHit = simulation.scene.settings.sleep == Sleep::on && engine.sleep.awakeCount != engine.sleep.movableCount;
  if (!anyMayBeHit && engine.scratch.nearDriven.empty()) return false;
  const StageTimer timer(simulation.stageTimes, Stage::islandsAndSleep);
  engine.scratch.toWake.clear();
  for (const NearDriven& near : engine.scratch.nearDriven) {
    if (isSleeper(simulation, near.block)) engine.scratch.toWake.push_back({near.block, WakeReason::impact});
  }
  if (anyMayBeHit) findStruck(simulation);
  if (engine.scratch.toWake.empty()) return false;
  listContactsOfSleepers(simulation);
  engine.scratch.touched.resize(simulation.asleep.size());
  findRoots(engine);
  connectedBlocks(engine.scratch.touchingEdges, engine.scratch.wakeRoots, engine.scratch.parent, engine.scratch.touched);
  findHeld(simulation, engine.scratch.joined);
  bool any = false;
  for (std::size_t b = 0; b < engine.scratch.touched.size(); ++b) {
    if (engine.scratch.touched[b] == 0 || engine.scratch.joined[b] != 0) continue;
    wake(simulation, b, WakeReason::impact);
    any = true;
  }
  return any;
}

bool wakeFailedSupports(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  engine.scratch.toWake.clear();
  if (engine.sleep.awakeCount == engine.sleep.movableCount) return false;
  const StageTimer timer(simulation.stageTimes, Stage::islandsAndSleep);
  if (!findWakeCandidates(simulation)) return false;
  listContactsOfSleepers(simulation);
  findHeld(simulation, engine.scratch.joined);
  bool any = false;
  for (const WakeRequest& request : engine.scratch.toWake) {
    const auto b = static_cast<std::size_t>(request.block);
    if (engine.scratch.joined[b] != 0 || simulation.asleep[b] == 0) continue;
    wake(simulation, b, request.reason);
    any = true;
  }
  return any;
}

void updateRest(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const Sleep sleep = simulation.scene.settings.sleep;
  const std::vector<std::int32_t>& awake = engine.scratch.awakeBlocks;
  forRanges(awake.size(), tuning::kBlockGrain, awake.size() >= tuning::kParallelBlocks, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto b = static_cast<std::size_t>(awake[i]);
      sleep == Sleep::report ? updateSleepTimerOfReport(simulation, b) : updateSleepTimer(simulation, b);
    }
  });
  if (sleep == Sleep::off) return;
  // What a moving block is near to is not at rest, however still it lies.
  for (const NearDriven& near : engine.scratch.nearDriven) simulation.restTime_s[static_cast<std::size_t>(near.block)] = 0.0;
  wakeRequested(simulation);
  putToSleep(simulation);
}

bool allAsleep(const Simulation& simulation) {
  const auto& asleep = simulation.asleep;
  return std::memchr(asleep.data(), 0, asleep.size()) == nullptr;
}

bool atRest(const Simulation& simulation) {
  const double needed = restNeeded(simulation);
  for (std::size_t b = 0; b < simulation.restTime_s.size(); ++b) {
    if (!restsFor(simulation, b, needed) && !simulation.model.isFixed(b)) return false;
  }
  return true;
}

}  // namespace springtower
