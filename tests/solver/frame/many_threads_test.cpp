// From one thread to many more than there are processors: the same bits, and no collapse of speed.
#include "core/processor_time.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"
#include "solver/frame/prepare.h"
#include "solver/world/simulation.h"
#include "tests/support/two_walls.h"
#include "tests/support/uneven_tower.h"

#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <string>
#include <utility>
#include <vector>

namespace springtower {
namespace {

constexpr int kThreadCounts[] = {1, 2, 3, 5, 8, 16, 32, 64};
constexpr int kFramesOnThreads = 6;
constexpr int kRuns = 4;

struct Timed {
  std::uint64_t hash = 0;
  std::uint64_t looked = 0;  // contacts created and manifolds looked for again
  double processor_s = 0.0;  // of all frames, on all threads
};

// On as many threads as given, also where the machine has fewer processors.
Timed timedOn(const Scene& scene, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute([&] {
    Timed timed;
    Simulation simulation(scene);
    prepare(simulation);
    stepFrame(simulation);
    const double before_s = processorTime_s();
    for (int frame = 0; frame < kFramesOnThreads; ++frame) stepFrame(simulation);
    timed.processor_s = processorTime_s() - before_s;
    timed.hash = stateHash(simulation);
    timed.looked = simulation.counters.contactsCreated + simulation.counters.manifoldRefreshes;
    return timed;
  });
}

// The same with the least time of several runs: a run takes some milliseconds, and what else the machine does adds to it.
Timed leastTimedOn(const Scene& scene, int threads) {
  Timed least = timedOn(scene, threads);
  for (int run = 1; run < kRuns; ++run) {
    const Timed again = timedOn(scene, threads);
    EXPECT_EQ(again.hash, least.hash) << threads << " threads, run " << run;
    least.processor_s = std::min(least.processor_s, again.processor_s);
  }
  return least;
}

// A wide island that sways, two of them, and towers that fall, each an island of its own.
std::vector<std::pair<std::string, Scene>> wideAndMany() {
  return {{"wall that sways", awake(swaying(wallScene(24, 16), 0.3, 2.0))},
          {"two walls that sway", awake(swaying(twoWalls(), 0.3, 2.0))},
          {"towers that fall", awake(leaning(grid(unevenTower(4), 4, 2, kTowerSpacing_m), 30.0))}};
}

// Processor time is compared: that of the wall is also that of whatever else the machine does. Threads that wait for each other
// in a loop, or move what others have in their caches, cost of it.
TEST(ManyThreads, SixtyFourAreAsGoodAsOne) {
  constexpr double kMostSlower = 3.0;
  for (const auto& [name, scene] : wideAndMany()) {
    const Timed one = leastTimedOn(scene, 1);
    for (const int threads : kThreadCounts) {
      const Timed many = leastTimedOn(scene, threads);
      EXPECT_EQ(many.hash, one.hash) << name << ", " << threads << " threads";
      EXPECT_EQ(many.looked, one.looked) << name << ", " << threads << " threads";
      EXPECT_LT(many.processor_s, kMostSlower * one.processor_s) << name << ", " << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace springtower
