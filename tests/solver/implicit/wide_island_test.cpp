// Islands of more than 60 blocks: the matrix of an implicit step is no narrow band, and factors cost as much as dozens of
// solutions.
#include "core/scene/scene.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cstdint>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <vector>

namespace springtower {
namespace {

// Cubes of the density of the game's blocks.
Scene densePyramid(int rows) {
  const BlockSpec brick;
  return awake(cubePyramidScene(rows, brick.mass * kCubeSide_m * kCubeSide_m * kCubeSide_m / brick.dimensions.prod()));
}

double deepest(const Simulation& simulation) {
  PenetrationWorkspace workspace;
  return maxPenetration(simulation.state.position, true, workspace).depth;
}

// Largest displacement, m.
double farthest(const ParticleArray& before, const ParticleArray& now) {
  double most = 0.0;
  for (std::size_t b = 0; b < now.blockCount(); ++b) most = std::max(most, (centre(now, b) - centre(before, b)).norm());
  return most;
}

// Of an island of all blocks: node b is block b.
const std::vector<std::int32_t>& eliminationOrder(const Simulation& simulation) {
  return simulation.engine->memo.newtonSystems.of(0).order.nodes;
}

// Factors that would take more than kMaxFillProducts are not made (those of a solid of 5000 blocks take a fifth of that): such an
// island rests in rigid steps. Here a wall is told that its own would.
TEST(WideIsland, WithoutFactorsAWallStandsInRigidSteps) {
  Simulation simulation(awake(wallScene(20, 12)));
  stepFor(simulation, 0.2);
  const ParticleArray before = simulation.state.position;
  const Counters then = simulation.counters;
  simulation.engine->memo.newtonSystems.of(0).exceedsFill = true;
  stepFor(simulation, 0.5);
  EXPECT_EQ(simulation.counters.implicitSteps, then.implicitSteps);
  EXPECT_EQ(simulation.counters.factorisations, then.factorisations);
  EXPECT_LE(deepest(simulation), 2.0 * simulation.tolerance_m);
  EXPECT_LE(farthest(before, simulation.state.position), simulation.tolerance_m);
}

// After a second nothing moves any more and no equation is solved: a frame only evaluates the forces. Before, it took 233
// explicit steps a frame.
TEST(WideIsland, AWallRestsWithoutASolution) {
  Simulation simulation(awake(wallScene(20, 12)));
  stepFor(simulation, 1.0);
  const ParticleArray before = simulation.state.position;
  const Counters then = simulation.counters;
  stepFor(simulation, 1.0);
  EXPECT_EQ(simulation.counters.newtonFailures, 0U);
  EXPECT_EQ(simulation.counters.implicitSteps - then.implicitSteps, 60U) << "one step a frame";
  EXPECT_EQ(simulation.counters.implicitIterations, then.implicitIterations);
  EXPECT_EQ(simulation.counters.factorisations, then.factorisations);
  EXPECT_LE(deepest(simulation), simulation.tolerance_m);
  EXPECT_LE(farthest(before, simulation.state.position), 1e-6 / 60.0) << "0.001 mm a minute";
}

// In a pyramid the weight is carried along its sides, and thousands of points slide before it rests. Without the derivative of
// friction with respect to the normal forces, rounding decided whether its equilibrium was found.
TEST(WideIsland, APyramidOf40RowsBeginsInEquilibrium) {
  Simulation simulation(densePyramid(40));
  const ParticleArray start = simulation.state.position;
  prepareAndStep(simulation);
  const Counters then = simulation.counters;
  EXPECT_LE(then.factorisations, 100U) << "170 when the weight came to bear row by row";
  stepFor(simulation, 0.5);
  EXPECT_EQ(simulation.counters.newtonFailures, 0U);
  EXPECT_LE(deepest(simulation), simulation.tolerance_m);
  const ParticleArray before = simulation.state.position;
  stepFor(simulation, 0.5);
  EXPECT_LE(farthest(before, simulation.state.position), 1e-6 / 60.0);
  EXPECT_LE(farthest(start, simulation.state.position), 40.0 * simulation.tolerance_m) << "a row sags by a tolerance at most";
}

// A brick in the middle is pushed across the wall by slightly more than the friction limit of its lower and upper face, for 0.03
// s; then friction stops it. Points slide and open; the elimination order is kept, and no step falls back to explicit ones.
TEST(WideIsland, ABrickIsPushedOutOfAWallByImplicitSteps) {
  Scene scene = awake(wallScene(20, 12));
  const int pushed = 130;
  const BlockSpec& brick = scene.blocks[static_cast<std::size_t>(pushed)];
  const double rowsAbove = 11.5 - brick.centre.z() / brick.dimensions.z();
  const double friction_n = 0.4 * kStandardGravity_m_s2 * brick.mass * (2.0 * rowsAbove + 1.0);
  const double excess = 0.25;
  const double push_s = 0.03;
  scene.forces.push_back(constantForce(pushed, -1, Vec3(0.0, (1.0 + excess) * friction_n, 0.0), 0.5, 0.5 + push_s));
  Simulation simulation(scene);
  stepFor(simulation, 0.5);
  const Vec3 start = centre(simulation.state.position, pushed);
  const std::vector<std::int32_t> order = eliminationOrder(simulation);
  stepFor(simulation, 1.0);
  EXPECT_EQ(eliminationOrder(simulation), order);
  const double moved = centre(simulation.state.position, pushed).y() - start.y();
  // Accelerated by `excess` of friction for push_s, then decelerated by all of it; walls do not share their weight evenly.
  const double expected = 0.5 * excess * friction_n / brick.mass * push_s * push_s * (1.0 + excess);
  EXPECT_GT(moved, 0.3 * expected);
  EXPECT_LT(moved, 3.0 * expected);
  EXPECT_EQ(simulation.counters.newtonFailures, 0U);
  EXPECT_LE(deepest(simulation), 2.0 * simulation.tolerance_m);
}

// A chain of rows has the least fill bottom up, for any length; a wall does not.
TEST(WideIsland, IsEliminatedInTheOrderThatFillsInLess) {
  const auto fromBelow = [](const Scene& scene) {
    Simulation simulation(scene);
    prepareAndStep(simulation);
    const std::vector<std::int32_t>& nodes = eliminationOrder(simulation);
    EXPECT_EQ(nodes.size(), scene.blocks.size());
    return std::is_sorted(nodes.begin(), nodes.end(), [&](std::int32_t p, std::int32_t q) {
      const Vec3 lower = scene.blocks[static_cast<std::size_t>(p)].centre;
      return lower.z() + 1e-3 < scene.blocks[static_cast<std::size_t>(q)].centre.z();
    });
  };
  Scene tower = towerScene(30);
  tower.settings.sleep = Sleep::off;
  EXPECT_TRUE(fromBelow(tower));
  EXPECT_FALSE(fromBelow(awake(wallScene(20, 12))));
}

// Where a block lies beside one of the next tower a row below, their edges are parallel to 1e-5. The common normal of such edges
// is that of any two lines in space, and turned over within a nanometre of way: steps of these frames then had no solution.
TEST(WideIsland, EveryStepOfTouchingTowersThatSwayConverges) {
  struct Swing {
    double deg;
    double hz;
  };
  for (const Swing& sway : {Swing{0.05, 1.5}, Swing{0.05, 2.5}, Swing{0.06, 1.5}, Swing{0.06, 2.0}, Swing{0.06, 2.5}}) {
    Simulation simulation(swaying(awake(touchingTowersScene(5)), sway.deg, sway.hz));
    for (int frame = 0; frame < 20; ++frame) prepareAndStep(simulation);
    EXPECT_GT(simulation.counters.implicitIterations, simulation.counters.frames) << "they had something to solve";
    EXPECT_EQ(simulation.counters.newtonFailures, 0U) << sway.deg << " degrees, " << sway.hz << " Hz";
  }
}

TEST(WideIsland, HasTheSameBitsOnAnyNumberOfThreads) {
  std::uint64_t hashes[2] = {};
  for (const std::size_t threads : {1U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Simulation simulation(awake(wallScene(28, 11)));
    kick(simulation, simulation.model.blockCount() - 1, Vec3(0.0, 0.05, 0.0));
    stepFor(simulation, 0.25);
    hashes[threads == 1 ? 0 : 1] = stateHash(simulation);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// Whether blocks have fallen decides how the equations of a wide island are solved, and not what their solution is. A wall of 306
// blocks whose top brick is kicked, in four steps a frame, for 0.1 s: its blocks part by what the residuals allow, a
// ten-thousandth of a weight in each step (4 um/s, which friction and springs hold back), and by no more than 1e-3 of how far
// they move.
TEST(WideIsland, ASolutionWithoutFillIsTheSame) {
  const auto kicked = [](bool fallen) {
    Scene scene = awake(wallScene(25, 12));
    scene.settings.substeps = 4;
    Simulation simulation(scene);
    prepareAndStep(simulation);
    for (BlockHistory& history : simulation.engine->memo.blockHistory) history.hasFallen = fallen;
    kick(simulation, simulation.model.blockCount() - 1, Vec3(0.0, 0.05, 0.0));
    stepFor(simulation, 0.1);
    return simulation;
  };
  const Simulation direct = kicked(false);
  const Simulation iterated = kicked(true);
  const BlockCholesky& matrix = iterated.engine->memo.newtonSystems.of(0).matrix;
  EXPECT_FALSE(direct.engine->memo.newtonSystems.of(0).matrix.isWithoutFill);
  EXPECT_TRUE(matrix.isWithoutFill);
  EXPECT_LE(matrix.blockCount(), iterated.engine->memo.newtonSystems.of(0).touching.size());
  EXPECT_EQ(iterated.counters.newtonFailures, 0U);
  const double moved = farthest(Simulation(direct.scene).state.position, direct.state.position);
  EXPECT_GE(moved, 1e-4);
  EXPECT_LE(farthest(direct.state.position, iterated.state.position), 1e-3 * moved);
}

}  // namespace
}  // namespace springtower
