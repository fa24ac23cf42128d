#include "solver/frame/pairs.h"

#include <algorithm>
#include <tuple>

namespace springtower {

namespace {

using Key = std::tuple<std::int32_t, std::int32_t>;

Key keyOf(const NearPair& pair) {
  return {pair.a, pair.b};
}

// Whether a pair met before is kept though the sweep did not report it: nothing moves in it.
bool dormant(const Simulation& simulation, const NearPair& pair) {
  return sleeps(simulation, pair.a) && sleeps(simulation, pair.b);
}

// A sleeping block whose awake neighbour has gone must be asked whether it still stands.
void noteLostPartner(Simulation& simulation, const NearPair& pair) {
  if (pair.b < 0 || pair.restForce.isZero(0.0)) return;
  if (sleeps(simulation, pair.a)) simulation.engine->lostPartner.push_back(pair.a);
  if (sleeps(simulation, pair.b)) simulation.engine->lostPartner.push_back(pair.b);
}

// The keys that the sweep asks for, by (a, b), the floor as b = -1.
void listKeys(const Simulation& simulation, std::vector<BlockPair>& keys) {
  const Engine& engine = *simulation.engine;
  keys.clear();
  auto pair = engine.sweptPairs.begin();
  const auto blocks = static_cast<std::int32_t>(simulation.model.blockCount());
  for (std::int32_t block = 0; block < blocks; ++block) {
    const auto b = static_cast<std::size_t>(block);
    if (simulation.scene.floor && simulation.asleep[b] == 0 && engine.boxes.lower[2][b] <= 0.0) keys.push_back({block, -1});
    for (; pair != engine.sweptPairs.end() && pair->a == block; ++pair) keys.push_back(*pair);
  }
}

// Brings engine.pairs to what the sweep asks for, taking over what was known of each. Returns whether any came or went.
bool mergePairs(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  std::vector<BlockPair>& keys = engine.keys;
  listKeys(simulation, keys);
  if (keys == engine.pairKeys) return false;
  std::swap(engine.pairs, engine.pairsBefore);
  engine.pairs.clear();
  auto old = engine.pairsBefore.begin();
  const auto keepDormantBefore = [&](const Key& limit) {
    for (; old != engine.pairsBefore.end() && keyOf(*old) < limit; ++old) {
      if (dormant(simulation, *old)) {
        engine.pairs.push_back(*old);
      } else {
        noteLostPartner(simulation, *old);
      }
    }
  };
  for (const BlockPair& key : keys) {
    keepDormantBefore({key.a, key.b});
    if (old != engine.pairsBefore.end() && keyOf(*old) == Key{key.a, key.b}) {
      engine.pairs.push_back(*old);
      ++old;
      continue;
    }
    NearPair fresh;
    fresh.a = key.a;
    fresh.b = key.b;
    engine.pairs.push_back(fresh);
  }
  keepDormantBefore({static_cast<std::int32_t>(simulation.model.blockCount()), 0});
  engine.pairKeys.clear();
  for (const NearPair& pair : engine.pairs) engine.pairKeys.push_back({pair.a, pair.b});
  // The two change places: as large as one has grown, the other will be.
  engine.pairsBefore.reserve(engine.pairs.capacity());
  return true;
}

// The island a pair moves with: that of whichever block is awake.
std::int32_t islandOf(const Engine& engine, const NearPair& pair) {
  const std::int32_t island = engine.islands.islandOf[static_cast<std::size_t>(pair.a)];
  return island >= 0 || pair.b < 0 ? island : engine.islands.islandOf[static_cast<std::size_t>(pair.b)];
}

// Lists the pairs of each island, in order; for islands that run on many threads those of each block as well.
void listIslandPairs(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const std::size_t islands = engine.islands.count();
  engine.pairStart.assign(islands + 1, 0);
  for (const NearPair& pair : engine.pairs) {
    const std::int32_t island = islandOf(engine, pair);
    if (island >= 0) ++engine.pairStart[static_cast<std::size_t>(island) + 1];
  }
  for (std::size_t i = 0; i < islands; ++i) engine.pairStart[i + 1] += engine.pairStart[i];
  engine.islandPairs.resize(static_cast<std::size_t>(engine.pairStart[islands]));
  engine.watchedPairs.resize(engine.islandPairs.size());
  engine.cursor.assign(engine.pairStart.begin(), engine.pairStart.end());
  for (std::size_t p = 0; p < engine.pairs.size(); ++p) {
    const std::int32_t island = islandOf(engine, engine.pairs[p]);
    if (island >= 0)
      engine.islandPairs[static_cast<std::size_t>(engine.cursor[static_cast<std::size_t>(island)]++)] =
          static_cast<std::int32_t>(p);
  }

  bool parallel = false;
  for (std::size_t i = 0; i < islands && !parallel; ++i) parallel = engine.islands.island(i).size() >= kParallelBlocks;
  if (!parallel) return;
  const std::size_t blocks = simulation.model.blockCount();
  engine.pairForce.resize(engine.pairs.size());
  engine.blockPairStart.assign(blocks + 1, 0);
  const auto forEachAwake = [&](const NearPair& pair, const auto& visit) {
    if (simulation.asleep[static_cast<std::size_t>(pair.a)] == 0) visit(static_cast<std::size_t>(pair.a));
    if (pair.b >= 0 && simulation.asleep[static_cast<std::size_t>(pair.b)] == 0) visit(static_cast<std::size_t>(pair.b));
  };
  for (const NearPair& pair : engine.pairs) forEachAwake(pair, [&](std::size_t b) { ++engine.blockPairStart[b + 1]; });
  for (std::size_t b = 0; b < blocks; ++b) engine.blockPairStart[b + 1] += engine.blockPairStart[b];
  engine.blockPairs.resize(static_cast<std::size_t>(engine.blockPairStart[blocks]));
  engine.cursor.assign(engine.blockPairStart.begin(), engine.blockPairStart.end());
  for (std::size_t p = 0; p < engine.pairs.size(); ++p) {
    forEachAwake(engine.pairs[p], [&](std::size_t b) {
      engine.blockPairs[static_cast<std::size_t>(engine.cursor[b]++)] = static_cast<std::int32_t>(p);
    });
  }
}

}  // namespace

void findNearPairs(Simulation& simulation, double margin_m) {
  Engine& engine = *simulation.engine;
  {
    const StageTimer timer(simulation.stageTimes, Stage::broadphase);
    engine.awakeBlocks.clear();
    for (std::size_t b = 0; b < simulation.asleep.size(); ++b) {
      if (simulation.asleep[b] == 0) engine.awakeBlocks.push_back(static_cast<std::int32_t>(b));
    }
    computeSweptBoxes(simulation.state, engine.awakeBlocks, simulation.scene.gravity.magnitude, simulation.scene.settings.frame_s,
                      margin_m, engine.boxes, engine.reach);
    for (const std::int32_t block : engine.awakeBlocks) {
      const auto b = static_cast<std::size_t>(block);
      engine.travelAtSweep[b] = engine.blockHistory[b].travel;
    }
    if (simulation.frame == 0 || !engine.swept) reset(engine.sweep, engine.boxes);
    engine.swept = true;
    findPairs(engine.sweep, engine.boxes, simulation.asleep, engine.sweptPairs);
    simulation.counters.blockPairs += engine.sweptPairs.size();
    engine.topologyChanged = mergePairs(simulation);
  }
  const StageTimer timer(simulation.stageTimes, Stage::islandsAndSleep);
  engine.topologyChanged = updateIslands(engine.islands, engine.sweptPairs, simulation.asleep) || engine.topologyChanged;
  if (engine.topologyChanged) listIslandPairs(simulation);
}

}  // namespace springtower
