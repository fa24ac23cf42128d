#include "core/random.h"
#include "core/scene.h"
#include "solver/engine.h"
#include "solver/simulation.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

// The state after some frames on a number of threads. The arena asks for as many even where the machine has fewer cores.
std::uint64_t hashAfter(const Scene& scene, int frames, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute([&] {
    Simulation simulation(scene);
    for (int frame = 0; frame < frames; ++frame) stepFrame(simulation);
    return stateHash(simulation);
  });
}

// All hashes are compared bit for bit: there is no tolerance in "the same result on any machine's cores".
void expectSameOnAnyThreads(const Scene& scene, int frames) {
  const std::uint64_t one = hashAfter(scene, frames, 1);
  EXPECT_EQ(hashAfter(scene, frames, 1), one) << "twice in one process";
  EXPECT_EQ(hashAfter(scene, frames, 2), one);
  EXPECT_EQ(hashAfter(scene, frames, 4), one);
}

Scene unevenTower(int rows) {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  options.seed = 3;
  return towerScene(rows, options);
}

// Many islands: they run side by side.
Scene manyTowers() {
  const Scene one = unevenTower(2);
  Scene scene = one;
  scene.blocks.clear();
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) {
      for (BlockSpec block : one.blocks) {
        block.centre += Vec3(0.2 * x, 0.2 * y, 0.0);
        scene.blocks.push_back(block);
      }
    }
  }
  scene.name = "100 towers";
  return scene;
}

constexpr int kPileFrames = 3;

// A thousand blocks, each turned at random by up to 17 degrees, in a lattice without overlap. Lower ones fall more slowly and all
// move towards the axis, so that each meets its neighbours within a few frames.
Scene pile() {
  constexpr double kInwards_hz = 4.0;
  RandomStream random(7, 0);
  const auto signedUnit = [&] { return 2.0 * random.uniform() - 1.0; };
  std::vector<BlockSpec> blocks(1000);
  Vec3 cell = Vec3::Zero();  // the largest bounding box of any block
  for (BlockSpec& block : blocks) {
    Vec3 axis(signedUnit(), signedUnit(), signedUnit());
    while (axis.norm() < 0.1) axis = Vec3(signedUnit(), signedUnit(), signedUnit());
    block.orientation = Eigen::AngleAxisd(0.3 * random.uniform(), axis.normalized());
    cell = cell.cwiseMax(block.orientation.toRotationMatrix().cwiseAbs() * block.dimensions);
  }
  cell *= 1.001;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Vec3 place(static_cast<double>(b % 10), static_cast<double>(b / 10 % 10), static_cast<double>(b / 100));
    blocks[b].centre = cell.cwiseProduct(place - Vec3(4.5, 4.5, -0.5));
    blocks[b].velocity = -kInwards_hz * blocks[b].centre;
  }
  Scene scene;
  scene.name = "a pile";
  scene.blocks = blocks;
  // As soft as few explicit steps ask for: what is compared are bits.
  scene.settings.method = Method::semiImplicitEuler;
  scene.settings.substeps = 40;
  return scene;
}

TEST(Determinism, OneTowerIsTheSameOnAnyThreads) {
  expectSameOnAnyThreads(unevenTower(18), 60);
}

TEST(Determinism, ManyTowersAreTheSameOnAnyThreads) {
  const Scene scene = manyTowers();
  Simulation simulation(scene);
  stepFrame(simulation);
  EXPECT_EQ(simulation.engine->islands.count(), 100U);
  expectSameOnAnyThreads(scene, 18);
}

