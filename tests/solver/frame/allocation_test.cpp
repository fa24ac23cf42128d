// A frame does not allocate once its buffers have grown, and the memory of a scene stays within bounds.
#include "core/tuning.h"
#include "solver/runner/run.h"
#include "solver/world/memory_use.h"
#include "solver/world/simulation.h"
#include "tests/support/allocations.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <cstdlib>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <memory>
#include <oneapi/tbb/global_control.h>
#include <string>
#include <vector>

namespace springtower {
namespace {

TEST(Allocations, AreCounted) {
  const long before = allocationsOfThisThread();
  const auto one = std::make_unique<int>(1);
  void* const two = std::malloc(100);
  EXPECT_NE(two, nullptr);
  std::free(two);
  const std::vector<double> three(10);
  EXPECT_EQ(allocationsOfThisThread() - before, 3);
  EXPECT_EQ(three.size(), 10U + static_cast<std::size_t>(*one) - 1U);
}

struct Case {
  std::string name;
  int rows = 18;
  double tilt_deg = 0.0;
  double heightsSigma_m = 0.0;
  double pull_n = 0.0;
  Method method = Settings{}.method;
  Sleep sleep = Sleep::off;
  int frames = 40;
  double tolerance_m = 5e-4;
};

class AllocationTest : public ::testing::TestWithParam<Case> {};

// Frames that have run once run again without an allocation: no buffer is created anew in a frame or step. Restoring the state
// keeps the capacity of the buffers.
TEST_P(AllocationTest, NoneWhenFramesRunAgain) {
  const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
  const Case& what = GetParam();
  Scene scene = towerScene(what.rows, {.heightsSigma_m = what.heightsSigma_m});
  scene.gravity.tilt_deg = what.tilt_deg;
  scene.settings.method = what.method;
  scene.settings.sleep = what.sleep;
  scene.settings.tolerance_m = what.tolerance_m;
  if (what.pull_n > 0.0) {
    const int middle = 3 * (what.rows / 2) + 1;
    scene.forces.push_back(
        {middle, -1, what.pull_n * (scene.blocks[static_cast<std::size_t>(middle)].orientation * Vec3::UnitX()), 0.1, 1.0});
  }
  Simulation simulation(scene);
  prepareAndStep(simulation);
  const auto snapshot = takeSnapshot(simulation);
  for (int frame = 0; frame < what.frames; ++frame) prepareAndStep(simulation);
  const std::uint64_t hash = stateHash(simulation);

  restoreSnapshot(simulation, *snapshot);
  const long before = allocationsOfThisThread();
  for (int frame = 0; frame < what.frames; ++frame) prepareAndStep(simulation);
  EXPECT_EQ(allocationsOfThisThread() - before, 0);
  EXPECT_EQ(stateHash(simulation), hash);
}

INSTANTIATE_TEST_SUITE_P(Frames, AllocationTest,
                         ::testing::Values(Case{.name = "Rest"}, Case{.name = "UnevenHeights", .heightsSigma_m = 0.0002},
                                           Case{.name = "Pull", .pull_n = 2.0},
                                           Case{.name = "Collapse", .tilt_deg = 14.5, .frames = 60},
                                           Case{.name = "FineCollapse", .tilt_deg = 14.5, .frames = 90, .tolerance_m = 2.57e-5},
                                           Case{.name = "Collapse130um", .tilt_deg = 14.5, .frames = 90, .tolerance_m = 1.3e-4},
                                           Case{.name = "Collapse290um", .tilt_deg = 14.5, .frames = 90, .tolerance_m = 2.9e-4},
                                           Case{.name = "FallingAsleep", .rows = 3, .sleep = Sleep::on, .frames = 300},
                                           Case{.name = "Explicit", .tilt_deg = 14.5, .method = Method::semiImplicitEuler},
                                           Case{.name = "Midpoint", .rows = 3, .method = Method::midpoint, .frames = 5},
                                           Case{.name = "RungeKutta4", .rows = 3, .method = Method::rungeKutta4, .frames = 5},
                                           Case{.name = "Report", .rows = 3, .method = Method::report, .frames = 5},
                                           Case{.name = "RigidPgs", .tilt_deg = 14.5, .method = Method::rigidPgs},
                                           Case{.name = "RigidLcp", .rows = 2, .method = Method::rigidLcp, .frames = 5},
                                           Case{.name = "Xpbd", .tilt_deg = 14.5, .method = Method::xpbd},
                                           // More blocks than tuning::kParallelBlocks: kernels run in ranges.
                                           Case{.name = "LargeIsland", .rows = 90}),
                         [](const auto& one) { return one.param.name; });

// Bytes a block of the settled tower of 18 rows. The bounds are the measured values plus a tenth.
TEST(MemoryUse, OfABlockOfTheTower) {
  Simulation simulation(towerScene(18));
  stepFor(simulation, 0.5);
  const MemoryUse use = memoryUse(simulation);
  const auto blocks = static_cast<double>(simulation.model.blockCount());
  const auto each = [&](std::size_t bytes) { return static_cast<double>(bytes) / blocks; };
  fmt::print("bytes a block: state {:.0f}, springs and masses {:.0f}, contacts {:.0f}, factor {:.0f}, working space {:.0f}\n",
             each(use.state), each(use.model), each(use.contacts), each(use.factor), each(use.working));
  RecordProperty("state_bytes", fmt::format("{:.0f}", each(use.state)));
  // Eight corners with three coordinates and velocities, a flag and a time.
  EXPECT_EQ(each(use.state), 8 * 6 * 8 + 1 + 8);
  // The block of the scene, three sizes, a mass, and three numbers for each of seven groups of springs.
  EXPECT_EQ(each(use.model), sizeof(BlockSpec) + 3 * 8 + 8 + 7 * 3 * 8);
  EXPECT_GT(each(use.contacts), 500.0);
  EXPECT_LT(each(use.contacts), 1410.0);
  EXPECT_LT(each(use.factor), 3120.0);
  EXPECT_LT(each(use.working), 4280.0);
  EXPECT_EQ(use.total(), use.state + use.model + use.contacts + use.factor + use.working);
}

// Eigen's factors in double are stored in addition to the assembled matrix.
TEST(MemoryUse, CountsEigensFactors) {
  const auto factorOf = [](Method method) {
    Scene scene = towerScene(6);
    scene.settings.method = method;
    Simulation simulation(scene);
    stepFor(simulation, 0.1);
    return memoryUse(simulation).factor;
  };
  EXPECT_GT(factorOf(Method::implicitEigen), 2 * factorOf(Method::implicit));
}

// Memory does not grow with time in a scene at rest, nor faster than the number of blocks.
TEST(MemoryUse, GrowsWithTheBlocksAlone) {
  Simulation small(towerScene(6));
  Simulation large(towerScene(24));
  stepFor(small, 0.2);
  stepFor(large, 0.2);
  const std::size_t early = memoryUse(large).total();
  EXPECT_LT(static_cast<double>(early), 1.15 * 4.0 * static_cast<double>(memoryUse(small).total()));
  stepFor(large, 0.3);
  EXPECT_LT(static_cast<double>(memoryUse(large).total()), 1.02 * static_cast<double>(early));
}

}  // namespace
}  // namespace springtower
