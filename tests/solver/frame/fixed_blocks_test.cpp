#include "core/error.h"
#include "core/parallel.h"
#include "core/scene/rotation.h"
#include "solver/metrics/balance.h"
#include "solver/metrics/penetration.h"
#include "solver/runner/run.h"
#include "solver/statics/statics.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/method_names.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>
#include <oneapi/tbb/global_control.h>
#include <string>

namespace springtower {
namespace {

constexpr double kFixedFriction = 0.4;  // of friction, in these scenes
constexpr double kThick_m = 0.05;

BlockSpec fixedBlock(const Vec3& centre, const Vec3& dimensions) {
  BlockSpec block;
  block.centre = centre;
  block.dimensions = dimensions;
  block.fixed = true;
  return block;
}

// A shelf whose top is at this height.
BlockSpec shelfAt(double top_m) {
  return fixedBlock({0.0, 0.0, top_m - 0.5 * kThick_m}, {0.4, 0.4, kThick_m});
}

BlockSpec freeBlock(const Vec3& centre) {
  BlockSpec block;
  block.centre = centre;
  return block;
}

Scene fixedScene(Method method, std::vector<BlockSpec> blocks, Sleep sleep = Sleep::off) {
  Scene scene;
  scene.name = "fixed";
  scene.blocks = std::move(blocks);
  scene.settings.method = method;
  scene.settings.reportFrictionDrag = 0.0;  // theory has none
  scene.settings.sleep = sleep;
  return scene;
}

// A block on a fixed ramp, down which x points; the ramp goes through the floor.
Scene rampScene(Method method, double slope_deg) {
  BlockSpec ramp = fixedBlock({0.0, 0.0, 0.0}, {1.0, 0.2, kThick_m});
  ramp.orientation = orientationOfRotation({0.0, slope_deg, 0.0});
  BlockSpec block;
  block.orientation = ramp.orientation;
  block.centre = ramp.orientation * Vec3(-0.3, 0.0, 0.5 * (kThick_m + block.dimensions.z()));
  return fixedScene(method, {ramp, block});
}

double alongRamp(const Simulation& simulation, double slope_deg) {
  return (orientationOfRotation({0.0, slope_deg, 0.0}) * Vec3::UnitX()).dot(centre(simulation.state.position, 1));
}

struct FixedBlocks : ::testing::TestWithParam<Method> {};
struct FixedBlocksThatHold : FixedBlocks {};  // by methods with static friction

INSTANTIATE_TEST_SUITE_P(Methods, FixedBlocks,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::semiImplicitEuler, Method::midpoint,
                                           Method::rungeKutta4, Method::report, Method::rigidPgs, Method::rigidLcp, Method::xpbd),
                         methodName);
INSTANTIATE_TEST_SUITE_P(Methods, FixedBlocksThatHold,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::semiImplicitEuler, Method::midpoint,
                                           Method::rungeKutta4, Method::rigidPgs, Method::rigidLcp, Method::xpbd),
                         methodName);

// The way of a block down a ramp at 0.98 of the friction angle in half a second, after half a second in which it sinks to its
// resting depth, m.
double creepOnRamp(Method method) {
  const double slope_deg = 0.98 * degrees(std::atan(kFixedFriction));
  Simulation simulation(rampScene(method, slope_deg));
  stepFor(simulation, 0.5);
  const double before_m = alongRamp(simulation, slope_deg);
  stepFor(simulation, 0.5);
  return alongRamp(simulation, slope_deg) - before_m;
}

TEST_P(FixedBlocksThatHold, HoldABlockOnARampBelowTheFrictionAngle) {
  EXPECT_NEAR(creepOnRamp(GetParam()), 0.0, 1e-6);
}

// The report has kinetic friction alone, which acts against a motion that there is: a failure of its, not of fixed blocks.
TEST(FixedBlocksOfTheReport, LetABlockCreepDownARampBelowTheFrictionAngle) {
  EXPECT_GT(creepOnRamp(Method::report), 1e-2);
}

// Distances over two equal times differ by a t^2.
TEST_P(FixedBlocks, LetABlockSlideDownARampAsTheoryHasIt) {
  constexpr double kSlope_deg = 25.0;
  constexpr double kAngle = kSlope_deg * std::numbers::pi / 180.0;
  Simulation simulation(rampScene(GetParam(), kSlope_deg));
  constexpr double kTime_s = 0.25;
  std::array<double, 3> along{};
  stepFor(simulation, 0.1);
  for (double& place : along) {
    place = alongRamp(simulation, kSlope_deg);
    if (&place != &along.back()) stepFor(simulation, kTime_s);
  }
  const double acceleration = (along[2] - 2.0 * along[1] + along[0]) / (kTime_s * kTime_s);
  const double theory = kStandardGravity_m_s2 * (std::sin(kAngle) - kFixedFriction * std::cos(kAngle));
  // The report's friction is that of the collisions of the step before: on the floor under tilted gravity it is 2.4 % off as
  // well.
  EXPECT_NEAR(acceleration, theory, (GetParam() == Method::report ? 0.04 : 0.01) * theory);
}

