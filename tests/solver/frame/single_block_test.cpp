#include "core/error.h"
#include "core/random.h"
#include "core/scene/scene.h"
#include "scenarios/towers.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/runner/run.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

namespace springtower {
namespace {

constexpr double kBlockFriction = 0.4;
const double kFrictionAngle_deg = degrees(std::atan(kBlockFriction));

Scene sceneFile(const std::string& name) {
  return sceneFromToml(std::string(SPRINGTOWER_SOURCE_DIR) + "/scenes/" + name + ".toml");
}

RunResult runFor(Simulation& simulation, double seconds) {
  RunOptions options;
  options.seconds = seconds;
  return runScene(simulation, options);
}

Vec3 horizontal(double direction_deg) {
  const double angle = direction_deg * std::numbers::pi / 180.0;
  return {std::cos(angle), std::sin(angle), 0.0};
}

bool allFinite(const ParticleArray& values) {
  for (std::size_t b = 0; b < values.blockCount(); ++b) {
    for (std::size_t c = 0; c < kCorners; ++c) {
      if (!values.at(b, c).allFinite()) return false;
    }
  }
  return true;
}

Scene slopeScene(double shareOfFrictionAngle, double direction_deg) {
  return awake(blockOnSlopeScene(shareOfFrictionAngle * kFrictionAngle_deg, direction_deg));
}

// Angle between two boxes, degrees, from the sines of the axes' rotations: accurate for small angles.
double turnBetween(const FittedBox& from, const FittedBox& to) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t a = 0; a < 3; ++a) sum += from.axis[a].cross(to.axis[a]);
  return degrees(std::asin(std::min(1.0, 0.5 * sum.norm())));
}

struct SlopeTest : ::testing::TestWithParam<double> {};

// True static friction: the friction angle is 21.8 degrees. It may creep by a micrometre in a minute; viscous friction would
// slide by a decimetre.
TEST_P(SlopeTest, StaysJustBelowTheFrictionAngle) {
  Simulation simulation(slopeScene(0.99, GetParam()));
  stepFor(simulation, 1.0);
  const ParticleArray reference = simulation.state.position;
  double move_m = 0.0;
  while (simulation.time_s < 61.0 - 1e-9) {
    prepareAndStep(simulation);
    move_m = std::max(move_m, largestCornerMove(reference, simulation.state.position));
  }
  EXPECT_LT(move_m, 1e-6);
}

// Between 1 s and 3 s the acceleration is that of theory; 1 % of it is 4e-5 g, so this mostly tests the accuracy of friction. In
// the first second the block descends to its resting depth.
TEST_P(SlopeTest, SlidesJustAboveTheFrictionAngle) {
  Simulation simulation(slopeScene(1.01, GetParam()));
  stepFor(simulation, 1.0);
  const Vec3 before = centre(simulation.state.velocity, 0);
  stepFor(simulation, 2.0);
  const Vec3 acceleration = 0.5 * (centre(simulation.state.velocity, 0) - before);
  const double angle = simulation.scene.gravity.tilt_deg * std::numbers::pi / 180.0;
  const double expected = kStandardGravity_m_s2 * (std::sin(angle) - kBlockFriction * std::cos(angle));
  EXPECT_NEAR(acceleration.dot(horizontal(GetParam())), expected, 0.01 * expected);
  EXPECT_LT((acceleration - acceleration.dot(horizontal(GetParam())) * horizontal(GetParam())).norm(), 0.01 * expected);
}

