// The static equilibrium that a scene begins in: nothing moves from its first frame on, whatever the order of the blocks and the
// way the scene lies to the axes, and finding it takes a few factorisations.
#include "core/scene/scene.h"
#include "scenarios/registry.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <string>

namespace springtower {
namespace {

struct StartCase {
  const char* name;
  Scene scene;
  std::uint64_t mostFactorisations;
};

void PrintTo(const StartCase& tested, std::ostream* stream) {
  *stream << tested.name;
}

// Blocks of the game on one another.
Scene columnOf(std::size_t count) {
  Scene scene = towerScene(1);
  scene.blocks.resize(1);
  for (std::size_t b = 1; b < count; ++b) {
    scene.blocks.push_back(scene.blocks.front());
    scene.blocks.back().centre.z() += static_cast<double>(b) * scene.blocks.front().dimensions.z();
  }
  return scene;
}

Scene tilted(Scene scene, double tilt_deg) {
  scene.gravity.tilt_deg = tilt_deg;
  return scene;
}

// Largest displacement of a block, m.
double farthestOf(const ParticleArray& before, const ParticleArray& now) {
  double most = 0.0;
  for (std::size_t b = 0; b < now.blockCount(); ++b) most = std::max(most, (centre(now, b) - centre(before, b)).norm());
  return most;
}

class StartTest : public ::testing::TestWithParam<StartCase> {};

// What remains is the rounding of kept factors, and creep of a thousandth of a millimetre a minute.
TEST_P(StartTest, IsTheEquilibriumItself) {
  Simulation simulation(awake(GetParam().scene));
  prepareAndStep(simulation);
  EXPECT_LE(simulation.counters.factorisations, GetParam().mostFactorisations);
  EXPECT_EQ(simulation.counters.newtonFailures, 0U);
  const ParticleArray first = simulation.state.position;
  stepFor(simulation, 1.0);
  EXPECT_LE(farthestOf(first, simulation.state.position), 5e-3 * simulation.tolerance_m);
  PenetrationWorkspace workspace;
  EXPECT_LE(maxPenetration(simulation.state.position, true, workspace).depth, simulation.tolerance_m);
}

// When the weight came to bear row by row these took 24, 43, 55, 16 and 34.
INSTANTIATE_TEST_SUITE_P(Of, StartTest,
                         ::testing::Values(StartCase{"Tower18", towerScene(18), 3},
                                           StartCase{"Tower18Tilted", tilted(towerScene(18), 8.0), 20},
                                           StartCase{"Tower72", towerScene(72), 3}, StartCase{"Wall20x12", wallScene(20, 12), 3},
                                           StartCase{"Wall40x25", wallScene(40, 25), 4}),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Some blocks weigh ten thousand times as much as the others; those in `heavy`.
Scene unlike(Scene scene, const std::function<bool(std::size_t)>& heavy) {
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) scene.blocks[b].mass *= heavy(b) ? 1e4 : 1.0;
  return scene;
}

// Masses at random, the largest up to ten thousand times the smallest.
Scene ofManyMasses(Scene scene) {
  std::mt19937_64 random(1);
  for (BlockSpec& block : scene.blocks) block.mass *= std::pow(1e4, std::generate_canonical<double, 53>(random));
  return scene;
}

class UnlikeMassesTest : public ::testing::TestWithParam<StartCase> {};

// A light block that rests on a heavy one begins in the equilibrium as well, and every frame is a single step. (While smoothed
// contacts all bore the mean weight, they lifted light blocks: none of the scenes but TopRow and EveryOtherRow began in balance,
// and for a second they took 3 to 22 steps a frame, 0.4 mm deep.)
TEST_P(UnlikeMassesTest, BeginInTheEquilibriumAndTakeSingleSteps) {
  Simulation simulation(awake(GetParam().scene));
  prepareAndStep(simulation);
  EXPECT_LE(simulation.counters.factorisations, GetParam().mostFactorisations);
  const ParticleArray first = simulation.state.position;
  const Counters before = simulation.counters;
  stepFor(simulation, 1.0);
  EXPECT_LE(farthestOf(first, simulation.state.position), 5e-3 * simulation.tolerance_m);
  EXPECT_EQ(simulation.counters.newtonFailures, before.newtonFailures);
  EXPECT_EQ(simulation.counters.steps - before.steps, simulation.counters.frames - before.frames);
  PenetrationWorkspace workspace;
  EXPECT_LE(maxPenetration(simulation.state.position, true, workspace).depth, simulation.tolerance_m);
}

INSTANTIATE_TEST_SUITE_P(
    Of, UnlikeMassesTest,
    ::testing::Values(StartCase{"TwoBlocksTheLowerHeavy", unlike(columnOf(2), [](std::size_t b) { return b == 0; }), 40},
                      StartCase{"TwoBlocksTheUpperHeavy", unlike(columnOf(2), [](std::size_t b) { return b == 1; }), 40},
                      StartCase{"OneInTheMiddle", unlike(towerScene(18), [](std::size_t b) { return b == 28; }), 120},
                      StartCase{"OneAtTheSide", unlike(towerScene(18), [](std::size_t b) { return b == 27; }), 120},
                      StartCase{"BottomRow", unlike(towerScene(18), [](std::size_t b) { return b < 3; }), 120},
                      StartCase{"TopRow", unlike(towerScene(18), [](std::size_t b) { return b >= 51; }), 40},
                      StartCase{"EveryOtherRow", unlike(towerScene(18), [](std::size_t b) { return b / 3 % 2 == 1; }), 40},
                      StartCase{"OneBrickOfAWall", unlike(wallScene(10, 8), [](std::size_t b) { return b == 44; }), 200},
                      StartCase{"EveryOtherBrick", unlike(wallScene(10, 8), [](std::size_t b) { return b % 2 == 1; }), 200},
                      StartCase{"TowerOfMany", ofManyMasses(towerScene(18)), 120},
                      StartCase{"WallOfMany", ofManyMasses(wallScene(10, 8)), 200}),
    [](const auto& tested) { return std::string(tested.param.name); });

// One block of 10,000 times the mass of the others, at places that are hard to bring into balance. With a diagonal of the factors
// that was 64 epsilon stiffer, more than what holds a light block beside a heavy one, none of these towers began in balance; with
// one retry of a step with friction, none of these walls. Heavy blocks press their own support together by a tolerance or two and
// turn about it.
TEST(Start, OneHeavyBlockIsInBalanceWhereverItLies) {
  const auto expectRest = [](Scene scene, std::size_t heavy, const char* what) {
    scene.blocks[heavy].mass *= 1e4;
    Simulation simulation(awake(scene));
    const ParticleArray placed = simulation.state.position;
    EXPECT_EQ(prepare(simulation).blocksInBalance, scene.blocks.size()) << what << heavy;
    const ParticleArray first = simulation.state.position;
    EXPECT_LE(farthestOf(placed, first), 20.0 * simulation.tolerance_m) << what << heavy;
    stepFor(simulation, 0.5);
    EXPECT_LE(farthestOf(first, simulation.state.position), 5e-3 * simulation.tolerance_m) << what << heavy;
  };
  for (const std::size_t heavy : {3U, 5U, 6U, 8U, 9U, 11U, 12U, 14U, 15U, 20U, 26U})
    expectRest(towerScene(18), heavy, "tower, block ");
  for (const std::size_t heavy : {42U, 51U, 74U, 75U, 76U, 77U, 78U, 79U, 80U})
    expectRest(wallScene(10, 8), heavy, "wall, brick ");
}

// Between unlike masses the search tries more, and still finds no equilibrium where there is none: the upper block's centre is a
// millimetre outside the lower one.
TEST(Start, AHeavyBlockBeyondTheEdgeIsNotInBalance) {
  for (const double factor : {1.0, 1e2, 1e4}) {
    Scene scene = columnOf(2);
    scene.blocks[1].centre.x() += 0.5 * scene.blocks[0].dimensions.x() + 0.001;
    scene.blocks[1].mass *= factor;
    Simulation simulation(awake(scene));
    EXPECT_EQ(prepare(simulation).blocksInBalance, 0U) << factor;
  }
}

// Tall towers under gravity that leans by a third and by half of what tips them over. A diagonal of the factors that was 64
// epsilon stiffer was more than what a swaying tower resists with: these took 303 to 585 factorisations, and at 144 rows the
// first steps did not converge. What the search leaves moves the top of those by 0.003 mm.
TEST(Start, TallTowersThatLeanTakeFewFactorisations) {
  struct Leaning {
    int rows;
    double tilt_deg;
    std::uint64_t mostFactorisations;
  };
  for (const Leaning& tested : {Leaning{72, 1.0, 60}, Leaning{72, 1.5, 60}, Leaning{144, 0.6, 80}, Leaning{144, 1.0, 80}}) {
    SCOPED_TRACE(testing::Message() << tested.rows << " rows at " << tested.tilt_deg << " degrees");
    const Scene scene = awake(leaning(towerScene(tested.rows), tested.tilt_deg));
    Simulation simulation(scene);
    EXPECT_EQ(prepare(simulation).blocksInBalance, scene.blocks.size());
    EXPECT_LE(simulation.counters.factorisations, tested.mostFactorisations);
    const ParticleArray found = simulation.state.position;
    stepFor(simulation, 0.5);
    EXPECT_LE(farthestOf(found, simulation.state.position), 0.1 * simulation.tolerance_m);
    EXPECT_EQ(simulation.counters.newtonFailures, 0U);
  }
}

// Low towers slide under gravity that topples higher ones. Steps that fail are tried again shorter, twelve times each at the five
// or six shares of the tilt at which they slide as well, unless they show that nothing slows the fall: 1680 to 2340 iterations in
// place of 760 to 890.
TEST(Start, TowersThatSlideAreSoonFoundToFall) {
  for (const int rows : {6, 7, 8}) {
    SCOPED_TRACE(testing::Message() << rows << " rows");
    Simulation simulation(sceneNamed("collapse:" + std::to_string(rows)));
    prepare(simulation);
    EXPECT_LT(simulation.counters.implicitIterations, 1000U);
  }
}

// An uneven tower of light blocks in a scene with a cube of 10,000 masses, which makes the floor stiff. While its blocks find
// their places the line searches are short, down to a thousandth, and the residual rises for twenty iterations: without a
// diagonal that is stiffer after them the tower of 18 rows of seed 4 is not found.
TEST(Start, UnevenTowersOnAFloorForAHeavyBlockAreInBalance) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    for (const int rows : {6, 18}) {
      TowerOptions options;
      options.heightsSigma_m = kUnevenHeightsSigma_m;
      options.seed = seed;
      Scene scene = towerScene(rows, options);
      BlockSpec cube;
      cube.dimensions = {0.05, 0.05, 0.05};
      cube.centre = {0.3, 0.0, 0.025};
      cube.mass = 1e4 * scene.blocks.front().mass;
      scene.blocks.push_back(cube);
      Simulation simulation(awake(scene));
      EXPECT_EQ(prepare(simulation).blocksInBalance, scene.blocks.size()) << rows << " rows of seed " << seed;
    }
  }
}

