// The broadphase on one tower of 54 blocks, 10 towers and 100 towers, on a square grid. Items are awake blocks.

#include "broadphase/islands.h"
#include "broadphase/sort_and_sweep.h"
#include "broadphase/swept_boxes.h"
#include "core/scene/scene.h"
#include "core/state.h"
#include "scenarios/towers.h"

#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace springtower {
namespace {

constexpr int kRows = 18;
constexpr int kBlocksPerTower = 3 * kRows;
constexpr double kBlockPitch_m = 0.02715;
constexpr double kFrame_s = 1.0 / 60.0;
constexpr double kMargin_m = 1e-3;

// Towers in the order of the blocks; every block is off by a small amount that depends on its number and on `variant`, so that
// two variants are two frames of a shaking field.
MotionState towers(int blocks, int variant) {
  MotionState state;
  state.resize(static_cast<std::size_t>(blocks));
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(blocks) / kBlocksPerTower)));
  for (int b = 0; b < blocks; ++b) {
    const int tower = b / kBlocksPerTower;
    const int along = tower % side;
    const int beside = tower / side;
    const int row = b % kBlocksPerTower / 3;
    const bool alongX = row % 2 == 0;
    const double across = (b % 3 - 1) * kBlockPitch_m;
    const double shake = 1e-4 * std::sin(b + 0.5 * variant);
    const Vec3 centre(along * kTowerSpacing_m + (alongX ? 0.0 : across) + shake,
                      beside * kTowerSpacing_m + (alongX ? across : 0.0) - shake, (row + 0.5) * kBlockHeight_m + shake);
    const Vec3 half =
        0.5 * Vec3(alongX ? kBlockLength_m : kBlockWidth_m, alongX ? kBlockWidth_m : kBlockLength_m, kBlockHeight_m);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 sides(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2));
      state.position.set(static_cast<std::size_t>(b), c, centre + half.cwiseProduct(sides));
      state.velocity.set(static_cast<std::size_t>(b), c, Vec3(0.0, 0.0, 100.0 * shake));
    }
  }
  return state;
}

std::vector<std::int32_t> allBlocks(std::size_t blocks) {
  std::vector<std::int32_t> all(blocks);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

SweptBoxes boxesOf(const MotionState& state) {
  const std::size_t blocks = state.position.blockCount();
  SweptBoxes boxes;
  boxes.resize(blocks);
  std::vector<double> reach(blocks);
  const std::vector<double> margins(blocks, kMargin_m);
  computeSweptBoxes(state, allBlocks(blocks), kStandardGravity_m_s2, kFrame_s, Way::onwards, margins, boxes, reach);
  return boxes;
}

void sweptBoxes(benchmark::State& run) {
  const MotionState state = towers(static_cast<int>(run.range(0)), 0);
  const std::vector<std::int32_t> all = allBlocks(state.position.blockCount());
  SweptBoxes boxes;
  boxes.resize(all.size());
  std::vector<double> reach(all.size());
  const std::vector<double> margins(all.size(), kMargin_m);
  for (auto iteration : run) {
    computeSweptBoxes(state, all, kStandardGravity_m_s2, kFrame_s, Way::onwards, margins, boxes, reach);
    benchmark::ClobberMemory();
  }
  run.SetItemsProcessed(run.iterations() * run.range(0));
}

// Two frames of a shaking field by turns, with the blocks from 0 up to `awake` awake.
void findPairsOf(benchmark::State& run, std::int64_t awake) {
  const auto blocks = static_cast<int>(run.range(0));
  const SweptBoxes frames[2] = {boxesOf(towers(blocks, 0)), boxesOf(towers(blocks, 1))};
  std::vector<std::uint8_t> asleep(static_cast<std::size_t>(blocks), 0);
  SortAndSweep sweep;
  std::vector<BlockPair> pairs;
  reset(sweep, frames[0]);
  findPairs(sweep, frames[0], asleep, pairs);
  std::fill(asleep.begin() + awake, asleep.end(), std::uint8_t{1});
  std::size_t frame = 0;
  std::uint64_t tests = 0;
  for (auto iteration : run) {
    frame ^= 1U;
    tests = findPairs(sweep, frames[frame], asleep, pairs);
    benchmark::DoNotOptimize(pairs.data());
  }
  run.SetItemsProcessed(run.iterations() * awake);
  run.counters["tests"] = static_cast<double>(tests) / static_cast<double>(awake);
  run.counters["pairs"] = static_cast<double>(pairs.size()) / static_cast<double>(awake);
}

void findPairsAllAwake(benchmark::State& run) {
  findPairsOf(run, run.range(0));
}

void findPairsOneAwake(benchmark::State& run) {
  findPairsOf(run, 1);
}

std::vector<BlockPair> touchingPairs(int blocks) {
  const SweptBoxes boxes = boxesOf(towers(blocks, 0));
  SortAndSweep sweep;
  std::vector<BlockPair> pairs;
  reset(sweep, boxes);
  findPairs(sweep, boxes, std::vector<std::uint8_t>(static_cast<std::size_t>(blocks), 0), pairs);
  return pairs;
}

// Built anew each time: the edges differ from those of the last call by their last one.
void islandsRebuilt(benchmark::State& run) {
  const std::vector<BlockPair> edges = touchingPairs(static_cast<int>(run.range(0)));
  const std::vector<std::uint8_t> asleep(static_cast<std::size_t>(run.range(0)), 0);
  Islands islands;
  std::size_t dropped = 0;
  for (auto iteration : run) {
    dropped ^= 1U;
    benchmark::DoNotOptimize(updateIslands(islands, std::span(edges).first(edges.size() - dropped), asleep));
  }
  run.SetItemsProcessed(run.iterations() * run.range(0));
}

void islandsKept(benchmark::State& run) {
  const std::vector<BlockPair> edges = touchingPairs(static_cast<int>(run.range(0)));
  const std::vector<std::uint8_t> asleep(static_cast<std::size_t>(run.range(0)), 0);
  Islands islands;
  updateIslands(islands, edges, asleep);
  for (auto iteration : run) benchmark::DoNotOptimize(updateIslands(islands, edges, asleep));
  run.SetItemsProcessed(run.iterations() * run.range(0));
}

BENCHMARK(sweptBoxes)->Arg(54)->Arg(540)->Arg(5400);
BENCHMARK(findPairsAllAwake)->Arg(54)->Arg(540)->Arg(5400);
BENCHMARK(findPairsOneAwake)->Arg(54)->Arg(540)->Arg(5400);
BENCHMARK(islandsRebuilt)->Arg(54)->Arg(540)->Arg(5400);
BENCHMARK(islandsKept)->Arg(54)->Arg(540)->Arg(5400);

}  // namespace
}  // namespace springtower
