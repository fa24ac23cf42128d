#include "core/block.h"
#include "core/scene/scene.h"
#include "scenarios/random_scene.h"
#include "scenarios/registry.h"
#include "solver/block/inertia.h"
#include "solver/frame/prepare.h"
#include "solver/metrics/penetration.h"
#include "solver/world/simulation.h"
#include "tests/support/deepest.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace springtower {
namespace {

// Kinetic energy over potential energy of those of the first blocks that lie within half a height of where they were.
double agitation(const Simulation& simulation, const std::vector<Vec3>& start) {
  double kinetic = 0.0;
  double potential = 0.0;
  for (std::size_t b = 0; b < start.size(); ++b) {
    const RigidMotion motion = rigidMotion(simulation.state, b);
    if ((motion.centre - start[b]).norm() > 0.5 * kBlockHeight_m) continue;
    kinetic += 0.5 * simulation.model.mass[b] * motion.velocity.squaredNorm();
    potential += simulation.model.mass[b] * kStandardGravity_m_s2 * motion.centre.z();
  }
  return kinetic / potential;
}

struct Blow {
  const char* tower;
  double speed_m_s;
  double height_rows;  // of the block that hits it
};

class BlowTest : public ::testing::TestWithParam<Blow> {};

// A block flies at a tower that stands. What is left standing comes to rest: a tower in rigid steps alone sways on for seconds,
// at 1e-4 of its potential energy. No frame takes more steps than rigid steps at this
// speed need, and no block gets into another by more than a fiftieth of its height.
TEST_P(BlowTest, WhatIsLeftStandingComesToRest) {
  Scene scene = sceneNamed(GetParam().tower);
  std::vector<Vec3> start;
  for (const BlockSpec& block : scene.blocks) start.push_back(block.centre);
  BlockSpec shot;
  shot.centre = Vec3(-0.3, 0.0, GetParam().height_rows * kBlockHeight_m);
  shot.velocity = Vec3(GetParam().speed_m_s, 0.0, 0.0);
  scene.blocks.push_back(shot);
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  PenetrationWorkspace workspace;
  double deepest_m = 0.0;
  int most = 0;
  for (int frame = 0; frame < 120; ++frame) {
    prepareAndStep(simulation);
    deepest_m = std::max(deepest_m, maxPenetration(simulation.state.position, true, workspace).depth);
    most = std::max(most, simulation.substeps);
  }
  EXPECT_LT(agitation(simulation, start), 1e-6);
  EXPECT_LE(most, 400);
  EXPECT_LT(deepest_m, 0.02 * kBlockHeight_m);
}

INSTANTIATE_TEST_SUITE_P(Speeds, BlowTest,
                         ::testing::Values(Blow{"tower:6", 3.0, 3.6}, Blow{"tower:6", 5.0, 3.6}, Blow{"tower:18", 2.0, 15.6},
                                           Blow{"tower:18", 5.0, 10.6}),
                         [](const auto& tested) {
                           return std::string(tested.param.tower).substr(6) + "RowsAt" +
                                  std::to_string(static_cast<int>(tested.param.speed_m_s)) + "MetresASecond";
                         });

class DrawnStackTest : public ::testing::TestWithParam<std::uint64_t> {};

// Random stacks by implicit steps that diverged in explicit ones, or took up to 100,000 of them in a frame.
TEST_P(DrawnStackTest, TakesFewStepsAFrameAndDoesNotDiverge) {
  Scene scene = randomScene(GetParam()).scene;
  Simulation simulation(scene);
  int most = 0;
  for (int frame = 0; frame < 30; ++frame) {
    prepareAndStep(simulation);
    most = std::max(most, simulation.substeps);
  }
  EXPECT_LE(most, 1000);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DrawnStackTest, ::testing::Values(1071U, 1217U, 1414U, 1427U));

class DrawnDepthTest : public ::testing::TestWithParam<std::uint64_t> {};

// Random scenes that were 5 to 10 % of their least side deep. In 1557 and 1802 a block that had just rebounded from another was
// thrown back at it by a second impact in the same substep: passes looked at points that nearly touch, and this one was opening.
// In 3426 each change from rigid to implicit steps left a little of a stack's overlap without force, and nothing pushed it out.
TEST_P(DrawnDepthTest, IsASmallShareOfTheLeastSide) {
  const Scene scene = randomScene(GetParam()).scene;
  Simulation simulation(scene);
  EXPECT_LT(deepestOver(85, simulation), 0.02 * blockHeightOf(scene));
}

INSTANTIATE_TEST_SUITE_P(Seeds, DrawnDepthTest, ::testing::Values(1557U, 1802U, 3426U));

struct Heaviness {
  Method method;
  double ratio;  // of the upper blocks' mass to the lowest one's
};

class HeavyOnLight : public ::testing::TestWithParam<Heaviness> {};

// A light block falls on the floor with heavy ones on it. Sequential impulses converge there in as many passes as the masses'
// ratio: with two to four it got 3.3 mm into its neighbour at a ratio of 100, 23 mm at 2000. With equal masses it is 0.5 mm.
// The rigid method, with one, was 4.4 mm deep at a ratio of 500, of which its soft contacts make 1.6 at rest.
TEST_P(HeavyOnLight, ALightBlockIsNotCrushed) {
  Scene scene;
  for (int i = 0; i < 3; ++i) {
    BlockSpec block;
    block.dimensions = Vec3(0.1, 0.08, 0.06);
    block.centre = Vec3(0.004 * i, 0.0, 0.33 + 0.063 * i);
    block.mass = i == 0 ? 0.3 : 0.3 * GetParam().ratio;
    scene.blocks.push_back(block);
  }
  scene.settings.method = GetParam().method;
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  EXPECT_LT(deepestOver(45, simulation), 0.04 * 0.06);
}

INSTANTIATE_TEST_SUITE_P(Masses, HeavyOnLight,
                         ::testing::Values(Heaviness{Method::implicit, 100.0}, Heaviness{Method::implicit, 2000.0},
                                           Heaviness{Method::rigidPgs, 100.0}, Heaviness{Method::rigidPgs, 500.0}),
                         [](const auto& tested) {
                           return (tested.param.method == Method::implicit ? "Implicit" : "RigidPgs") +
                                  std::to_string(static_cast<int>(tested.param.ratio));
                         });

}  // namespace
}  // namespace springtower