// Sag of a tower's highest block against its place, m, as its scene is turned about the vertical.
double sagOfTurned(double angle_deg) {
  Scene scene = awake(towerScene(18));
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, Vec3::UnitZ()));
  for (BlockSpec& block : scene.blocks) {
    block.centre = turn * block.centre;
    block.orientation = turn * block.orientation;
  }
  Simulation simulation(scene);
  const std::size_t top = scene.blocks.size() - 1;
  stepFor(simulation, 0.1);
  return scene.blocks[top].centre.z() - centre(simulation.state.position, top).z();
}

// Bounding boxes along the axes made it 8 times as stiff at 33 degrees.
TEST(Start, ATowerSagsAsMuchHoweverItIsTurned) {
  const double straight_m = sagOfTurned(0.0);
  for (const double angle_deg : {10.0, 33.0, 45.0, 90.0, 120.0})
    EXPECT_NEAR(sagOfTurned(angle_deg), straight_m, 1e-3 * straight_m) << angle_deg;
}

TEST(Start, IsTheSameInAnyOrderOfTheBlocks) {
  const Scene scene = awake(tilted(towerScene(18), 8.0));
  Scene reversed = scene;
  std::reverse(reversed.blocks.begin(), reversed.blocks.end());
  Simulation first(scene);
  Simulation second(reversed);
  stepFor(first, 0.1);
  stepFor(second, 0.1);
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const Vec3 apart = centre(first.state.position, b) - centre(second.state.position, scene.blocks.size() - 1 - b);
    EXPECT_LE(apart.norm(), 5e-3 * first.tolerance_m) << "block " << b << ": each search ends within a thousandth of a tolerance";
  }
}