double sagOf(const Scene& scene, std::size_t block, double ground_m, double seconds = 0.5) {
  Simulation simulation(scene);
  stepFor(simulation, seconds);
  return centre(simulation.state.position, block).z() - ground_m - 0.5 * kBlockHeight_m;
}

TEST_P(FixedBlocks, CarryABlockAsTheFloorDoes) {
  const double onFloor = sagOf(fixedScene(GetParam(), {freeBlock({0.0, 0.0, 0.5 * kBlockHeight_m})}), 0, 0.0);
  Scene scene = fixedScene(GetParam(), {shelfAt(0.5), freeBlock({0.0, 0.0, 0.5 + 0.5 * kBlockHeight_m})});
  const double onShelf = sagOf(scene, 1, 0.5);
  scene.floor = false;
  EXPECT_EQ(onShelf, sagOf(scene, 1, 0.5));
  EXPECT_LT(onFloor, GetParam() == Method::report ? 1e-4 : 1e-9) << "it does not rest above the floor";
  // The report's collisions of corners with triangles are not those with a plane.
  EXPECT_NEAR(onShelf, onFloor, GetParam() == Method::report ? 1e-4 : 1e-9);
}

TEST_P(FixedBlocks, StopADroppedBlockAsTheFloorDoes) {
  constexpr double kDrop_m = 0.005;
  constexpr double kTime_s = 1.5;  // after all of its bounces
  const double centre_m = kDrop_m + 0.5 * kBlockHeight_m;
  const double onFloor = sagOf(fixedScene(GetParam(), {freeBlock({0.0, 0.0, centre_m})}), 0, 0.0, kTime_s);
  const double onShelf = sagOf(fixedScene(GetParam(), {shelfAt(0.5), freeBlock({0.0, 0.0, 0.5 + centre_m})}), 1, 0.5, kTime_s);
  EXPECT_LT(std::abs(onFloor), 2e-4);
  EXPECT_NEAR(onShelf, onFloor, 2e-4);
}

// The tower on a table against the tower on the floor, and the table itself, to the bit where it was.
TEST_P(FixedBlocks, CarryATowerAsTheFloorDoes) {
  constexpr double kHigh_m = 0.3;
  Scene tower = towerScene(GetParam() == Method::rigidLcp ? 2 : 6);  // a matrix of all its contacts is dense
  tower.settings.method = GetParam();
  tower.settings.sleep = Sleep::off;
  Scene onTable = tower;
  for (BlockSpec& block : onTable.blocks) {
    block.centre.z() += kHigh_m;
    block.row = -1;
  }
  onTable.blocks.push_back(shelfAt(kHigh_m));
  Simulation floor(tower);
  Simulation table(onTable);
  const MotionState before = table.state;
  const bool springs = traitsOf(GetParam()).family == MethodFamily::explicitSprings || GetParam() == Method::report;
  stepFor(floor, springs ? 0.1 : 1.0);
  stepFor(table, springs ? 0.1 : 1.0);
  EXPECT_EQ(table.tolerance_m, floor.tolerance_m);
  for (std::size_t b = 0; b < tower.blocks.size(); ++b) {
    const Vec3 apart = centre(table.state.position, b) - centre(floor.state.position, b) - Vec3(0.0, 0.0, kHigh_m);
    EXPECT_LT(apart.norm(), GetParam() == Method::report ? 3e-4 : floor.tolerance_m) << "block " << b;
  }
  for (std::size_t c = 0; c < kCorners; ++c)
    EXPECT_EQ(table.state.position.at(tower.blocks.size(), c), before.position.at(tower.blocks.size(), c));
}

TEST_P(FixedBlocks, LetABlockFallAsleep) {
  const Sleep sleep = GetParam() == Method::report ? Sleep::report : Sleep::on;
  Simulation simulation(fixedScene(GetParam(), {shelfAt(0.5), freeBlock({0.0, 0.0, 0.5 + 0.5 * kBlockHeight_m})}, sleep));
  stepFor(simulation, 2.0);
  EXPECT_TRUE(allAsleep(simulation));
  EXPECT_TRUE(atRest(simulation));
  EXPECT_NEAR(centre(simulation.state.position, 1).z(), 0.5 + 0.5 * kBlockHeight_m, 1e-4);
}

