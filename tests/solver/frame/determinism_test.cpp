#include "core/error.h"
#include "core/random.h"
#include "core/scene/scene.h"
#include "core/tuning.h"
#include "scenarios/registry.h"
#include "scenarios/towers.h"
#include "solver/contact/query.h"
#include "solver/frame/over_islands.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"
#include "tests/support/uneven_tower.h"

#include <algorithm>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <string>

namespace springtower {
namespace {

// Hash of the state after some frames on a number of threads. The arena has that many threads even if the machine has fewer
// cores.
std::uint64_t hashAfter(
    const Scene& scene, int frames, int threads, const std::function<void(const Simulation&)>& look = [](const Simulation&) {}) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute([&] {
    Simulation simulation(scene);
    for (int frame = 0; frame < frames; ++frame) prepareAndStep(simulation);
    look(simulation);
    return stateHash(simulation);
  });
}

// All hashes are compared bit for bit: the result must not depend on the number of threads.
void expectSameOnAnyThreads(const Scene& scene, int frames) {
  const std::uint64_t one = hashAfter(scene, frames, 1);
  EXPECT_EQ(hashAfter(scene, frames, 1), one) << "twice in one process";
  EXPECT_EQ(hashAfter(scene, frames, 2), one);
  EXPECT_EQ(hashAfter(scene, frames, 4), one);
}

// Many islands, which run in parallel.
Scene manyTowers() {
  return grid(unevenTower(2), 10, 10, 0.2);
}

// A thousand blocks, each rotated at random by up to `mostTurn`, in a lattice without overlap. All move towards the axis and the
// floor, the faster the farther away they are, so that each collides with its neighbours within a few frames.
Scene pile(double mostTurn, double inwards_hz) {
  RandomStream random(7, 0);
  const auto signedUnit = [&] { return 2.0 * random.uniform() - 1.0; };
  std::vector<BlockSpec> blocks(1000);
  Vec3 cell = Vec3::Zero();  // the largest bounding box of any block
  for (BlockSpec& block : blocks) {
    Vec3 axis(signedUnit(), signedUnit(), signedUnit());
    while (axis.norm() < 0.1) axis = Vec3(signedUnit(), signedUnit(), signedUnit());
    block.orientation = Eigen::AngleAxisd(mostTurn * random.uniform(), axis.normalized());
    cell = cell.cwiseMax(block.orientation.toRotationMatrix().cwiseAbs() * block.dimensions);
  }
  cell *= 1.001;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Vec3 place(static_cast<double>(b % 10), static_cast<double>(b / 10 % 10), static_cast<double>(b / 100));
    blocks[b].centre = cell.cwiseProduct(place - Vec3(4.5, 4.5, -0.5));
    blocks[b].velocity = -inwards_hz * blocks[b].centre;
  }
  Scene scene;
  scene.name = "a pile";
  scene.blocks = blocks;
  return scene;
}

TEST(Determinism, OneTowerIsTheSameOnAnyThreads) {
  expectSameOnAnyThreads(unevenTower(18), 60);
}

TEST(Determinism, ManyTowersAreTheSameOnAnyThreads) {
  const Scene scene = manyTowers();
  Simulation simulation(scene);
  prepareAndStep(simulation);
  EXPECT_EQ(simulation.engine->memo.islands.count(), 100U);
  expectSameOnAnyThreads(scene, 18);
}

// Blocks far apart in space that spin, with springs for the load of a heavy slab that hangs over all of them, the last, and a
// step that is far too long for the light ones: all light ones diverge in the first frame, each an island of its own.
Scene divergingBlocks() {
  constexpr int kBlocks = 15;
  Scene scene;
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  scene.settings.method = Method::semiImplicitEuler;
  scene.settings.substeps = 60;
  scene.settings.tolerance_m = kBlockTolerance_m;
  scene.settings.allowUnstable = true;
  for (int b = 0; b < kBlocks; ++b) {
    BlockSpec block;
    block.centre = Vec3(static_cast<double>(b), 0.0, 0.0);
    block.spin = Vec3(10.0, 20.0, 30.0);
    scene.blocks.push_back(block);
  }
  BlockSpec slab;
  slab.dimensions = Vec3(2.0 * kBlocks, 1.0, 1.0);
  slab.centre = Vec3(0.5 * kBlocks, 0.0, 10.0);
  slab.mass = 1000.0 * kBlockMass_kg;
  scene.blocks.push_back(slab);
  return scene;
}

// The message with which the first frame of a scene fails on a number of threads; empty where it does not.
std::string messageOfFirstFrame(const Scene& scene, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute([&]() -> std::string {
    Simulation simulation(scene);
    try {
      prepareAndStep(simulation);
    } catch (const DivergenceError& error) {
      return error.what();
    }
    return {};
  });
}

