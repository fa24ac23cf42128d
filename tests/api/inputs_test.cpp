// What acts on a world from outside: forces, gravity, friction, kicks, sleep and the hand.
#include "tests/support/says.h"

#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <springtower/inputs.h>
#include <springtower/query.h>
#include <vector>

namespace springtower::api {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kMass_kg = 0.0196;
constexpr double kGravity_m_s2 = 9.81;

// One block in space, where nothing else acts.
Scene blockInSpace() {
  Scene scene;
  scene.floor = false;
  scene.blocks.resize(1);
  scene.gravity.magnitude_m_s2 = 0.0;
  return scene;
}

Scene blockOnTheFloor() {
  Scene scene;
  scene.blocks.resize(1);
  scene.blocks[0].centre.z = 0.0091;
  return scene;
}

// By how much the speed may lack a constant force, m/s: a block that flies takes explicit steps, whose velocities are half a step
// behind its positions.
double halfAStep(const World& world, double force_n) {
  const Counters counters = world.counters();
  const double step_s = world.frame_s() * static_cast<double>(counters.frames) / static_cast<double>(counters.steps);
  return 0.5 * step_s * force_n / kMass_kg * (1.0 + 1e-9);
}

TEST(ApiInputs, ForcesGiveTheirMomentum) {
  World world(blockInSpace());
  world.prepare();
  applyForce(world, {0, -1, {0.1, 0.0, 0.0}, 0.0, 0.25});
  applyForce(world, {0, -1, {0.0, 0.2, 0.0}, 0.1, 0.2});
  ASSERT_EQ(world.step(30), std::nullopt);
  EXPECT_NEAR(world.velocity(0).linear_m_s.x, 0.1 * 0.25 / kMass_kg, halfAStep(world, 0.1));
  EXPECT_NEAR(world.velocity(0).linear_m_s.y, 0.2 * 0.1 / kMass_kg, halfAStep(world, 0.2));
  applyForce(world, {0, -1, {0.0, 0.0, 1.0}, 0.0, 100.0});
  clearForces(world);
  ASSERT_EQ(world.step(10), std::nullopt);
  EXPECT_NEAR(world.velocity(0).linear_m_s.z, 0.0, 1e-12);
}

TEST(ApiInputs, AForceAtACornerTurnsTheBlock) {
  World world(blockInSpace());
  world.prepare();
  applyForce(world, {0, 1, {0.0, 0.0, 1e-4}, 0.0, 0.1});  // corner 1: +x, -y, -z
  ASSERT_EQ(world.step(6), std::nullopt);
  const Velocity velocity = world.velocity(0);
  const double impulse_n_s = 1e-5;
  EXPECT_NEAR(velocity.linear_m_s.z, impulse_n_s / kMass_kg, halfAStep(world, 1e-4));
  // The torque is arm times force, the moment of a cuboid m (a^2 + c^2) / 12; the block turns by 2 mrad meanwhile.
  const double moment = kMass_kg * (0.081 * 0.081 + 0.0182 * 0.0182) / 12.0;
  const double missing_rad_s = halfAStep(world, 1e-4) * kMass_kg * 0.0405 / moment;
  EXPECT_NEAR(velocity.angular_rad_s.y, -impulse_n_s * 0.0405 / moment, 1.01 * missing_rad_s);
}

TEST(ApiInputs, PushesPassWithTheirFrame) {
  World world(blockInSpace());
  world.prepare();
  for (int frame = 0; frame < 5; ++frame) {
    pushThroughFrame(world, 0, {0.1, 0.0, 0.0});
    pushThroughFrame(world, 0, {0.1, 0.0, 0.2});
    ASSERT_EQ(world.step(), std::nullopt);
  }
  ASSERT_EQ(world.step(5), std::nullopt);
  EXPECT_NEAR(world.velocity(0).linear_m_s.x, 0.2 * 5.0 / 60.0 / kMass_kg, halfAStep(world, 0.2));
  EXPECT_NEAR(world.velocity(0).linear_m_s.z, 0.2 * 5.0 / 60.0 / kMass_kg, halfAStep(world, 0.2));
  pushThroughFrame(world, 0, {0.1, 0.0, 0.0});
  clearForces(world);
  ASSERT_EQ(world.step(), std::nullopt);
  EXPECT_NEAR(world.velocity(0).linear_m_s.x, 0.2 * 5.0 / 60.0 / kMass_kg, halfAStep(world, 0.2));
}

TEST(ApiInputs, GravityIsWhatWasSet) {
  World world(blockInSpace());
  world.prepare();
  const Gravity given{4.0, 90.0, 90.0, 0.0, 0.0};
  setGravity(world, given);
  EXPECT_EQ(gravity(world), given);
  ASSERT_EQ(world.step(30), std::nullopt);
  const Vec3 velocity = world.velocity(0).linear_m_s;
  EXPECT_NEAR(velocity.x, 0.0, 1e-9);
  EXPECT_NEAR(velocity.y, 4.0 * 0.5, 4.0 / 60.0);  // explicit velocities may be half a step behind
  EXPECT_NEAR(velocity.z, 0.0, 1e-9);
}

TEST(ApiInputs, AKickAddsItsVelocityAtOnceAndWakes) {
  World world(blockOnTheFloor());
  world.prepare();
  ASSERT_EQ(world.step(180), std::nullopt);
  ASSERT_TRUE(isAsleep(world, 0));
  const Vec3 before = world.velocity(0).linear_m_s;
  kick(world, 0, {0.1, 0.2, 0.3});
  EXPECT_FALSE(isAsleep(world, 0));
  EXPECT_EQ(world.counters().wakes, 1U);
  EXPECT_NEAR(world.velocity(0).linear_m_s.x - before.x, 0.1, 1e-15);
  EXPECT_NEAR(world.velocity(0).linear_m_s.y - before.y, 0.2, 1e-15);
  EXPECT_NEAR(world.velocity(0).linear_m_s.z - before.z, 0.3, 1e-15);
}

TEST(ApiInputs, SleepMayBeTurnedOffAndOn) {
  World world(blockOnTheFloor());
  world.prepare();
  ASSERT_EQ(world.step(180), std::nullopt);
  ASSERT_TRUE(allAsleep(world));
  setSleep(world, Sleep::off);
  ASSERT_EQ(world.step(180), std::nullopt);
  EXPECT_FALSE(isAsleep(world, 0));
  EXPECT_TRUE(isAtRest(world));
  setSleep(world, Sleep::on);
  ASSERT_EQ(world.step(180), std::nullopt);
  EXPECT_TRUE(isAsleep(world, 0));
}

// Coulomb: what lies on a slope of 10 degrees stays with 0.4 and slides with 0.1, at g (sin - mu cos).
TEST(ApiInputs, FrictionDecidesWhetherABlockSlides) {
  Scene scene = blockOnTheFloor();
  scene.gravity.tilt_deg = 10.0;
  World world(scene);
  world.prepare();
  ASSERT_EQ(world.step(60), std::nullopt);
  EXPECT_NEAR(world.velocity(0).linear_m_s.x, 0.0, 1e-6);
  setFriction(world, 0.1, 0.1);
  ASSERT_EQ(world.step(60), std::nullopt);
  const double angle = 10.0 * std::acos(-1.0) / 180.0;
  const double speed_m_s = kGravity_m_s2 * (std::sin(angle) - 0.1 * std::cos(angle));  // after a second
  EXPECT_NEAR(world.velocity(0).linear_m_s.x, speed_m_s, 0.02 * speed_m_s);
}

TEST(Hand, LiftsABlockHoldsItsWeightAndTurnsIt) {
  World world(blockOnTheFloor());
  world.prepare();
  ASSERT_EQ(world.step(10), std::nullopt);
  EXPECT_EQ(handState(world).block, kFloor);
  grab(world, 0);
  EXPECT_EQ(handState(world).block, 0);
  EXPECT_EQ(handState(world).force_n, (Vec3{}));
  moveHand(world, {0.02, 0.0, 0.1}, 0.2);
  turnHand(world, {std::cos(0.2), 0.0, 0.0, std::sin(0.2)});
  ASSERT_EQ(world.step(120), std::nullopt);
  const HandState held = handState(world);
  EXPECT_EQ(held.place, (Vec3{0.02, 0.0, 0.1}));
  // 0.093 m of way at 0.2 m/s take half a second; the rest is left to the springs and to what takes up the weight.
  const Pose pose = world.pose(0);
  EXPECT_NEAR(pose.centre.x, 0.02, 1e-5);
  EXPECT_NEAR(pose.centre.z, 0.1, 1e-4);
  EXPECT_NEAR(held.force_n.z, kMass_kg * kGravity_m_s2, 0.01 * kMass_kg * kGravity_m_s2);
  EXPECT_FALSE(held.limited);
  EXPECT_NEAR(2.0 * std::atan2(pose.orientation.z, pose.orientation.w), 0.4, 1e-3);
  release(world);
  EXPECT_EQ(handState(world).block, kFloor);
  ASSERT_EQ(world.step(6), std::nullopt);
  EXPECT_NEAR(world.velocity(0).linear_m_s.z, -kGravity_m_s2 * 0.1, kGravity_m_s2 / 60.0);
}

// It is as strong as its limit and no stronger: 0.1 N do not lift a block of 0.19 N.
TEST(Hand, IsNoStrongerThanItsLimit) {
  World world(blockOnTheFloor());
  world.prepare();
  ASSERT_EQ(world.step(10), std::nullopt);
  const double start_m = world.pose(0).centre.z;
  grab(world, 0, 0.1);
  moveHand(world, {0.0, 0.0, 0.1});
  ASSERT_EQ(world.step(90), std::nullopt);
  const Vec3 force = handState(world).force_n;
  EXPECT_LE(std::hypot(force.x, force.y, force.z), 0.1 * (1.0 + 1e-9));
  EXPECT_TRUE(handState(world).limited);
  EXPECT_NEAR(world.pose(0).centre.z, start_m, world.tolerance_m());
}

TEST(Hand, PullsAlongALineAndIsLedOnFromThere) {
  World world(blockOnTheFloor());
  world.prepare();
  ASSERT_EQ(world.step(10), std::nullopt);
  pull(world, 0, {0.0, 3.0, 0.0}, 0.1);
  ASSERT_EQ(world.step(60), std::nullopt);
  EXPECT_NEAR(world.velocity(0).linear_m_s.y, 0.1, 1e-3);
  // Steadily: against friction alone.
  EXPECT_NEAR(handState(world).force_n.y, 0.4 * kMass_kg * kGravity_m_s2, 0.05 * 0.4 * kMass_kg * kGravity_m_s2);
  const double y_m = world.pose(0).centre.y;
  EXPECT_GT(y_m, 0.08);
  moveHand(world, {0.0, y_m, 0.05});
  ASSERT_EQ(world.step(90), std::nullopt);
  EXPECT_NEAR(world.pose(0).centre.z, 0.05, 1e-3);
  EXPECT_NEAR(world.pose(0).centre.y, y_m, 1e-3);
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A call that is refused, and what its message says.
struct Refusal {
  std::function<void()> call;
  const char* message;
};

std::vector<Refusal> refusedInputs(World& world) {
  return {
      {[&world] {
         applyForce(world, {0, 8, {}, 0.0, 1.0});
       },
       "force: corner: expected ..., got 8"},
      {[&world] {
         applyForce(world, {0, -1, {kNan, 0.0, 0.0}, 0.0, 1.0});
       },
       "force: force x: expected ..., got nan"},
      {[&world] {
         applyForce(world, {0, -1, {}, 1.0, 0.0});
       },
       "force: end: expected ..., got 0"},
      {[&world] {
         pushThroughFrame(world, 0, {0.0, kInfinity, 0.0});
       },
       "force: force y: expected ..., got inf"},
      {[&world] { setGravity(world, {kNan}); }, "gravity: magnitude: expected ..., got nan"},
      {[&world] {
         setGravity(world, {9.81, 181.0});
       },
       "gravity: tilt: expected ..., got 181"},
      {[&world] { setFriction(world, 0.4, 0.5); }, "kinetic friction: expected ..., got 0.5"},
      {[&world] { setSleep(world, static_cast<Sleep>(7)); }, "sleep: expected a number from 0 to 2, got 7"},
      {[&world] {
         kick(world, 0, {0.0, 0.0, kNan});
       },
       "kick: velocity: z: expected ..., got nan"},
      {[&world] {
         kick(world, 0, {1001.0, 0.0, 0.0});
       },
       "kick: velocity: x: expected ..., got 1001"},
  };
}

std::vector<Refusal> refusedHands(World& world) {
  return {
      {[&world] { grab(world, 0, 0.0); }, "grab: limit: expected ..., got 0"},
      {[&world] { moveHand(world, {}); }, "moveHand: expected a hand that has grabbed a block, got one that holds nothing"},
      {[&world] { turnHand(world, {}); }, "turnHand: expected a hand that has grabbed a block, got one that holds nothing"},
      {[&world] { pull(world, 0, {}); }, "pull: direction: expected a length above 0, got 0"},
      {[&world] {
         pull(world, 0, {kInfinity, 0.0, 0.0});
       },
       "pull: direction: x: expected ..., got inf"},
      {[&world] {
         pull(world, 0, {1.0, 0.0, 0.0}, 3.0);
       },
       "pull: speed: expected ..., got 3"},
      {[&world] {
         pull(world, 0, {1.0, 0.0, 0.0}, 0.1, kNan);
       },
       "pull: limit: expected ..., got nan"},
  };
}

TEST(ApiInputs, RefusesWhatIsNotAllowedAndChangesNothing) {
  World world(blockOnTheFloor());
  world.prepare();
  const std::uint64_t hash = world.stateHash();
  for (const Refusal& one : refusedInputs(world)) EXPECT_THAT(one.call, ThrowsMessage<InputError>(says(one.message)));
  for (const Refusal& one : refusedHands(world)) EXPECT_THAT(one.call, ThrowsMessage<InputError>(says(one.message)));
  grab(world, 0);
  EXPECT_THAT(
      [&] {
        moveHand(world, {0.0, kNan, 0.0});
      },
      ThrowsMessage<InputError>(says("moveHand: place: y: expected ..., got nan")));
  EXPECT_THAT([&] { moveHand(world, {}, 0.0); }, ThrowsMessage<InputError>(says("moveHand: speed: expected ..., got 0")));
  EXPECT_THAT([&] { turnHand(world, {0.9, 0.0, 0.0, 0.0}); }, ThrowsMessage<InputError>(HasSubstr("length of the quaternion")));
  release(world);
  EXPECT_EQ(world.stateHash(), hash);
  World untouched(blockOnTheFloor());
  untouched.prepare();
  ASSERT_EQ(world.step(10), std::nullopt);
  ASSERT_EQ(untouched.step(10), std::nullopt);
  EXPECT_EQ(world.stateHash(), untouched.stateHash());
}

TEST(ApiInputs, OfASceneInThePlaneStayInIt) {
  Scene scene = blockOnTheFloor();
  scene.plane = true;
  World world(scene);
  world.prepare();
  const auto outside = ThrowsMessage<InputError>(HasSubstr("for a motion in the plane y = 0"));
  EXPECT_THAT([&] { applyForce(world, {0, -1, {0.0, 1.0, 0.0}, 0.0, 1.0}); }, outside);
  EXPECT_THAT([&] { pushThroughFrame(world, 0, {0.0, 1.0, 0.0}); }, outside);
  EXPECT_THAT([&] { setGravity(world, {9.81, 5.0, 90.0}); }, outside);
  EXPECT_THAT([&] { kick(world, 0, {0.0, 1.0, 0.0}); }, outside);
  EXPECT_THAT([&] { pull(world, 0, {0.0, 1.0, 0.0}); }, outside);
  grab(world, 0);
  EXPECT_THAT([&] { moveHand(world, {0.0, 1.0, 0.0}); }, outside);
  EXPECT_THAT([&] { turnHand(world, {std::cos(0.2), std::sin(0.2), 0.0, 0.0}); }, outside);
  EXPECT_THAT([&] { turnHand(world, {std::cos(0.2), 0.0, 0.0, std::sin(0.2)}); }, outside);
  EXPECT_NO_THROW(turnHand(world, {std::cos(0.2), 0.0, std::sin(0.2), 0.0}));
}

}  // namespace
}  // namespace springtower::api