TEST_P(FixedBlocks, JoinNoIslands) {
  Scene scene = fixedScene(GetParam(), {shelfAt(0.5)});
  for (const double x : {-0.1, 0.1}) {
    for (int i = 0; i < 3; ++i) scene.blocks.push_back(freeBlock({x, 0.0, 0.5 + (0.5 + i) * kBlockHeight_m}));
  }
  Simulation simulation(scene);
  prepareAndStep(simulation);
  EXPECT_EQ(simulation.engine->memo.islands.count(), 2U);
  EXPECT_EQ(simulation.engine->memo.islands.islandOf[0], -1);
}

TEST_P(FixedBlocks, StopABlockThatHitsAWall) {
  BlockSpec block = freeBlock({0.0, 0.0, 0.5 * kBlockHeight_m});
  block.velocity.x() = 2.0;
  const double face_m = 0.1;
  Simulation simulation(fixedScene(GetParam(), {block, fixedBlock({face_m + 0.05, 0.0, 0.1}, {0.1, 0.3, 0.2})}));
  PenetrationWorkspace workspace;
  double deepest_m = 0.0;
  for (int frame = 0; frame < 60; ++frame) {
    prepareAndStep(simulation);
    deepest_m = std::max(deepest_m, maxPenetration(simulation.state.position, true, workspace, simulation.model.fixed).depth);
  }
  EXPECT_LT(deepest_m, 1e-3) << "8 tolerances are aimed at in an impact";
  EXPECT_LT(centre(simulation.state.position, 0).x(), face_m - 0.4 * kBlockLength_m);
}

TEST_P(FixedBlocks, GiveTheSameBitsOnAnyNumberOfThreads) {
  Scene scene = towerScene(3);
  for (BlockSpec& block : scene.blocks) {
    block.centre.z() += 0.31;
    block.row = -1;
  }
  scene.blocks.push_back(shelfAt(0.3));
  scene.blocks.push_back(freeBlock({0.15, 0.0, 0.35}));
  scene.settings.method = GetParam();
  std::array<std::uint64_t, 2> hash{};
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Simulation simulation(scene);
    stepFor(simulation, 0.1);
    hash[threads - 1] = stateHash(simulation);
  }
  EXPECT_EQ(hash[0], hash[1]);
}

// A stack falls asleep on a shelf, and wakes when it is hit; the shelf does neither.
TEST(FixedBlocksAsleep, NeitherWakeNorKeepAwake) {
  Scene scene = fixedScene(Method::implicit, {shelfAt(0.5)}, Sleep::on);
  for (int i = 0; i < 3; ++i) scene.blocks.push_back(freeBlock({0.0, 0.0, 0.5 + (0.5 + i) * kBlockHeight_m}));
  Simulation simulation(scene);
  EXPECT_FALSE(allAsleep(simulation));
  stepFor(simulation, 3.0);
  EXPECT_TRUE(allAsleep(simulation));
  EXPECT_TRUE(atRest(simulation));
  kick(simulation, 3, {0.0, 0.0, 1.0});
  for (int frame = 0; frame < 60; ++frame) {
    prepareAndStep(simulation);
    EXPECT_EQ(simulation.asleep[0], 1) << "frame " << frame;
  }
  EXPECT_GT(simulation.wakes[static_cast<std::size_t>(WakeReason::impact)], 0U);
  stepFor(simulation, 4.0);
  EXPECT_TRUE(allAsleep(simulation));
  EXPECT_LT(largestImbalance(imbalances(simulation, contactForces(simulation))).force, 1e-3);
}

// A push that a tower holds asleep, with one block awake, it holds on a table as well, and the block moves as far.
TEST(FixedBlocksAsleep, CarryATowerAsTheFloorDoes) {
  std::array<double, 2> moved_m{};
  for (const bool table : {false, true}) {
    constexpr std::size_t kPushed = 28;
    Scene scene = towerScene(18);
    scene.forces.push_back(constantForce(kPushed, -1, scene.blocks[kPushed].orientation * Vec3::UnitX(), 2.0, 2.5));
    if (table) {
      for (BlockSpec& block : scene.blocks) block.centre.z() += 0.2;
      scene.blocks.push_back(shelfAt(0.2));
    }
    Simulation simulation(scene);
    stepFor(simulation, 1.9);
    EXPECT_TRUE(allAsleep(simulation));
    while (simulation.time_s < 3.5) {
      prepareAndStep(simulation);
      EXPECT_LE(std::count(simulation.asleep.begin(), simulation.asleep.end(), 0), 1);
    }
    moved_m[table ? 1 : 0] = (centre(simulation.state.position, kPushed) - scene.blocks[kPushed].centre).norm();
  }
  EXPECT_GT(moved_m[0], 1e-4);
  EXPECT_NEAR(moved_m[1], moved_m[0], 1e-6);
}

