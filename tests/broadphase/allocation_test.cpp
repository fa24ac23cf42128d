// The broadphase does not allocate once its buffers have grown.

#include "broadphase/islands.h"
#include "broadphase/sort_and_sweep.h"
#include "broadphase/swept_boxes.h"
#include "tests/support/allocations.h"
#include "tests/support/random.h"

#include <gtest/gtest.h>
#include <numeric>

namespace springtower {
namespace {

// A frame of the broadphase, on blocks that move in a loop of 40 frames, some of them asleep for a while.
struct Broadphase {
  static constexpr std::size_t kBlocks = 200;
  MotionState state;
  SweptBoxes boxes;
  std::vector<double> reach = std::vector<double>(kBlocks);
  std::vector<std::uint8_t> asleep = std::vector<std::uint8_t>(kBlocks);
  std::vector<std::int32_t> all = std::vector<std::int32_t>(kBlocks);
  SortAndSweep sweep;
  std::vector<BlockPair> pairs;
  std::vector<double> margins = std::vector<double>(kBlocks, 0.001);  // m
  Islands islands;
  std::vector<std::int32_t> parent;
  std::vector<std::uint8_t> connected = std::vector<std::uint8_t>(kBlocks);

  Broadphase() {
    Random random{SplitMix64(5)};
    state.resize(kBlocks);
    boxes.resize(kBlocks);
    std::iota(all.begin(), all.end(), 0);
    for (std::size_t b = 0; b < kBlocks; ++b) {
      const Vec3 place{random.between(0.0, 0.5), random.between(0.0, 0.5), random.between(0.0, 0.5)};
      for (std::size_t c = 0; c < kCorners; ++c) {
        state.position.set(b, c, place + 0.03 * Vec3(cornerSide(c, 0), cornerSide(c, 1), cornerSide(c, 2)));
      }
    }
    computeSweptBoxes(state, all, 9.81, 0.01, Way::onwards, margins, boxes, reach);
    reset(sweep, boxes);
  }

  std::size_t step(int frame) {
    const double direction = frame % 40 < 20 ? 0.02 : -0.02;
    for (std::size_t b = 0; b < kBlocks; ++b) {
      for (std::size_t c = 0; c < kCorners; ++c) state.position.add(b, c, Vec3::Constant(b % 3 == 0 ? direction : 0.0));
      asleep[b] = b % 3 == 1 && frame % 40 > 10 ? 1 : 0;
    }
    computeSweptBoxes(state, all, 9.81, 0.01, Way::onwards, margins, boxes, reach);
    findPairs(sweep, boxes, asleep, pairs);
    updateIslands(islands, pairs, asleep);
    connectedBlocks(pairs, std::span(all).first(1), parent, connected);
    return pairs.size();
  }
};

TEST(Allocations, NoneAfterWarmUp) {
  Broadphase broadphase;
  int frame = 0;
  std::size_t pairs = 0;
  while (frame < 120) broadphase.step(frame++);
  const long before = allocationsOfThisThread();
  while (frame < 200) pairs += broadphase.step(frame++);
  EXPECT_EQ(allocationsOfThisThread() - before, 0);
  EXPECT_GT(pairs, 1000U);
}

}  // namespace
}  // namespace springtower