// Coulomb friction stops a block within v^2 / (2 mu g) and does not rotate it: its torque about the vertical vanishes because the
// pressure is symmetric about the direction of motion. Along 30 degrees it is not, but the bound on the rotation is the same.
TEST_P(SlopeTest, ThrownFlatStopsWhereTheoryStopsIt) {
  Scene scene = oneBlockScene(true);
  scene.blocks[0].velocity = 0.5 * horizontal(GetParam());
  Simulation simulation(scene);
  const FittedBox start = fittedBox(simulation.state.position, 0);
  stepFor(simulation, 1.0);  // it takes 0.13 s
  const FittedBox end = fittedBox(simulation.state.position, 0);
  const double expected = 0.25 / (2.0 * kBlockFriction * kStandardGravity_m_s2);
  Vec3 way = end.centre - start.centre;
  way.z() = 0.0;
  EXPECT_NEAR(way.norm(), expected, 0.01 * expected);
  EXPECT_GT(way.normalized().dot(horizontal(GetParam())), std::cos(0.01 * std::numbers::pi / 180.0)) << "it left its line";
  EXPECT_LT(turnBetween(start, end), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Directions, SlopeTest, ::testing::Values(0.0, 90.0, 30.0),
                         [](const auto& test) { return std::to_string(static_cast<int>(test.param)) + "Degrees"; });

// Bounds of every impact: a millimetre of penetration is a twentieth of a block's height; the energy may rise only by rounding
// and by the second order of the step; and no contact may be found late.
void expectCleanImpact(const RunResult& result) {
  EXPECT_LE(result.deepest.depth, 1e-3) << "at " << result.deepestTime_s << " s";
  ASSERT_TRUE(result.maxEnergyRise.has_value());
  EXPECT_LE(*result.maxEnergyRise, 1e-6);
  EXPECT_EQ(result.counters.contactsCreatedPenetrating, 0U);
  EXPECT_GT(result.counters.contactsCreated, 0U);
}

TEST(SingleBlock, DroppedFlatKeepsItsBounds) {
  Scene scene = oneBlockScene(true);
  scene.blocks[0].centre.z() += 0.02;
  Simulation simulation(scene);
  const RunResult result = runFor(simulation, 2.0);
  expectCleanImpact(result);
  // At rest on the floor: its centre at half its height, within the tolerance.
  EXPECT_NEAR(centre(simulation.state.position, 0).z(), 0.5 * kBlockHeight_m, simulation.tolerance_m);
}

// Phase and speed at which the block reaches the floor determine the kind of steps that stop it.
TEST(SingleBlock, DroppedFromAnyHeightAtAnyTimeKeepsItsBounds) {
  constexpr int kCases = 24;
  for (const Method method : {Method::implicit, Method::semiImplicitEuler}) {
    for (int i = 0; i < kCases; ++i) {
      const double share = static_cast<double>(i) / kCases;
      for (const bool height : {true, false}) {
        SCOPED_TRACE(testing::Message() << nameOf(method) << ", " << share << (height ? " of the heights" : " of a frame"));
        Scene scene = oneBlockScene(true);
        scene.settings.method = method;
        const double fallen_s = height ? 0.0 : share * scene.settings.frame_s;
        scene.blocks[0].centre.z() += (height ? 0.015 * (1.0 + share) : 0.02) - 0.5 * kStandardGravity_m_s2 * fallen_s * fallen_s;
        scene.blocks[0].velocity.z() = -kStandardGravity_m_s2 * fallen_s;
        Simulation simulation(scene);
        expectCleanImpact(runFor(simulation, 1.5));
      }
    }
  }
}

TEST(SingleBlock, DroppedOnACornerKeepsItsBounds) {
  Scene scene = sceneFile("dropped_block");
  Simulation simulation(scene);
  const RunResult result = runFor(simulation, 3.0);
  expectCleanImpact(result);
  // The penetration of a resting block into the floor is within the tolerance.
  PenetrationWorkspace workspace;
  EXPECT_LE(maxPenetration(simulation.state.position, true, workspace).depth, simulation.tolerance_m);
}

TEST(TwoBlocks, ThrownAtEachOtherKeepTheirBounds) {
  Scene scene = sceneFile("two_thrown_blocks");
  Simulation simulation(scene);
  const RunResult result = runFor(simulation, 3.0);
  expectCleanImpact(result);
  PenetrationWorkspace workspace;
  EXPECT_LE(maxPenetration(simulation.state.position, true, workspace).depth, simulation.tolerance_m);
}

// A tilted block that lands on a flat one anywhere, at any angle, and slides off it or stays: edges cross, faces touch along a
// line or at a corner, and one kind of contact changes into the other. No contact may be missed.
TEST(TwoBlocks, MeetingAtAnyAngleStayOutsideEachOther) {
  for (const Method method : {Method::semiImplicitEuler, Method::implicit}) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      RandomStream random(seed, 1);
      const auto between = [&](double least, double most) { return least + (most - least) * random.uniform(); };
      Scene scene = oneBlockScene(true);
      scene.settings.method = method;
      BlockSpec block;
      const double tilt = between(0.03, 0.5);
      const double direction = between(0.0, 2.0 * std::numbers::pi);
      const double yaw = between(0.0, 2.0 * std::numbers::pi);
      block.orientation =
          Eigen::AngleAxisd(tilt, Vec3(std::cos(direction), std::sin(direction), 0.0)) * Eigen::AngleAxisd(yaw, Vec3::UnitZ());
      // Its lowest corner half a millimetre above the other's top.
      const Eigen::Matrix3d axes = block.orientation.toRotationMatrix();
      const double reach = 0.5 * axes.row(2).cwiseAbs().dot(block.dimensions);
      block.centre = {between(-0.05, 0.05), between(-0.02, 0.02), kBlockHeight_m + 0.0005 + reach};
      block.velocity = {between(-0.3, 0.3), between(-0.3, 0.3), -0.05};
      scene.blocks.push_back(block);
      Simulation simulation(scene);
      double deepest = 0.0;
      for (int i = 0; i < 90; ++i) {
        prepareAndStep(simulation);
        deepest = std::max(deepest, overlapDepth(simulation.state.position, 0, 1));
      }
      EXPECT_LT(deepest, 1e-3) << nameOf(method) << ", seed " << seed;
    }
  }
}