// A ladder of length l whose ends touch a floor and a wall of equal friction stands from tan(angle) = (1 - mu^2) / (2 mu) on.
Scene ladderScene(Method method, double angle_deg) {
  BlockSpec ladder;
  ladder.dimensions = {0.3, 0.05, 0.004};
  ladder.orientation = orientationOfRotation({0.0, -angle_deg, 0.0});
  const Vec3 reach = ladder.orientation.toRotationMatrix().cwiseAbs() * (0.5 * ladder.dimensions);
  ladder.centre = {-reach.x(), 0.0, reach.z()};
  return fixedScene(method, {fixedBlock({0.05, 0.0, 0.3}, {0.1, 0.3, 0.6}), ladder});
}

TEST(FixedWall, CarriesALadder) {
  const double limit_deg = degrees(std::atan((1.0 - kFixedFriction * kFixedFriction) / (2.0 * kFixedFriction)));
  for (const double off_deg : {-4.0, 4.0}) {
    const Scene scene = ladderScene(Method::implicit, limit_deg + off_deg);
    EXPECT_EQ(staticScene(scene).rest, off_deg > 0.0 ? Rest::stands : Rest::falls) << off_deg;
    Simulation simulation(scene);
    const Vec3 start = centre(simulation.state.position, 1);
    stepFor(simulation, 1.0);
    const double moved_m = (centre(simulation.state.position, 1) - start).norm();
    if (off_deg > 0.0) {
      EXPECT_LT(moved_m, 1e-3);
    } else {
      EXPECT_GT(moved_m, 0.05);
    }
  }
}

TEST(FixedShelf, CarriesABlockWhoseCentreIsOnIt) {
  for (const double share : {0.49, 0.51}) {
    const double out_m = share * kBlockLength_m;  // beyond the shelf's edge at x = 0.2
    const Scene scene = fixedScene(
        Method::implicit, {shelfAt(0.5), freeBlock({0.2 + out_m - 0.5 * kBlockLength_m, 0.0, 0.5 + 0.5 * kBlockHeight_m})});
    EXPECT_EQ(staticScene(scene).rest, share < 0.5 ? Rest::stands : Rest::falls) << share;
    Simulation simulation(scene);
    stepFor(simulation, 1.0);
    if (share < 0.5) {
      EXPECT_NEAR(centre(simulation.state.position, 1).z(), 0.5 + 0.5 * kBlockHeight_m, 1e-4);
    } else {
      EXPECT_LT(centre(simulation.state.position, 1).z(), 0.4);
    }
  }
}

// The weight of a block on a shelf is the shelf's load, and the shelf's own counts for nothing.
TEST(FixedShelf, IsGroundToStatics) {
  const StaticScene statics =
      staticScene(fixedScene(Method::implicit, {shelfAt(0.5), freeBlock({0.0, 0.0, 0.5 + 0.5 * kBlockHeight_m})}));
  const ContactLoads loads = contactLoads(statics);
  ASSERT_EQ(loads.contacts.size(), 1U);
  EXPECT_EQ(loads.contacts[0].upper, blockId(1));
  EXPECT_EQ(loads.contacts[0].lower, blockId(0));
  EXPECT_NEAR(loads.contacts[0].normal_n, kBlockMass_kg * kStandardGravity_m_s2, 1e-9);
  EXPECT_EQ(blockLoads(statics, loads)[0].weight_n, 0.0);
  // It slides from the friction angle on, before it tips about its width at 55.7 degrees.
  EXPECT_NEAR(tiltMargin(statics)->tilt_deg, degrees(std::atan(kFixedFriction)), 0.01);
}

TEST(FixedBlocksInput, IsChecked) {
  const auto messageOf = [](const Scene& scene) -> std::string {
    try {
      checkScene(scene, "scene");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Scene scene = fixedScene(Method::implicit, {shelfAt(0.0), shelfAt(0.01), freeBlock({0.0, 0.0, 0.5})});
  EXPECT_EQ(messageOf(scene), "") << "fixed blocks may lie in one another and in the floor";
  scene.forces.push_back(constantForce(0, -1, Vec3::UnitX(), 0.0, 1.0));
  EXPECT_EQ(messageOf(scene), "scene: force 0: block: expected a block that moves, got block 0, which is fixed");
  scene.forces.clear();
  scene.blocks[1].spin.z() = 1.0;
  EXPECT_EQ(messageOf(scene), "scene: block 1: expected no velocity and no spin for a fixed block, got one");
  scene.blocks[1].spin.setZero();
  scene.blocks[2].centre.z() = 0.0;
  EXPECT_THAT(messageOf(scene), ::testing::HasSubstr("inside the floor"));
  scene.blocks.pop_back();
  EXPECT_EQ(messageOf(scene), "scene: expected at least one block that is not fixed, got fixed blocks only");
}

}  // namespace
}  // namespace springtower