TEST(Determinism, APileIsTheSameOnAnyThreads) {
  const Scene scene = pile();
  Simulation simulation(scene);
  std::uint64_t evaluations = 0;
  for (int frame = 0; frame < kPileFrames; ++frame) {
    evaluations = simulation.counters.contactEvaluations;
    stepFrame(simulation);
  }
  std::size_t largest = 0;
  const Islands& islands = simulation.engine->islands;
  for (std::size_t i = 0; i < islands.count(); ++i) largest = std::max(largest, islands.island(i).size());
  EXPECT_EQ(largest, scene.blocks.size()) << "one island, connected";
  EXPECT_GT(largest, kParallelBlocks) << "so that its kernels run on many threads";
  EXPECT_GT(simulation.counters.contactsBorn, scene.blocks.size()) << "two blocks to a contact: each has met two";
  EXPECT_GT(simulation.counters.contactEvaluations, evaluations);
  const std::uint64_t one = stateHash(simulation);
  EXPECT_EQ(hashAfter(scene, kPileFrames, 1), one) << "twice in one process";
  EXPECT_EQ(hashAfter(scene, kPileFrames, 2), one);
  EXPECT_EQ(hashAfter(scene, kPileFrames, 4), one);
}

class SnapshotTest : public ::testing::TestWithParam<Method> {};

// Rows that drop from 4 mm: they meet at 29 ms, so that half a second holds impacts and settling. The snapshot is taken among
// them.
TEST_P(SnapshotTest, ARestoredSimulationRepeatsItsFuture) {
  TowerOptions options;
  options.startGap_m = 0.004;
  options.heightsSigma_m = 0.0002;
  Scene scene = towerScene(3, options);
  scene.settings.method = GetParam();
  const auto step = [](Simulation& simulation, int frames) {
    for (int frame = 0; frame < frames; ++frame) stepFrame(simulation);
  };
  Simulation undisturbed(scene);
  step(undisturbed, 30);

  Simulation simulation(scene);
  step(simulation, 5);
  const auto snapshot = takeSnapshot(simulation);
  const std::uint64_t then = stateHash(simulation);
  step(simulation, 25);
  EXPECT_EQ(stateHash(simulation), stateHash(undisturbed)) << "taking a snapshot changes nothing";
  EXPECT_NE(stateHash(simulation), then);
  step(simulation, 3);
  for (int repeat = 0; repeat < 2; ++repeat) {
    restoreSnapshot(simulation, *snapshot);
    EXPECT_EQ(stateHash(simulation), then);
    EXPECT_EQ(simulation.frame, 5U);
    step(simulation, 25);
    EXPECT_EQ(stateHash(simulation), stateHash(undisturbed));
    EXPECT_EQ(simulation.counters.steps, undisturbed.counters.steps);
    EXPECT_EQ(simulation.time_s, undisturbed.time_s);
  }
  // The state of another simulation of the scene is taken over just as well.
  Simulation other(scene);
  restoreSnapshot(other, *snapshot);
  step(other, 25);
  EXPECT_EQ(stateHash(other), stateHash(undisturbed));
}

INSTANTIATE_TEST_SUITE_P(Methods, SnapshotTest,
                         ::testing::Values(Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4, Method::report,
                                           Method::rigidPgs, Method::xpbd));

// Sleep is part of a state: a snapshot of a sleeping tower sleeps, whatever the simulation that takes it over was doing.
TEST(Snapshot, KeepsSleep) {
  const Scene scene = towerScene(2);
  Simulation simulation(scene);
  for (int frame = 0; frame < 240; ++frame) stepFrame(simulation);
  ASSERT_EQ(std::count(simulation.asleep.begin(), simulation.asleep.end(), std::uint8_t{1}), 6);
  const auto snapshot = takeSnapshot(simulation);
  Simulation awake(scene);
  for (int frame = 0; frame < 3; ++frame) stepFrame(awake);
  restoreSnapshot(awake, *snapshot);
  EXPECT_EQ(stateHash(awake), stateHash(simulation));
  stepFrame(awake);
  EXPECT_EQ(awake.substeps, 0);
  EXPECT_EQ(stateHash(awake), stateHash(simulation));
}

}  // namespace
}  // namespace springtower
