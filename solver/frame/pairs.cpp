#include "solver/frame/pairs.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace springtower {

namespace {

// Whether a pair met before is kept though the sweep did not report it: nothing moves in it.
bool dormant(const Simulation& simulation, const BlockPair& pair) {
  return sleeps(simulation, pair.a) && sleeps(simulation, pair.b);
}

// Lets go of a pair that the sweep has dropped. A sleeping block whose awake neighbour has gone must be checked for whether it
// still stands.
void dropPair(Simulation& simulation, std::size_t at) {
  Engine& engine = *simulation.engine;
  const BlockPair pair = engine.pairs.key[at];
  if (pair.b >= 0 && !sleepLoadOf(engine, at).force.isZero(0.0)) {
    if (sleeps(simulation, pair.a)) engine.lostPartner.push_back(pair.a);
    if (sleeps(simulation, pair.b)) engine.lostPartner.push_back(pair.b);
  }
  if (engine.pairs.contact[at] >= 0) engine.contacts.giveBack(engine.pairs.contact[at]);
}

// Calls with each pair that the sweep has found, by (a, b), the floor as b = -1.
template <class Visit>
void forEachSwept(const Simulation& simulation, const Visit& visit) {
  const Engine& engine = *simulation.engine;
  auto pair = engine.sweptPairs.begin();
  const auto blocks = static_cast<std::int32_t>(simulation.model.blockCount());
  for (std::int32_t block = 0; block < blocks; ++block) {
    const auto b = static_cast<std::size_t>(block);
    if (simulation.scene.floor && simulation.asleep[b] == 0 && engine.boxes.lower[2][b] <= 0.0) visit(BlockPair{block, -1});
    for (; pair != engine.sweptPairs.end() && pair->a == block; ++pair) visit(*pair);
  }
}

// Gives back contacts of pairs that have parted, but where a sleeper is yet to be compared with what it fell asleep on.
void releaseContacts(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    std::int32_t& contact = engine.pairs.contact[at];
    if (contact < 0 || engine.pairs.touches(at)) continue;
    const BlockPair& pair = engine.pairs.key[at];
    const bool sleeper = sleeps(simulation, pair.a) || (pair.b >= 0 && sleeps(simulation, pair.b));
    if (sleeper && !engine.contacts.sleepLoad(contact).force.isZero(0.0)) continue;
    engine.contacts.giveBack(contact);
    contact = -1;
  }
}

// Rearranges a column of the pair table: what was known of each pair, or a first value.
template <class T>
void rearrange(const std::vector<std::int32_t>& from, T first, std::vector<std::byte>& space, std::vector<T>& column) {
  space.resize(from.size() * sizeof(T));
  for (std::size_t i = 0; i < from.size(); ++i) {
    const T& value = from[i] < 0 ? first : column[static_cast<std::size_t>(from[i])];
    std::memcpy(space.data() + i * sizeof(T), &value, sizeof(T));
  }
  column.resize(from.size());
  std::memcpy(column.data(), space.data(), space.size());
}

// Brings engine.pairs to what the sweep has found, taking over what was known of each. Returns whether any came or went, or is
// kept without being found.
bool mergePairs(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  PairTable& pairs = engine.pairs;
  std::vector<BlockPair>& keys = engine.mergedKeys;
  std::vector<std::int32_t>& from = engine.mergedFrom;
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
  rearrange(from, PairPhase::separated, engine.mergedColumn, pairs.phase);
  rearrange(from, std::int32_t{-1}, engine.mergedColumn, pairs.contact);
  rearrange(from, 0.0, engine.mergedColumn, pairs.clearance);
  rearrange(from, 0.0, engine.mergedColumn, pairs.travelAtCheck);
  for (std::size_t k = 0; k < 3; ++k) rearrange(from, k == 2 ? 1.0 : 0.0, engine.mergedColumn, pairs.axis[k]);
  keys.reserve(pairs.key.capacity());  // the two change places: as large as one has grown, the other will be
  return true;
}

// The island a pair moves with: that of whichever block is awake.
std::int32_t islandOf(const Engine& engine, const BlockPair& pair) {
  const std::int32_t island = engine.islands.islandOf[static_cast<std::size_t>(pair.a)];
  return island >= 0 || pair.b < 0 ? island : engine.islands.islandOf[static_cast<std::size_t>(pair.b)];
}

// Lists the pairs of each island, in order; for islands that run on many threads those of each block as well.
void listIslandPairs(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const std::size_t islands = engine.islands.count();
  engine.pairStart.assign(islands + 1, 0);
  for (const BlockPair& pair : engine.pairs.key) {
    const std::int32_t island = islandOf(engine, pair);
    if (island >= 0) ++engine.pairStart[static_cast<std::size_t>(island) + 1];
  }
  for (std::size_t i = 0; i < islands; ++i) engine.pairStart[i + 1] += engine.pairStart[i];
  engine.islandPairs.resize(static_cast<std::size_t>(engine.pairStart[islands]));
  engine.watchedPairs.resize(engine.islandPairs.size());
  engine.cursor.assign(engine.pairStart.begin(), engine.pairStart.end());
  for (std::size_t p = 0; p < engine.pairs.size(); ++p) {
    const std::int32_t island = islandOf(engine, engine.pairs.key[p]);
    if (island >= 0)
      engine.islandPairs[static_cast<std::size_t>(engine.cursor[static_cast<std::size_t>(island)]++)] =
          static_cast<std::int32_t>(p);
  }

  bool parallel = false;
  for (std::size_t i = 0; i < islands && !parallel; ++i) parallel = engine.islands.island(i).size() >= kParallelBlocks;
  if (!parallel) return;
  const std::size_t blocks = simulation.model.blockCount();
  engine.blockPairStart.assign(blocks + 1, 0);
  const auto forEachAwake = [&](const BlockPair& pair, const auto& visit) {
    if (simulation.asleep[static_cast<std::size_t>(pair.a)] == 0) visit(static_cast<std::size_t>(pair.a));
    if (pair.b >= 0 && simulation.asleep[static_cast<std::size_t>(pair.b)] == 0) visit(static_cast<std::size_t>(pair.b));
  };
  for (const BlockPair& pair : engine.pairs.key) forEachAwake(pair, [&](std::size_t b) { ++engine.blockPairStart[b + 1]; });
  for (std::size_t b = 0; b < blocks; ++b) engine.blockPairStart[b + 1] += engine.blockPairStart[b];
  engine.blockPairs.resize(static_cast<std::size_t>(engine.blockPairStart[blocks]));
  engine.cursor.assign(engine.blockPairStart.begin(), engine.blockPairStart.end());
  for (std::size_t p = 0; p < engine.pairs.size(); ++p) {
    forEachAwake(engine.pairs.key[p], [&](std::size_t b) {
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
    releaseContacts(simulation);
    engine.topologyChanged = mergePairs(simulation);
  }
  const StageTimer timer(simulation.stageTimes, Stage::islandsAndSleep);
  engine.topologyChanged = updateIslands(engine.islands, engine.sweptPairs, simulation.asleep) || engine.topologyChanged;
  if (engine.topologyChanged) listIslandPairs(simulation);
}

}  // namespace springtower
