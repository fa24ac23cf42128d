// Islands that are copies of one another: the equilibrium of one is found and the others take it over.
#include "solver/implicit/equal_islands.h"

#include "scenarios/towers.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"
#include "tests/support/uneven_tower.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <numbers>
#include <oneapi/tbb/global_control.h>
#include <vector>

namespace springtower {
namespace {

// Factorisations of the search for the equilibrium.
std::uint64_t factorisationsToPrepare(const Scene& scene) {
  Simulation simulation(scene);
  prepare(simulation);
  return simulation.counters.factorisations;
}

// The blocks of tower `tower` of equal towers, from where each was placed, m.
std::vector<Vec3> displacements(const Simulation& simulation, std::size_t tower, std::size_t blocks) {
  std::vector<Vec3> moved;
  for (std::size_t b = tower * blocks; b < (tower + 1) * blocks; ++b)
    moved.push_back(centre(simulation.state.position, b) - simulation.scene.blocks[b].centre);
  return moved;
}

TEST(EqualIslands, OfManyOneIsSolved) {
  const Scene one = unevenTower(6);
  EXPECT_EQ(factorisationsToPrepare(squareOf(one, 9)), factorisationsToPrepare(one));
}

// 0.3 m and its multiples are no binary fractions: the towers' places differ by rounding, 1e-16 m, and so do their poses.
TEST(EqualIslands, EachStandsAsOneAloneDoes) {
  const Scene one = awake(unevenTower(6));
  Simulation alone(one);
  Simulation square(squareOf(one, 9));
  prepare(alone);
  prepare(square);
  const std::vector<Vec3> expected = displacements(alone, 0, one.blocks.size());
  for (std::size_t tower = 0; tower < 9; ++tower) {
    const std::vector<Vec3> moved = displacements(square, tower, one.blocks.size());
    for (std::size_t b = 0; b < moved.size(); ++b)
      EXPECT_LE((moved[b] - expected[b]).norm(), 1e-9 * one.blocks[b].dimensions.z());
  }
}

// All rest: from the first frame on nothing moves by more than a thousandth of the tolerance, and no step fails.
TEST(EqualIslands, NothingMovesInTheFirstFrames) {
  Simulation square(squareOf(awake(unevenTower(6)), 9));
  prepareAndStep(square);
  const ParticleArray first = square.state.position;
  stepFor(square, 0.5);
  EXPECT_EQ(square.counters.newtonFailures, 0U);
  for (std::size_t b = 0; b < first.blockCount(); ++b)
    EXPECT_LE((centre(square.state.position, b) - centre(first, b)).norm(), 1e-3 * square.tolerance_m) << "block " << b;
}

// Contacts and their friction are those of the tower that was solved: at a tilt at which blocks lean on one another.
TEST(EqualIslands, ShareTheForcesBetweenTheirBlocks) {
  const Scene one = leaning(awake(unevenTower(6)), 10.0);
  const Scene four = squareOf(one, 4);
  Simulation square(four);
  prepare(square);
  const auto forceOn = [&](std::size_t block) {
    Vec3 sum = Vec3::Zero();
    for (const ContactForce& contact : contactForcesOn(square, blockId(block))) {
      const double sign = index(contact.upper) == block ? 1.0 : -1.0;
      sum += sign * (contact.normalForce * contact.normal + contact.frictionForce);
    }
    return sum;
  };
  const double weight_n = one.blocks.front().mass * one.gravity.magnitude;
  for (std::size_t b = 0; b < four.blocks.size(); ++b) {
    const Vec3 rest = forceOn(b) + four.blocks[b].mass * four.gravity.at(0.0);
    EXPECT_LE(rest.norm(), 1e-3 * weight_n) << "block " << b;
  }
}

std::size_t solvedIslands(const Scene& scene) {
  Simulation simulation(scene);
  prepare(simulation);
  const std::vector<std::int32_t> first = firstEqualIslands(simulation);  // equal islands have moved alike
  std::size_t solved = 0;
  for (std::size_t i = 0; i < first.size(); ++i) solved += first[i] == static_cast<std::int32_t>(i) ? 1 : 0;
  return solved;
}

TEST(EqualIslands, DifferInAnythingThatDecidesTheEquilibrium) {
  const Scene four = squareOf(unevenTower(6), 4);
  const std::size_t last = four.blocks.size() - 1;
  EXPECT_EQ(solvedIslands(four), 1U);
  Scene other = four;
  other.blocks[last].mass *= 1.001;
  EXPECT_EQ(solvedIslands(other), 2U);
  other = four;
  other.blocks[last].centre.x() += 1e-6;
  EXPECT_EQ(solvedIslands(other), 2U);
  other = four;
  other.blocks[last].dimensions.z() *= 0.999;
  EXPECT_EQ(solvedIslands(other), 2U);
  other = four;
  other.blocks[last].velocity = Vec3(0.0, 0.0, 1e-3);
  EXPECT_EQ(solvedIslands(other), 2U);
}

// Even and uneven towers by turns.
TEST(EqualIslands, AreFoundWhateverTheOrderOfTheTowers) {
  Scene mixed = squareOf(unevenTower(6), 4);
  const Scene other = squareOf(towerScene(6), 4);
  const std::size_t blocks = other.blocks.size() / 4;
  for (const std::size_t tower : {1U, 3U})
    std::copy_n(other.blocks.begin() + static_cast<std::ptrdiff_t>(tower * blocks), blocks,
                mixed.blocks.begin() + static_cast<std::ptrdiff_t>(tower * blocks));
  EXPECT_EQ(solvedIslands(mixed), 2U);
}

// A tower that is turned by a quarter, or a stiffer one: nine rows in place of six.
TEST(EqualIslands, AreNeitherTurnedNorStiffer) {
  Scene scene = squareOf(towerScene(6), 2);
  const Vec3 middle = scene.blocks[19].centre;  // the middle block of the second tower's lowest row
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitZ()));
  for (std::size_t b = 18; b < 36; ++b) {
    scene.blocks[b].centre = middle + quarter * (scene.blocks[b].centre - middle);
    scene.blocks[b].orientation = quarter * scene.blocks[b].orientation;
  }
  EXPECT_EQ(solvedIslands(scene), 2U);
}