TEST(Determinism, OfIslandsThatDivergeInOneFrameTheFirstIsNamedOnAnyThreads) {
  constexpr int kRuns = 200;  // which island comes first on several threads is chance: another one does in one run of 200 or so
  const Scene scene = divergingBlocks();
  for (std::size_t b = 0; b + 1 < scene.blocks.size(); ++b) {
    Scene one = scene;
    one.blocks = {scene.blocks[b], scene.blocks.back()};
    EXPECT_THAT(messageOfFirstFrame(one, 1), testing::StartsWith("block 0 diverged at ")) << "block " << b << " alone";
  }
  const std::string message = messageOfFirstFrame(scene, 1);
  EXPECT_THAT(message, testing::StartsWith("block 0 diverged at "));
  for (int run = 0; run < kRuns; ++run) EXPECT_EQ(messageOfFirstFrame(scene, 4), message) << "run " << run;
}

// Counters of a scene of one wide island on one thread; the state on two and four threads must be the same.
Counters sameInOneLargeIsland(const Scene& scene, int frames) {
  Counters counters;
  const std::uint64_t one = hashAfter(scene, frames, 1, [&](const Simulation& simulation) {
    const Islands& islands = simulation.engine->memo.islands;
    ASSERT_EQ(islands.count(), 1U) << "all are connected";
    EXPECT_EQ(islands.island(0).size(), scene.blocks.size());
    EXPECT_GE(scene.blocks.size(), tuning::kParallelBlocks) << "so that its kernels run on many threads";
    counters = simulation.counters;
  });
  EXPECT_EQ(hashAfter(scene, frames, 2), one);
  EXPECT_EQ(hashAfter(scene, frames, 4), one);
  return counters;
}

// Large rotations, high speeds, and contacts soft enough for few explicit steps: the comparison is of bits.
TEST(Determinism, ASoftPileIsTheSameOnAnyThreads) {
  Scene scene = pile(0.3, 4.0);
  scene.settings.method = Method::semiImplicitEuler;
  scene.settings.substeps = 40;
  const Counters counters = sameInOneLargeIsland(scene, 3);
  EXPECT_GT(counters.contactsCreated, scene.blocks.size()) << "two blocks to a contact: each has met two";
}

// Default settings of users: the default method and tolerance, which require 500 to 900 steps a frame while a thousand blocks
// collide. A block is rotated by a degree at most and collides with its neighbours within these five frames: three runs of some 4
// s of CPU time each. Blocks as fast as those above would require thousands of steps, half a minute of CPU time a frame.
TEST(Determinism, APileIsTheSameOnAnyThreads) {
  const Scene scene = pile(0.02, 0.5);
  ASSERT_EQ(scene.settings.method, Method::implicit);
  const Counters counters = sameInOneLargeIsland(scene, 5);
  EXPECT_GT(counters.contactsCreated, 3U * scene.blocks.size()) << "each has met most of those around it, at several points";
  EXPECT_EQ(counters.contactsCreatedPenetrating, 0U);
}

struct Resting {
  Scene scene;
  int frames;
  const char* name;
};

class RestingTest : public ::testing::TestWithParam<Resting> {};

// A scene at rest is stepped implicitly in every frame, while gravity sways it twice a second: too little to open contacts,
// enough to bend it. (At 0.1 degrees two of the towers that touch meet at speed in a frame of 40: impulses are for that.)
TEST_P(RestingTest, ALargeIslandIsTheSameOnAnyThreads) {
  Scene scene = GetParam().scene;
  ASSERT_EQ(scene.settings.method, Method::implicit);
  scene.settings.sleep = Sleep::off;
  scene.gravity.sway_deg = 0.07;
  scene.gravity.sway_hz = 2.0;
  const Counters counters = sameInOneLargeIsland(scene, GetParam().frames);
  EXPECT_GE(counters.implicitSteps, counters.frames);
  EXPECT_GT(counters.implicitIterations, counters.implicitSteps) << "they had something to solve";
  EXPECT_EQ(counters.newtonFailures, 0U) << "no step was left to explicit ones";
}