// A head-on collision without floor and gravity: they must separate again and conserve their momentum, which is zero.
TEST(TwoBlocks, ThrownAtEachOtherWithoutGravityPart) {
  Scene scene = sceneFile("two_thrown_blocks");
  scene.gravity.magnitude = 0.0;
  scene.floor = false;
  Simulation simulation(scene);
  const Vec3 before = momentum(simulation).linear;
  const RunResult result = runFor(simulation, 0.5);
  expectCleanImpact(result);
  EXPECT_LT((momentum(simulation).linear - before).norm(), 1e-12);  // of parts of 0.1 kg m/s
  EXPECT_LT(centre(simulation.state.position, 0).x(), centre(simulation.state.position, 1).x()) << "they went through each other";
  EXPECT_EQ(overlapDepth(simulation.state.position, 0, 1), 0.0);
}

// The block flies at 5 m/s towards a wall 0.2 m away: after 0.1 s it is 0.3 m beyond it unless it was stopped.
struct ThinWall : ::testing::Test {
  static Simulation thrown(bool continuousTests) {
    Scene scene = sceneFile("thin_wall");
    scene.settings.continuousTests = continuousTests;
    Simulation simulation(scene);
    stepFor(simulation, 0.1);
    return simulation;
  }
};

TEST_F(ThinWall, IsGoneThroughWithoutCubicTests) {
  const Simulation simulation = thrown(false);
  EXPECT_GT(centre(simulation.state.position, 3).x(), centre(simulation.state.position, 1).x() + 0.2);
}

TEST_F(ThinWall, IsHitWithCubicTests) {
  const Simulation simulation = thrown(true);
  EXPECT_LT(centre(simulation.state.position, 3).x(), centre(simulation.state.position, 1).x());
  EXPECT_LT(centre(simulation.state.velocity, 3).x(), 4.5) << "it lost nothing to the wall";
  EXPECT_EQ(simulation.counters.contactsCreatedPenetrating, 0U);
}

