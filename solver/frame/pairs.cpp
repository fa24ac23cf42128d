#include "solver/frame/pairs.h"

#include "core/error.h"
#include "core/tuning.h"
#include "solver/contact/approach.h"
#include "solver/world/driven_blocks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fmt/format.h>
#include <string>

namespace springtower {

namespace {

// Whether a pair is kept although the sweep did not report it: both blocks sleep.
bool dormant(const Simulation& simulation, const BlockPair& pair) {
  return sleeps(simulation, pair.a) && sleeps(simulation, pair.b);
}

// Handles a pair that the sweep has dropped. If one of its blocks sleeps with a load from the other, that block has to be woken.
void dropPair(Simulation& simulation, std::size_t at) {
  Engine& engine = *simulation.engine;
  const BlockPair pair = engine.pairs.key[at];
  if (pair.b >= 0 && !sleepLoadOf(engine, at).force.isZero(0.0)) {
    if (isSleeper(simulation, pair.a)) engine.scratch.lostNeighbours.push_back(pair.a);
    if (isSleeper(simulation, pair.b)) engine.scratch.lostNeighbours.push_back(pair.b);
  }
  if (engine.pairs.contact[at] >= 0) engine.contacts.giveBack(engine.pairs.contact[at]);
}

// Calls `visit` with each pair that the sweep has found, by (a, b), the floor as b = -1.
template <class Visit>
void forEachSwept(const Simulation& simulation, const Visit& visit) {
  const Engine& engine = *simulation.engine;
  auto pair = engine.memo.sweptPairs.begin();
  const auto blocks = static_cast<std::int32_t>(simulation.model.blockCount());
  for (std::int32_t block = 0; block < blocks; ++block) {
    const auto b = static_cast<std::size_t>(block);
    if (simulation.scene.floor && simulation.asleep[b] == 0 && engine.memo.boxes.lower[2][b] <= 0.0) visit(BlockPair{block, -1});
    for (; pair != engine.memo.sweptPairs.end() && pair->a == block; ++pair) visit(*pair);
  }
}

// Returns contacts of separated pairs to the pool, except where a sleeping block's load is still to be compared with that when it
// fell asleep.
void releaseContacts(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    std::int32_t& contact = engine.pairs.contact[at];
    if (contact < 0 || engine.pairs.touches(at)) continue;
    const BlockPair& pair = engine.pairs.key[at];
    const bool sleeper = isSleeper(simulation, pair.a) || isSleeper(simulation, pair.b);
    if (sleeper && !engine.contacts.sleepLoad(contact).force.isZero(0.0)) continue;
    engine.contacts.giveBack(contact);
    contact = -1;
  }
}

// Rearranges a column of the pair table: the previous value of each pair, or `first`.
template <class T>
void rearrange(const std::vector<std::int32_t>& from, T first, std::vector<std::byte>& space, std::vector<T>& column) {
  space.resize(from.size() * sizeof(T));
  for (std::size_t i = 0; i < from.size(); ++i) {
    const T& value = from[i] < 0 ? first : column[static_cast<std::size_t>(from[i])];
    std::memcpy(space.data() + i * sizeof(T), &value, sizeof(T));
  }
  column.resize(from.size());
  if (!column.empty()) std::memcpy(column.data(), space.data(), space.size());
}

// Updates engine.pairs from the sweep, keeping the values of known pairs. Returns whether pairs were added or removed, or are
// kept without having been found.
bool mergePairs(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  PairTable& pairs = engine.pairs;
  std::vector<BlockPair>& keys = engine.scratch.mergedKeys;
  std::vector<std::int32_t>& from = engine.scratch.mergedFrom;
  keys.clear();
  from.clear();
  std::size_t old = 0;
  bool changed = false;
  const auto keepDormantBefore = [&](const BlockPair& limit) {
    for (; old < pairs.size() && pairs.key[old] < limit; ++old) {
      changed = true;
      if (dormant(simulation, pairs.key[old])) {
        keys.push_back(pairs.key[old]);
        from.push_back(static_cast<std::int32_t>(old));
      } else {
        dropPair(simulation, old);
      }
    }
  };
  forEachSwept(simulation, [&](const BlockPair& key) {
    keepDormantBefore(key);
    const bool known = old < pairs.size() && pairs.key[old] == key;
    keys.push_back(key);
    from.push_back(known ? static_cast<std::int32_t>(old) : -1);
    changed = changed || !known;
    if (known) ++old;
  });
  keepDormantBefore({static_cast<std::int32_t>(simulation.model.blockCount()), 0});
  if (!changed) return false;
  std::swap(pairs.key, keys);
  rearrange(from, PairPhase::separated, engine.scratch.mergedColumn, pairs.phase);
  rearrange(from, std::int32_t{-1}, engine.scratch.mergedColumn, pairs.contact);
  rearrange(from, 0.0, engine.scratch.mergedColumn, pairs.clearance);
  rearrange(from, 0.0, engine.scratch.mergedColumn, pairs.travelAtCheck);
  for (std::size_t k = 0; k < 3; ++k) rearrange(from, k == 2 ? 1.0 : 0.0, engine.scratch.mergedColumn, pairs.axis[k]);
  keys.reserve(pairs.key.capacity());  // the two are swapped, so both need the larger capacity
  return true;
}

// The island that a pair belongs to: that of its awake blocks. None where these are at different times of the frame.
std::int32_t islandOf(const Engine& engine, const BlockPair& pair) {
  const std::int32_t island = engine.memo.islands.islandOf[static_cast<std::size_t>(pair.a)];
  if (pair.b < 0) return island;
  const std::int32_t other = engine.memo.islands.islandOf[static_cast<std::size_t>(pair.b)];
  if (island >= 0 && other >= 0 && island != other) return -1;
  return island >= 0 ? island : other;
}

// Lists the pairs of each island, in order; for islands that run on many threads those of each block as well.
void listIslandPairs(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  engine.memo.newtonSystems.assign(engine.memo.islands);
  // What sweeps of earlier parts of the frame have merged may have been at other times.
  for (NewtonSystem& island : engine.memo.newtonSystems.all()) island.forcesKnown = false;
  engine.memo.sparseFactors.assign(engine.memo.islands);
  const std::size_t islands = engine.memo.islands.count();
  engine.memo.pairStart.assign(islands + 1, 0);
  for (const BlockPair& pair : engine.pairs.key) {
    const std::int32_t island = islandOf(engine, pair);
    if (island >= 0) ++engine.memo.pairStart[static_cast<std::size_t>(island) + 1];
  }
  for (std::size_t i = 0; i < islands; ++i) engine.memo.pairStart[i + 1] += engine.memo.pairStart[i];
  engine.memo.islandPairs.resize(static_cast<std::size_t>(engine.memo.pairStart[islands]));
  engine.scratch.cursor.assign(engine.memo.pairStart.begin(), engine.memo.pairStart.end());
  for (std::size_t p = 0; p < engine.pairs.size(); ++p) {
    const std::int32_t island = islandOf(engine, engine.pairs.key[p]);
    if (island >= 0)
      engine.memo.islandPairs[static_cast<std::size_t>(engine.scratch.cursor[static_cast<std::size_t>(island)]++)] =
          static_cast<std::int32_t>(p);
  }

  bool parallel = false;
  for (std::size_t i = 0; i < islands && !parallel; ++i)
    parallel = engine.memo.islands.island(i).size() >= tuning::kParallelBlocks;
  if (!parallel) return;
  const std::size_t blocks = simulation.model.blockCount();
  engine.memo.blockPairStart.assign(blocks + 1, 0);
  const auto forEachAwake = [&](const BlockPair& pair, const auto& visit) {
    if (islandOf(engine, pair) < 0) return;  // of blocks at different times of the frame: no island evaluates its force
    if (simulation.asleep[static_cast<std::size_t>(pair.a)] == 0) visit(static_cast<std::size_t>(pair.a));
    if (pair.b >= 0 && simulation.asleep[static_cast<std::size_t>(pair.b)] == 0) visit(static_cast<std::size_t>(pair.b));
  };
  for (const BlockPair& pair : engine.pairs.key) forEachAwake(pair, [&](std::size_t b) { ++engine.memo.blockPairStart[b + 1]; });
  for (std::size_t b = 0; b < blocks; ++b) engine.memo.blockPairStart[b + 1] += engine.memo.blockPairStart[b];
  engine.memo.blockPairs.resize(static_cast<std::size_t>(engine.memo.blockPairStart[blocks]));
  engine.scratch.cursor.assign(engine.memo.blockPairStart.begin(), engine.memo.blockPairStart.end());
  for (std::size_t p = 0; p < engine.pairs.size(); ++p) {
    forEachAwake(engine.pairs.key[p], [&](std::size_t b) {
      engine.memo.blockPairs[static_cast<std::size_t>(engine.scratch.cursor[b]++)] = static_cast<std::int32_t>(p);
    });
  }
}

bool anyInParts(const Engine& engine) {
  const std::vector<std::uint8_t>& inParts = engine.scratch.inParts;
  return std::find(inParts.begin(), inParts.end(), 1) != inParts.end();
}

// Boxes for the part of the frame that comes: of blocks that move through the frame in several parts, by rigid steps without
// rebound, for this part; of others for all of it.
void sweepBoxes(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const auto sweep = [&](std::span<const std::int32_t> blocks, double duration_s, Way way) {
    computeSweptBoxes(simulation.state, blocks, simulation.scene.gravity.magnitude, duration_s, way, engine.memo.sweepMargin,
                      engine.memo.boxes, engine.scratch.reach);
  };
  if (!anyInParts(engine)) return sweep(engine.scratch.awakeBlocks, simulation.scene.settings.frame_s, Way::anySide);
  std::vector<std::int32_t>& ordered = engine.scratch.byDuration;
  ordered.clear();
  std::size_t count = 0;
  for (const bool inParts : {true, false}) {
    for (const std::int32_t block : engine.scratch.awakeBlocks) {
      if ((engine.scratch.inParts[static_cast<std::size_t>(block)] != 0) == inParts) ordered.push_back(block);
    }
    if (inParts) count = ordered.size();
  }
  const std::span<const std::int32_t> all(ordered);
  sweep(all.first(count), engine.scratch.part.duration_s(), Way::onwards);
  sweep(all.subspan(count), simulation.scene.settings.frame_s, Way::anySide);
}

// A box that is not finite has no place in the order of boxes along an axis, and an impact would share out among many blocks a
// speed that one of them cannot have.
void checkMotion(const Simulation& simulation, std::int32_t block) {
  const Engine& engine = *simulation.engine;
  const auto b = static_cast<std::size_t>(block);
  const SweptBoxes& boxes = engine.memo.boxes;
  // A box of less than a path at half the largest speed needs no look at the velocities; the condition does not hold for NaN.
  const double most_m = 0.5 * tuning::kMaxSpeed * engine.scratch.part.duration_s();
  double longest_m = 0.0;
  for (std::size_t a = 0; a < 3; ++a) longest_m = std::max(longest_m, boxes.upper[a][b] - boxes.lower[a][b]);
  if (std::isfinite(engine.scratch.reach[b]) && longest_m < most_m) return;
  const double time_s = simulation.time_s + engine.scratch.part.begin_s;
  std::string cause = "its positions or velocities are no longer finite";
  if (std::isfinite(engine.scratch.reach[b])) {
    const double speed = fastestCorner(simulation.state.velocity, b, Vec3::Zero());
    if (speed <= tuning::kMaxSpeed) return;
    cause = fmt::format("it moves at {:.3g} m/s", speed);
  }
  throw DivergenceError(fmt::format("block {} diverged at {:.6f} s: {}", block, time_s, cause), block, time_s);
}

// Blocks that are at different times of the frame are not in one island. Those near a driven block are, as it moves with their
// steps.
std::span<const BlockPair> edgesOfIslands(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const std::vector<NearDriven>& near = engine.scratch.nearDriven;
  if (!anyInParts(engine) && near.empty()) return engine.memo.sweptPairs;
  const std::vector<std::uint8_t>& inParts = engine.scratch.inParts;
  std::vector<BlockPair>& edges = engine.scratch.islandEdges;
  edges.clear();
  for (const BlockPair& pair : engine.memo.sweptPairs) {
    if (inParts[static_cast<std::size_t>(pair.a)] == inParts[static_cast<std::size_t>(pair.b)]) edges.push_back(pair);
  }
  const NearDriven* last = nullptr;
  for (const NearDriven& next : near) {
    if (simulation.asleep[static_cast<std::size_t>(next.block)] != 0) continue;
    if (last != nullptr && last->driven == next.driven && last->inParts == next.inParts)
      edges.push_back({last->block, next.block});
    last = &next;
  }
  return edges;
}

}  // namespace