// Friction at the start is that of normal forces which the load has made. The search begins with all points that touch pushing
// and sticking; between two walls that press nothing a block still falls freely, also where gravity leans along them.
TEST(Start, ABlockBetweenWallsThatNothingPressesFalls) {
  for (const double tilt_deg : {0.0, 1.0}) {
    Scene scene;
    scene.gravity.tilt_deg = tilt_deg;
    BlockSpec block;
    block.centre = Vec3(0.0, 0.0, 0.6);
    BlockSpec wall = block;
    wall.fixed = true;
    wall.dimensions = Vec3(0.1, 0.02, 0.4);
    for (const double side : {-1.0, 1.0}) {
      wall.centre.y() = side * 0.5 * (block.dimensions.y() + wall.dimensions.y());
      scene.blocks.push_back(wall);
    }
    scene.blocks.push_back(block);
    Simulation simulation(awake(scene));
    const double fall_s = 0.1;
    stepFor(simulation, fall_s);
    const double free_m = 0.5 * kStandardGravity_m_s2 * fall_s * fall_s;
    EXPECT_NEAR(0.6 - centre(simulation.state.position, 2).z(), free_m, 0.002 * free_m) << tilt_deg << " degrees";
  }
}

// f01: one of two flush bricks is a tenth of a millimetre taller. The other counted as its support, by an overlap of rounding,
// and it diverged in the first step.
TEST(Start, TwoFlushBricksOfUnequalHeightStand) {
  Scene scene;
  for (const double height_m : {0.02, 0.0201}) {
    BlockSpec brick;
    brick.dimensions = Vec3(0.06, 0.03, height_m);
    brick.mass = 0.03;
    brick.centre = Vec3(0.1 + (height_m > 0.02 ? 0.06 : 0.0), 0.0, 0.5 * height_m);
    scene.blocks.push_back(brick);
  }
  Simulation simulation(awake(scene));
  stepFor(simulation, 1.0);
  for (std::size_t b = 0; b < 2; ++b)
    EXPECT_LE((centre(simulation.state.position, b) - scene.blocks[b].centre).norm(), simulation.tolerance_m);
}

