#include "solver/frame/prepare.h"

#include "core/error.h"
#include "scenarios/towers.h"
#include "solver/metrics/balance.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"

#include <algorithm>
#include <chrono>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <span>
#include <thread>
#include <vector>

namespace springtower {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::uint64_t hashPrepared(const Scene& scene, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  Simulation simulation(scene);
  prepare(simulation);
  return stateHash(simulation);
}

// A tower of 36 rows that comes to lie so far from where it was placed that it leaves its swept boxes.
Scene leaningTower(std::uint64_t seed) {
  TowerOptions options;
  options.heightsSigma_m = 0.0002;
  options.seed = seed;
  return towerScene(36, options);
}

TEST(Prepare, AFrameIsRefusedBefore) {
  Simulation simulation(towerScene(2));
  EXPECT_THAT([&] { stepFrame(simulation); }, ThrowsMessage<InputError>(HasSubstr("not prepared")));
  prepare(simulation);
  stepFrame(simulation);
  EXPECT_EQ(simulation.frame, 1U);
}

// After the search, contact and spring forces carry every block's weight before a frame has passed.
TEST(Prepare, ForcesBalanceWeights) {
  Simulation simulation(towerScene(18));
  const PrepareResult done = prepare(simulation);
  EXPECT_EQ(done.end, PrepareEnd::complete);
  EXPECT_EQ(done.blocks, 54U);
  EXPECT_EQ(done.blocksInBalance, 54U);
  EXPECT_EQ(simulation.frame, 0U);
  const Imbalance worst = largestImbalance(imbalances(simulation, contactForces(simulation)));
  EXPECT_LT(worst.force, 1e-3) << "of a block's weight";
}

// The top of an uneven tower of 36 rows comes to lie up to a height of a block from where it was placed, in three of four farther
// than its swept box reaches at first: the search goes on with a larger one. Let go as placed, such towers come to rest 0.2 to
// 0.3 mm deep.
TEST(Prepare, ATallUnevenTowerLeansFarIntoItsEquilibrium) {
  for (const std::uint64_t seed : {2U, 4U, 5U, 6U}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Scene scene = leaningTower(seed);
    scene.settings.sleep = Sleep::off;
    Simulation simulation(scene);
    const Vec3 placed = centre(simulation.state.position, 107);
    const double margin_m = simulation.engine->memo.sweepMargin[107];
    const PrepareResult done = prepare(simulation);
    EXPECT_EQ(done.blocks, 108U);
    EXPECT_EQ(done.blocksInBalance, 108U);
    const Vec3 found = centre(simulation.state.position, 107);
    EXPECT_GT((found - placed).norm(), 0.4 * simulation.lengths.blockHeight_m);
    const bool hasGrown = simulation.engine->memo.sweepMargin[107] > 3.9 * margin_m;
    EXPECT_EQ(hasGrown, seed != 6U) << "its boxes; those of seed 6 reach far enough at first";
    for (int frame = 0; frame < 60; ++frame) stepFrame(simulation);
    EXPECT_LT((centre(simulation.state.position, 107) - found).norm(), simulation.tolerance_m);
    PenetrationWorkspace workspace;
    EXPECT_LE(maxPenetration(simulation.state.position, simulation.scene.floor, workspace).depth, 2.0 * simulation.tolerance_m);
  }
}

// Of equal ones it is still found once: two beside one another are in equilibrium after as many iterations as one, the same to
// within rounding.
TEST(Prepare, EqualTallUnevenTowersLeanAlike) {
  Scene scene = leaningTower(2);
  Simulation one(scene);
  prepare(one);
  const Vec3 aside(0.4, 0.0, 0.0);
  for (std::size_t b = 0; b < 108; ++b) {
    BlockSpec block = scene.blocks[b];
    block.centre += aside;
    scene.blocks.push_back(block);
  }
  Simulation simulation(scene);
  EXPECT_EQ(prepare(simulation).blocksInBalance, 216U);
  EXPECT_LT(simulation.counters.implicitIterations, 3 * one.counters.implicitIterations / 2)
      << "twice as many if each is searched";
  for (std::size_t b = 0; b < 108; ++b)
    EXPECT_LT((centre(simulation.state.position, b + 108) - centre(simulation.state.position, b) - aside).norm(), 1e-12);
}

// A stack 4 mm beside it is in none of its first boxes, but in the larger ones, with which both are one island. The stack has its
// equilibrium by then and keeps it; the tower begins as placed.
TEST(Prepare, ATowerWhoseLargerBoxesReachAStackBeginsAsPlaced) {
  Scene scene = leaningTower(2);
  const Scene stack = towerScene(2);
  double right = 0.0;
  for (const BlockSpec& block : scene.blocks) right = std::max(right, block.centre.x() + 0.5 * block.dimensions.maxCoeff());
  for (BlockSpec block : stack.blocks) {
    block.centre.x() += right + 0.5 * block.dimensions.maxCoeff() + 0.004;
    scene.blocks.push_back(block);
  }
  Simulation simulation(scene);
  const ParticleArray placed = simulation.state.position;
  const PrepareResult done = prepare(simulation);
  EXPECT_EQ(done.end, PrepareEnd::complete);
  EXPECT_EQ(done.blocks, 114U);
  EXPECT_EQ(done.blocksInBalance, 6U);
  for (std::size_t b = 0; b < 108; ++b) EXPECT_EQ(centre(simulation.state.position, b), centre(placed, b));
  const std::vector<Imbalance> forces = imbalances(simulation, contactForces(simulation));
  EXPECT_LT(largestImbalance(std::span(forces).last(6)).force, 1e-3) << "of a block's weight";
  stepFrame(simulation);
}

// Ended while it searches with larger boxes: the tower begins as placed, as if it had been ended before.
TEST(Prepare, EndedInTheSecondSearchATowerBeginsAsPlaced) {
  Simulation simulation(leaningTower(2));
  const ParticleArray placed = simulation.state.position;
  const double margin_m = simulation.engine->memo.sweepMargin[107];
  const auto hasGrown = [&] { return simulation.engine->memo.sweepMargin[107] > 3.9 * margin_m; };
  const PrepareResult done =
      prepare(simulation, {.goesOn = [&](const PrepareProgress&) {
                std::this_thread::sleep_for(std::chrono::milliseconds(101));  // to be asked at each iteration
                return !hasGrown();
              }});
  EXPECT_EQ(done.end, PrepareEnd::cancelled);
  EXPECT_TRUE(hasGrown());
  EXPECT_EQ(done.blocks, 108U);
  EXPECT_EQ(done.blocksInBalance, 0U);
  for (std::size_t b = 0; b < 108; ++b) EXPECT_EQ(centre(simulation.state.position, b), centre(placed, b));
  stepFrame(simulation);
}

TEST(Prepare, ASecondCallDoesNothing) {
  Simulation simulation(towerScene(6));
  prepare(simulation);
  const std::uint64_t hash = stateHash(simulation);
  EXPECT_EQ(prepare(simulation).blocks, 0U);
  EXPECT_EQ(stateHash(simulation), hash);
}

TEST(Prepare, TheSameBitsOnAnyNumberOfThreads) {
  for (const Scene& scene : {towerScene(18), towerScene(100), leaningTower(2)})
    EXPECT_EQ(hashPrepared(scene, 1), hashPrepared(scene, 4));
}

// Every method whose contacts have stiffness starts from the same equilibrium.
TEST(Prepare, ExplicitMethodsStartFromItToo) {
  Scene scene = towerScene(6);
  Simulation implicit(scene);
  prepare(implicit);
  scene.settings.method = Method::semiImplicitEuler;
  Simulation explicitSteps(scene);
  EXPECT_EQ(prepare(explicitSteps).blocksInBalance, 18U);
  for (std::size_t b = 0; b < 18; ++b) {
    for (std::size_t c = 0; c < kCorners; ++c)
      EXPECT_LT((implicit.state.position.at(b, c) - explicitSteps.state.position.at(b, c)).norm(), 1e-9);
  }
}

TEST(Prepare, WithoutTimeBlocksStayAsPlaced) {
  Simulation simulation(towerScene(18));
  const Vec3 placed = simulation.state.position.at(53, 7);
  const PrepareResult done = prepare(simulation, {.budget_s = 0.0});
  EXPECT_EQ(done.end, PrepareEnd::outOfTime);
  EXPECT_EQ(done.blocksInBalance, 0U);
  EXPECT_EQ(simulation.state.position.at(53, 7), placed);
}

// The caller is told how far the search is, and ends it where it is.
TEST(Prepare, EndsWhereTheCallerWantsIt) {
  Simulation simulation(towerScene(100));
  std::vector<PrepareProgress> heard;
  const PrepareResult done = prepare(simulation, {.goesOn = [&](const PrepareProgress& now) {
                                       heard.push_back(now);
                                       return false;
                                     }});
  EXPECT_EQ(done.end, PrepareEnd::cancelled);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard.front().blocks, 300U);
  EXPECT_EQ(heard.front().blocksDone, 0U);
}

// Nor is the caller who takes long to answer called again.
TEST(Prepare, WhoHasEndedItIsNotCalledAgain) {
  Simulation simulation(towerScene(100));
  int calls = 0;
  prepare(simulation, {.goesOn = [&](const PrepareProgress&) {
            ++calls;
            std::this_thread::sleep_for(std::chrono::milliseconds(150));
            return false;
          }});
  EXPECT_EQ(calls, 1);
}

TEST(Prepare, RefusesANegativeBudget) {
  Simulation simulation(towerScene(1));
  EXPECT_THAT([&] { prepare(simulation, {.budget_s = -1.0}); },
              ThrowsMessage<InputError>(HasSubstr("expected a budget of 0 s or more, got -1 s")));
  EXPECT_FALSE(isPrepared(simulation));
}

}  // namespace
}  // namespace springtower