void findNearPairs(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  {
    const StageTimer timer(simulation.stageTimes, Stage::broadphase);
    engine.scratch.awakeBlocks.clear();
    for (std::size_t b = 0; b < simulation.asleep.size(); ++b) {
      if (simulation.asleep[b] == 0) engine.scratch.awakeBlocks.push_back(static_cast<std::int32_t>(b));
    }
    sweepBoxes(simulation);
    for (const std::int32_t block : engine.scratch.awakeBlocks) {
      const auto b = static_cast<std::size_t>(block);
      checkMotion(simulation, block);
      engine.memo.travelAtSweep[b] = engine.memo.blockHistory[b].travel;
    }
    if (simulation.frame == 0 || !engine.memo.swept) reset(engine.memo.sweep, engine.memo.boxes);
    engine.memo.swept = true;
    findPairs(engine.memo.sweep, engine.memo.boxes, sweepDriven(simulation), engine.memo.sweptPairs);
    listNearDriven(simulation);
    simulation.counters.blockPairs += engine.memo.sweptPairs.size();
    releaseContacts(simulation);
    engine.memo.topologyChanged = mergePairs(simulation);
  }
  const StageTimer timer(simulation.stageTimes, Stage::islandsAndSleep);
  engine.memo.topologyChanged =
      updateIslands(engine.memo.islands, edgesOfIslands(simulation), simulation.asleep) || engine.memo.topologyChanged;
  listDrivenOfIslands(simulation);
  if (engine.memo.topologyChanged) listIslandPairs(simulation);
  engine.scratch.covered.assign(engine.pairs.size(), 0);
  engine.scratch.watchedPairs.resize(engine.memo.islandPairs.size());  // also where a snapshot has restored other lists
}

void growSweepMargins(Engine& engine) {
  for (std::size_t i = 0; i < engine.memo.islands.count(); ++i) {
    if (engine.scratch.islandOutcome[i] >= 0) continue;
    for (const std::int32_t block : engine.memo.islands.island(i))
      engine.memo.sweepMargin[static_cast<std::size_t>(block)] *= tuning::kReplayMarginGrowth;
  }
}

}  // namespace springtower