INSTANTIATE_TEST_SUITE_P(Determinism, RestingTest,
                         ::testing::Values(Resting{towerScene(90), 60, "OneTallTower"},
                                           Resting{touchingTowersScene(5), 20, "TouchingTowers"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

class SnapshotTest : public ::testing::TestWithParam<Method> {};

void step(Simulation& simulation, std::uint64_t frames) {
  for (std::uint64_t frame = 0; frame < frames; ++frame) prepareAndStep(simulation);
}

// A snapshot of frame `taken` reproduces the state of frame `end`, however often and in whichever simulation it is restored.
// Returns the counters between the two.
Counters expectSameFuture(const Scene& scene, std::uint64_t taken, std::uint64_t end) {
  Simulation undisturbed(scene);
  step(undisturbed, end);

  Simulation simulation(scene);
  step(simulation, taken);
  EXPECT_EQ(std::count(simulation.asleep.begin(), simulation.asleep.end(), std::uint8_t{1}), 0);
  const auto snapshot = takeSnapshot(simulation);
  const std::uint64_t then = stateHash(simulation);
  const Counters before = simulation.counters;
  step(simulation, end - taken);
  EXPECT_EQ(stateHash(simulation), stateHash(undisturbed)) << "taking a snapshot changes nothing";
  EXPECT_NE(stateHash(simulation), then);
  step(simulation, 3);
  for (int repeat = 0; repeat < 2; ++repeat) {
    restoreSnapshot(simulation, *snapshot);
    EXPECT_EQ(stateHash(simulation), then);
    EXPECT_EQ(simulation.frame, taken);
    step(simulation, end - taken);
    EXPECT_EQ(stateHash(simulation), stateHash(undisturbed));
    EXPECT_EQ(simulation.counters.steps, undisturbed.counters.steps);
    EXPECT_EQ(simulation.counters.implicitIterations, undisturbed.counters.implicitIterations);
    EXPECT_EQ(simulation.time_s, undisturbed.time_s);
  }
  // Restoring into another simulation of the scene works as well.
  Simulation other(scene);
  restoreSnapshot(other, *snapshot);
  step(other, end - taken);
  EXPECT_EQ(stateHash(other), stateHash(undisturbed));
  Counters between;
  between.implicitSteps = simulation.counters.implicitSteps - before.implicitSteps;
  between.implicitIterations = simulation.counters.implicitIterations - before.implicitIterations;
  between.newtonFailures = simulation.counters.newtonFailures - before.newtonFailures;
  return between;
}

// Rows that drop from 4 mm: they land at 29 ms, so half a second contains impacts and settling. The snapshot is taken between
// them.
TEST_P(SnapshotTest, ARestoredFallRepeatsItsFuture) {
  TowerOptions options;
  options.startGap_m = 0.004;
  options.heightsSigma_m = 0.0002;
  Scene scene = towerScene(3, options);
  scene.settings.method = GetParam();
  expectSameFuture(scene, 5, 30);
}

// Gravity sways and the middle block of the middle row is pushed, so that it slides under the blocks on it; the snapshot is taken
// while both continue. All of these frames have implicit steps, which have a history to restore.
TEST_P(SnapshotTest, ARestoredSwayRepeatsItsFuture) {
  Scene scene = bitCodeScene("(101)-(111)-(101)");
  scene.settings.method = GetParam();
  scene.gravity.sway_deg = 0.5;
  scene.gravity.sway_hz = 2.0;
  scene.forces.push_back(constantForce(3, -1, Vec3(0.0, 0.2, 0.0), 0.1, 0.3));
  const Counters between = expectSameFuture(scene, 10, 25);
  if (isImplicit(GetParam())) {
    EXPECT_GE(between.implicitSteps, 15U) << "in each frame";
    EXPECT_GT(between.implicitIterations, between.implicitSteps) << "friction that slides turns with what slides";
    EXPECT_EQ(between.newtonFailures, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, SnapshotTest,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::implicitEigen,
                                           Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4, Method::report,
                                           Method::rigidPgs, Method::rigidLcp, Method::xpbd),
                         [](const auto& tested) {
                           std::string name(nameOf(tested.param));
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// Sleep is part of the state: after restoring a snapshot of a sleeping tower it sleeps, whatever the state of the simulation
// before.
TEST(Snapshot, KeepsSleep) {
  const Scene scene = towerScene(2);
  Simulation simulation(scene);
  for (int frame = 0; frame < 240; ++frame) prepareAndStep(simulation);
  ASSERT_EQ(std::count(simulation.asleep.begin(), simulation.asleep.end(), std::uint8_t{1}), 6);
  const auto snapshot = takeSnapshot(simulation);
  Simulation awake(scene);
  for (int frame = 0; frame < 3; ++frame) prepareAndStep(awake);
  restoreSnapshot(awake, *snapshot);
  EXPECT_EQ(stateHash(awake), stateHash(simulation));
  prepareAndStep(awake);
  EXPECT_EQ(awake.substeps, 0);
  EXPECT_EQ(stateHash(awake), stateHash(simulation));
}

// What decides whether a frame of implicit steps is kept: sums over a wide island, equal bit for bit however threads share them.
TEST(Determinism, TheEnergyOfAWideIslandIsTheSameOnAnyThreads) {
  Scene scene = sceneNamed("heap:300");
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  for (int frame = 0; frame < 90; ++frame) prepareAndStep(simulation);
  const Islands& islands = simulation.engine->memo.islands;
  std::size_t widest = 0;
  for (std::size_t i = 1; i < islands.count(); ++i) {
    if (islands.island(i).size() > islands.island(widest).size()) widest = i;
  }
  ASSERT_GE(islands.island(widest).size(), static_cast<std::size_t>(tuning::kParallelBlocks));
  const auto energyOn = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return islandEnergy(islandStep(simulation, contactLaw(simulation), widest)); });
  };
  const IslandEnergy one = energyOn(1);
  EXPECT_GT(one.total_j, one.kinetic_j);
  for (int round = 0; round < 20; ++round) {
    for (const int threads : {2, 3, 4}) {
      const IslandEnergy many = energyOn(threads);
      EXPECT_EQ(many.kinetic_j, one.kinetic_j);
      EXPECT_EQ(many.total_j, one.total_j);
    }
  }
}

}  // namespace
}  // namespace springtower