// A block on the floor under one of 20 kg, both with springs and contacts for the load of the heavier one, and a step that is
// stable for it. The lighter one would require thirty times as many steps.
TEST(Divergence, IsCaughtInItsStepWithBlockAndTime) {
  Scene scene = oneBlockScene(true);
  scene.blocks.push_back(scene.blocks[0]);
  scene.blocks[0].centre.z() += kBlockHeight_m + 0.001;
  scene.blocks[0].mass = 1000.0 * kBlockMass_kg;
  scene.blocks[1].centre.z() += 0.001;
  scene.settings.method = Method::semiImplicitEuler;
  scene.settings.substeps = 60;
  scene.settings.tolerance_m = kBlockTolerance_m;
  scene.settings.allowUnstable = true;
  Simulation simulation(scene);
  int block = -1;
  double time_s = -1.0;
  for (int frame = 0; frame < 600 && block < 0; ++frame) {
    try {
      prepareAndStep(simulation);
      ASSERT_TRUE(allFinite(simulation.state.position) && allFinite(simulation.state.velocity)) << "frame " << frame;
    } catch (const DivergenceError& error) {
      block = error.block;
      time_s = error.time_s;
      EXPECT_NE(std::string(error.what()).find("block 1 diverged at "), std::string::npos) << error.what();
      EXPECT_NEAR(time_s, simulation.time_s, scene.settings.frame_s * 1.001) << "not in the step it happened in";
    }
  }
  EXPECT_EQ(block, 1);
  EXPECT_GT(time_s, 0.0);
}

// An upper block lies on a lower one, parallel to it, its middle displaced by `offset`. Beyond the edge at 13.35 mm it must fall.
Scene overhangScene(double offset) {
  Scene scene = oneBlockScene(true);
  scene.blocks.push_back(scene.blocks[0]);
  scene.blocks[1].centre.y() = offset;
  scene.blocks[1].centre.z() += kBlockHeight_m;
  scene.settings.sleep = Sleep::on;
  return scene;
}

// Time of the fall; fails if the upper block sleeps before. -1 if it stands at the end.
double fallWithoutSleep(Simulation& simulation, double from_s, double until_s) {
  const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
  while (simulation.time_s < until_s) {
    prepareAndStep(simulation);
    const FittedBox now = fittedBox(simulation.state.position, 1);
    if (start[1].centre.z() - now.centre.z() > kFallDropInLeastSides * kBlockHeight_m) return simulation.time_s;
    if (simulation.time_s <= from_s) continue;
    EXPECT_EQ(simulation.asleep[1], 0) << "asleep at " << simulation.time_s << " s";
    if (simulation.asleep[1] != 0) break;
  }
  return -1.0;
}

struct OverTheEdge : ::testing::TestWithParam<double> {};

TEST_P(OverTheEdge, NeverSleepsBeforeItFalls) {
  Simulation simulation(overhangScene(GetParam()));
  EXPECT_GT(fallWithoutSleep(simulation, 0.0, 10.0), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Offsets, OverTheEdge, ::testing::Values(0.0136, 0.015, 0.02));

// Asleep at first; then a force 20 % above the friction of 0.0769 N pushes the upper block until it will stop at a given
// distance, including the slide after the push. Beyond 2 cm it falls; at 1 cm it stays and sleeps again.
struct Pushed : ::testing::Test {
  static Simulation afterRest(double way) {
    const double friction = kBlockFriction * kBlockMass_kg * kStandardGravity_m_s2;
    const double gain = 0.2 * friction / kBlockMass_kg;
    const double loss = friction / kBlockMass_kg;
    Scene scene = overhangScene(0.0);
    const double start_s = 3.0;
    const double duration_s = std::sqrt(2.0 * way / (gain * (1.0 + gain / loss)));
    scene.forces.push_back(constantForce(1, -1, Vec3(0.0, 1.2 * friction, 0.0), start_s, start_s + duration_s));
    Simulation simulation(scene);
    stepFor(simulation, start_s);
    EXPECT_EQ(simulation.asleep[1], 1) << "it should sleep before it is pushed";
    return simulation;
  }
};

TEST_F(Pushed, TwoCentimetresOutItFallsBeforeItSleeps) {
  Simulation simulation = afterRest(0.02);
  EXPECT_GT(fallWithoutSleep(simulation, 3.05, 10.0), 3.0);
}

TEST_F(Pushed, OneCentimetreOutItStaysAndSleeps) {
  Simulation simulation = afterRest(0.01);
  stepFor(simulation, 5.0);
  const double way = centre(simulation.state.position, 1).y();
  EXPECT_GT(way, 0.009);
  EXPECT_LT(way, 0.012) << "the edge is at 13.35 mm";
  EXPECT_EQ(simulation.asleep[1], 1);
}

}  // namespace
}  // namespace springtower