// Two columns of equal blocks side by side, one three times as high: one island, with springs of two stiffnesses. Blocks of one
// stiffness share a matrix, and Newton's iteration converges in the few iterations of a right one.
TEST(Start, TouchingStacksOfUnequalHeightHaveMatricesOfTheirOwn) {
  Scene scene;
  for (int i = 0; i < 8; ++i) {
    BlockSpec block;
    const bool first = i < 2;
    block.centre = Vec3(0.0, first ? 0.0 : block.dimensions.y(), block.dimensions.z() * (first ? i + 0.5 : i - 1.5));
    scene.blocks.push_back(block);
  }
  Simulation simulation(awake(scene));
  stepFor(simulation, 1.0);
  const Engine& engine = *simulation.engine;
  ASSERT_EQ(engine.memo.islands.count(), 1U);
  const NewtonSystem& island = engine.memo.newtonSystems.of(0);
  ASSERT_EQ(island.blockClassOf.size(), 8U);
  for (std::size_t b = 0; b < 8; ++b) {
    const auto kind = static_cast<std::size_t>(island.blockClassOf[b]);
    EXPECT_EQ(island.blockClasses[kind].edge_n_m, simulation.stiffness.edge_n_m[b]) << "block " << b;
  }
  EXPECT_LT(simulation.stiffness.edge_n_m.front(), 0.5 * simulation.stiffness.edge_n_m.back());
}

}  // namespace
}  // namespace springtower
