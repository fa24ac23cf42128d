#include "solver/implicit/equal_islands.h"

#include "core/tuning.h"
#include "solver/world/checkpoint.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <utility>

namespace springtower {

namespace {

// An island as placed.
struct PlacedIsland {
  std::span<const std::int32_t> blocks;
  std::span<const std::int32_t> pairs;
};

PlacedIsland placedIsland(const Memo& memo, std::size_t island) {
  const auto first = static_cast<std::size_t>(memo.pairStart[island]);
  const auto count = static_cast<std::size_t>(memo.pairStart[island + 1]) - first;
  return {memo.islands.island(island), std::span(memo.islandPairs).subspan(first, count)};
}

bool isNear(double a, double b, double unit) {
  return std::abs(a - b) <= tuning::kEqualIslands * unit;
}

bool isSameBlock(const Simulation& simulation, std::size_t a, std::size_t b) {
  const auto isSame = [&](const auto& values) { return isNear(values[a], values[b], std::abs(values[a])); };
  const BlockStiffness& stiffness = simulation.stiffness;
  return simulation.model.dimensions[a] == simulation.model.dimensions[b] && isSame(simulation.model.mass) &&
         simulation.friction.haveSameSurface(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)) &&
         isSame(stiffness.stack_n_m) && isSame(stiffness.floor_n_m) && isSame(stiffness.edge_n_m) &&
         (stiffness.loadShare.empty() || isSame(stiffness.loadShare));
}

bool isPlacedAlike(const Simulation& simulation, std::size_t a, std::size_t b, const Vec3& shift) {
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 apart = simulation.state.position.at(b, c) - simulation.state.position.at(a, c) - shift;
    if (!isNear(apart.norm(), 0.0, simulation.lengths.blockHeight_m) ||
        simulation.state.velocity.at(a, c) != simulation.state.velocity.at(b, c))
      return false;
  }
  return true;
}

// Whether an island has a fixed block near: then its place counts, which is not compared.
bool isNearFixed(const Simulation& simulation, const PlacedIsland& island) {
  return std::any_of(island.pairs.begin(), island.pairs.end(), [&](std::int32_t pair) {
    const BlockPair& key = simulation.engine->pairs.key[static_cast<std::size_t>(pair)];
    return isFixed(simulation, key.a) || (key.b >= 0 && isFixed(simulation, key.b));
  });
}

// The place of a block among those of its island; -1 for the floor.
std::ptrdiff_t placeOf(const PlacedIsland& island, std::int32_t block) {
  if (block < 0) return -1;
  const auto found = std::lower_bound(island.blocks.begin(), island.blocks.end(), block);
  assert(found != island.blocks.end() && *found == block);
  return found - island.blocks.begin();
}

bool areEqual(const Simulation& simulation, const PlacedIsland& one, const PlacedIsland& other) {
  const ParticleArray& position = simulation.state.position;
  const Vec3 shift = position.at(static_cast<std::size_t>(other.blocks.front()), 0) -
                     position.at(static_cast<std::size_t>(one.blocks.front()), 0);
  if (!isNear(shift.z(), 0.0, simulation.lengths.blockHeight_m)) return false;
  for (std::size_t i = 0; i < one.blocks.size(); ++i) {
    const auto a = static_cast<std::size_t>(one.blocks[i]);
    const auto b = static_cast<std::size_t>(other.blocks[i]);
    if (!isSameBlock(simulation, a, b) || !isPlacedAlike(simulation, a, b, shift)) return false;
  }
  const std::vector<BlockPair>& key = simulation.engine->pairs.key;
  return std::equal(one.pairs.begin(), one.pairs.end(), other.pairs.begin(), [&](std::int32_t p, std::int32_t q) {
    const BlockPair& first = key[static_cast<std::size_t>(p)];
    const BlockPair& second = key[static_cast<std::size_t>(q)];
    return placeOf(one, first.a) == placeOf(other, second.a) && placeOf(one, first.b) == placeOf(other, second.b);
  });
}

}  // namespace

std::vector<std::int32_t> firstEqualIslands(const Simulation& simulation) {
  const Memo& memo = simulation.engine->memo;
  std::vector<std::int32_t> first;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::int32_t>> firstOfSize;  // by numbers of blocks and of pairs
  for (std::size_t i = 0; i < memo.islands.count(); ++i) {
    const PlacedIsland island = placedIsland(memo, i);
    first.push_back(static_cast<std::int32_t>(i));
    if (island.blocks.size() == 1 || isNearFixed(simulation, island)) continue;
    std::vector<std::int32_t>& known = firstOfSize[{island.blocks.size(), island.pairs.size()}];
    const auto equal = std::find_if(known.begin(), known.end(), [&](std::int32_t j) {
      return areEqual(simulation, placedIsland(memo, static_cast<std::size_t>(j)), island);
    });
    if (equal != known.end()) {
      first.back() = *equal;
    } else {
      known.push_back(static_cast<std::int32_t>(i));
    }
  }
  return first;
}

void copyEquilibrium(const IslandStep& from, IslandStep& to) {
  Engine& engine = to.engine;
  ParticleArray& position = to.simulation.state.position;
  for (std::size_t i = 0; i < to.blocks.size(); ++i) {
    const auto a = static_cast<std::size_t>(from.blocks[i]);
    const auto b = static_cast<std::size_t>(to.blocks[i]);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 before = frameStartPosition(from.simulation, a, c);
      const Vec3 placed = position.at(b, c);
      position.set(b, c, placed + (position.at(a, c) - before));
      engine.memo.previous.set(b, c, placed + (engine.memo.previous.at(a, c) - before));
      to.simulation.state.velocity.set(b, c, from.simulation.state.velocity.at(a, c));
    }
    engine.memo.blockHistory[b] = engine.memo.blockHistory[a];
  }
  PairTable& pairs = engine.pairs;
  for (std::size_t i = 0; i < to.pairs.size(); ++i) {
    const auto p = static_cast<std::size_t>(from.pairs[i]);
    const auto q = static_cast<std::size_t>(to.pairs[i]);
    pairs.phase[q] = pairs.phase[p];
    pairs.clearance[q] = pairs.clearance[p];
    pairs.travelAtCheck[q] = pairs.travelAtCheck[p];
    pairs.setAxis(q, pairs.axisOf(p));
    if (!pairs.touches(p)) continue;
    Manifold manifold = copyOf(contactOf(engine, p));
    manifold.upper = manifold.upper == pairs.key[p].a ? pairs.key[q].a : pairs.key[q].b;
    if (pairs.contact[q] < 0) pairs.contact[q] = engine.contacts.take();
    engine.contacts.store(pairs.contact[q], pairs[q], manifold);
  }
}

}  // namespace springtower