// Methods whose contacts have stiffness start from the equilibrium, explicit ones as well; rigid ones as placed.
TEST(EqualIslands, AreAlikeInEveryMethod) {
  for (const Method method : {Method::semiImplicitEuler, Method::xpbd, Method::rigidPgs, Method::implicitEuler}) {
    Scene one = awake(towerScene(3));
    one.settings.method = method;
    Simulation square(squareOf(one, 4));
    stepFor(square, 0.1);
    const std::vector<Vec3> expected = displacements(square, 0, one.blocks.size());
    for (std::size_t tower = 1; tower < 4; ++tower) {
      const std::vector<Vec3> moved = displacements(square, tower, one.blocks.size());
      for (std::size_t b = 0; b < moved.size(); ++b)
        EXPECT_LE((moved[b] - expected[b]).norm(), 1e-3 * square.tolerance_m) << nameOf(method) << ", block " << b;
    }
  }
}

// Where the search is ended before it begins, all of them start as placed.
TEST(EqualIslands, StartAsPlacedWhereTheSearchIsEnded) {
  Simulation square(squareOf(unevenTower(6), 4));
  PrepareOptions options;
  options.budget_s = 0.0;
  EXPECT_EQ(prepare(square, options).blocksInBalance, 0U);
  for (std::size_t b = 0; b < square.scene.blocks.size(); ++b)
    EXPECT_LE((centre(square.state.position, b) - square.scene.blocks[b].centre).norm(), 1e-15);
}

TEST(EqualIslands, HaveTheSameBitsOnAnyNumberOfThreads) {
  const auto hashOn = [](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    Simulation square(squareOf(awake(unevenTower(6)), 9));
    stepFor(square, 0.1);
    return stateHash(square);
  };
  EXPECT_EQ(hashOn(1), hashOn(2));
  EXPECT_EQ(hashOn(1), hashOn(4));
}

}  // namespace
}  // namespace springtower
