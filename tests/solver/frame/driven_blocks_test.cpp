#include "core/error.h"
#include "core/scene/rotation.h"
#include "core/scene/scene.h"
#include "core/tuning.h"
#include "solver/metrics/penetration.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"
#include "tests/support/allocations.h"
#include "tests/support/block_scenes.h"
#include "tests/support/method_names.h"
#include "tests/support/prepare_and_step.h"
#include "tests/support/says.h"

#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>
#include <oneapi/tbb/global_control.h>
#include <string>
#include <utility>
#include <vector>

namespace springtower {
namespace {

constexpr double kTableFriction = 0.4;  // of friction, in these scenes
constexpr double kTableTop_m = 0.3;
constexpr double kHalfTurn = std::numbers::pi;

BlockSpec restingAt(double x_m, double ground_m) {
  BlockSpec block;
  block.centre = {x_m, 0.0, ground_m + 0.5 * kBlockHeight_m};
  return block;
}

// A table, whose top is at kTableTop_m, with these drives, and blocks on it.
Scene tableScene(Method method, std::vector<Drive> drives, std::vector<BlockSpec> blocks, Sleep sleep = Sleep::off) {
  Scene scene;
  scene.name = "driven";
  BlockSpec table;
  table.dimensions = {1.0, 0.4, 0.05};
  table.centre = {0.0, 0.0, kTableTop_m - 0.025};
  table.fixed = true;
  scene.blocks = {table};
  scene.blocks.insert(scene.blocks.end(), blocks.begin(), blocks.end());
  scene.drives = std::move(drives);
  scene.settings.method = method;
  scene.settings.reportFrictionDrag = 0.0;  // theory has none
  scene.settings.sleep = sleep;
  return scene;
}

double placeX(const Simulation& simulation, std::size_t block) {
  return centre(simulation.state.position, block).x();
}

struct DrivenBlocks : ::testing::TestWithParam<Method> {};
struct DrivenBlocksThatHold : DrivenBlocks {};  // by methods with static friction

INSTANTIATE_TEST_SUITE_P(Methods, DrivenBlocks,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::semiImplicitEuler, Method::midpoint,
                                           Method::rungeKutta4, Method::report, Method::rigidPgs, Method::rigidLcp, Method::xpbd),
                         methodName);
INSTANTIATE_TEST_SUITE_P(Methods, DrivenBlocksThatHold,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::semiImplicitEuler, Method::midpoint,
                                           Method::rungeKutta4, Method::rigidPgs, Method::rigidLcp, Method::xpbd),
                         methodName);

TEST(Drives, MoveByAFunctionOfTime) {
  Drive line;
  line.velocity = {0.2, 0.0, 0.0};
  line.start_s = 1.0;
  line.end_s = 3.0;
  Drive swing;
  swing.amplitude = {0.0, 0.01, 0.0};
  swing.frequency_hz = 0.5;
  Drive turn;
  turn.spin = {0.0, 0.0, 0.5};
  Drive other = line;
  other.block = 1;
  const std::vector<Drive> drives = {line, swing, turn, other};
  const Vec3 start(1.0, 2.0, 3.0);
  const DrivenPose early = drivenPose(drives, 0, start, 0.1, 0.5);
  EXPECT_LT((early.centre - Vec3(1.0, 2.01, 3.0)).norm(), 1e-15) << "a quarter period";
  EXPECT_LT((early.velocity - Vec3(0.0, 0.01 * kHalfTurn, 0.0)).norm(), 1e-15);
  const DrivenPose late = drivenPose(drives, 0, start, 0.1, 7.0);
  EXPECT_LT((late.centre - Vec3(1.4, 2.02, 3.0)).norm(), 1e-14) << "3.5 periods";
  EXPECT_LT(late.velocity.norm(), 1e-14);
  EXPECT_NEAR(Eigen::AngleAxisd(late.turn).angle(), 2.0 * kHalfTurn - 3.5, 1e-12) << "3.5 rad, the short way round";
  EXPECT_GE(late.travel_m, 0.4 + 0.1 * 3.5 + 14 * 0.01);
}

// The farthest a block moves on a table that swings with this share of the friction limit mu g, m; without the first half period,
// as the swing begins with a jerk at which elastic contacts overshoot.
double slipOnShakenTable(Method method, double share) {
  Drive shake;
  shake.frequency_hz = 1.0;
  const double rate = 2.0 * kHalfTurn * shake.frequency_hz;
  shake.amplitude.x() = share * kTableFriction * kStandardGravity_m_s2 / (rate * rate);
  shake.start_s = 0.2;
  Simulation simulation(tableScene(method, {shake}, {restingAt(0.0, kTableTop_m)}));
  stepFor(simulation, 0.7);
  const double before_m = placeX(simulation, 1) - placeX(simulation, 0);
  double most_m = 0.0;
  while (simulation.time_s < 2.2) {
    prepareAndStep(simulation);
    most_m = std::max(most_m, std::abs(placeX(simulation, 1) - placeX(simulation, 0) - before_m));
  }
  return most_m;
}

TEST_P(DrivenBlocksThatHold, CarryABlockUpToTheFrictionLimit) {
  EXPECT_LT(slipOnShakenTable(GetParam(), 0.97), 1e-4);
  EXPECT_GT(slipOnShakenTable(GetParam(), 1.03), 1e-4);
}

// The report has kinetic friction alone: what should stick slips.
TEST(DrivenBlocksOfTheReport, LetABlockSlipBelowTheFrictionLimit) {
  EXPECT_GT(slipOnShakenTable(Method::report, 0.97), 1e-3);
}

// A block laid at rest on a conveyor is accelerated by mu g until it moves with it: after v / (mu g), v^2 / (2 mu g) behind.
TEST_P(DrivenBlocks, DragABlockAlong) {
  constexpr double kSpeed_m_s = 0.5;
  constexpr double kAcceleration = kTableFriction * kStandardGravity_m_s2;
  Drive conveyor;
  conveyor.velocity.x() = kSpeed_m_s;
  conveyor.start_s = 0.2;
  Simulation simulation(tableScene(GetParam(), {conveyor}, {restingAt(0.0, kTableTop_m)}));
  stepFor(simulation, 0.3);
  EXPECT_NEAR(centre(simulation.state.velocity, 1).x(), 0.1 * kAcceleration, 0.02 * 0.1 * kAcceleration)
      << "velocity in the middle";
  stepFor(simulation, 0.4);
  EXPECT_NEAR(centre(simulation.state.velocity, 1).x(), kSpeed_m_s, 1e-3);
  const double behind_m = placeX(simulation, 0) - placeX(simulation, 1);
  const double theory_m = kSpeed_m_s * kSpeed_m_s / (2.0 * kAcceleration);
  // Implicit Euler and the complementarity problem, of first order, move by the velocity of a step's end: half a step ahead.
  double steps = 0.0;
  if (GetParam() == Method::implicitEuler) steps = tuning::kStandardImplicitSteps;
  if (GetParam() == Method::rigidLcp) steps = tuning::kLcpSubsteps;
  const double early_m = steps > 0.0 ? 0.5 * kSpeed_m_s * simulation.scene.settings.frame_s / steps : 0.0;
  EXPECT_NEAR(behind_m, theory_m - early_m, 0.02 * theory_m);
}

// A wall without friction holds a block on a conveyor. It slips against the conveyor, not against the ground: kinetic friction
// presses it on the wall, with half of what static friction would.
TEST_P(DrivenBlocksThatHold, SlideBelowABlockThatAWallHolds) {
  BlockSpec wall;
  wall.dimensions = {0.02, 0.2, 0.1};
  wall.centre = {0.5 * (kBlockLength_m + 0.02), 0.0, kTableTop_m + 0.06};
  wall.fixed = true;
  wall.friction = Friction{0.0, 0.0};
  Drive conveyor;
  conveyor.velocity.x() = 0.1;
  Scene scene = tableScene(GetParam(), {conveyor}, {restingAt(0.0, kTableTop_m), wall});
  scene.kineticFriction = 0.5 * kTableFriction;
  scene.staticFriction = kTableFriction;
  Simulation simulation(scene);
  stepFor(simulation, 0.5);
  double pressed_n = 0.0;
  const int frames = 60;
  for (int frame = 0; frame < frames; ++frame) {
    prepareAndStep(simulation);
    for (const ContactForce& contact : contactForces(simulation)) {
      if (index(contact.upper) == 2 || (contact.lower != kFloor && index(contact.lower) == 2))
        pressed_n += contact.normalForce / frames;
    }
  }
  const double kinetic_n = 0.5 * kTableFriction * kBlockMass_kg * kStandardGravity_m_s2;
  EXPECT_NEAR(pressed_n, kinetic_n, 0.03 * kinetic_n);
}

// The pusher begins at once: a rebounding block is caught up with, as friction stops it.
TEST_P(DrivenBlocks, PushABlockAlongTheFloor) {
  Scene scene = tableScene(GetParam(), {}, {restingAt(0.0, 0.0)});
  scene.blocks[0].dimensions = {0.05, 0.2, 0.1};
  scene.blocks[0].centre = {-0.5 * kBlockLength_m - 0.025, 0.0, 0.06};
  Drive push;
  push.velocity.x() = 0.1;
  push.start_s = 0.1;
  scene.drives = {push};
  Simulation simulation(scene);
  stepFor(simulation, 1.1);
  const double gap_m = placeX(simulation, 1) - placeX(simulation, 0) - 0.5 * kBlockLength_m - 0.025;
  EXPECT_NEAR(placeX(simulation, 0), scene.blocks[0].centre.x() + 0.1, 1e-12);
  EXPECT_GT(gap_m, -2e-4);
  EXPECT_LT(gap_m, 5e-3);
}

TEST_P(DrivenBlocks, LiftAStack) {
  Drive lift;
  lift.amplitude.z() = 0.025;  // to twice this and, a whole period later, back
  lift.frequency_hz = 1.0;
  lift.end_s = 0.5;
  const auto at = [](int row) {
    BlockSpec block = restingAt(0.0, kTableTop_m);
    block.centre.z() += row * kBlockHeight_m;
    return block;
  };
  Simulation simulation(tableScene(GetParam(), {lift}, {at(0), at(1), at(2)}));
  PenetrationWorkspace workspace;
  const double allowed_m = GetParam() == Method::report ? 5e-4 : 2e-4;
  while (simulation.time_s < 0.8) {
    prepareAndStep(simulation);
    EXPECT_LT(maxPenetration(simulation.state.position, true, workspace, simulation.model.fixed).depth, allowed_m);
  }
  for (std::size_t b = 1; b < 4; ++b) {
    const Vec3 moved = centre(simulation.state.position, b) - simulation.scene.blocks[b].centre;
    EXPECT_NEAR(moved.z(), 0.05, allowed_m) << "block " << b;
    EXPECT_LT(std::hypot(moved.x(), moved.y()), allowed_m) << "block " << b;
  }
}

// Whatever its speed, a plate does not pass through what it hits.
TEST_P(DrivenBlocks, DoNotPassThroughWhatTheyHit) {
  for (const double speed_m_s : {1.0, 10.0}) {
    Scene scene = tableScene(GetParam(), {}, {restingAt(0.0, 0.0)});
    scene.floor = false;
    scene.gravity.magnitude = 0.0;
    scene.blocks[0].dimensions = {0.02, 0.2, 0.2};
    scene.blocks[0].centre = {-0.2, 0.0, 0.0};
    Drive hit;
    hit.velocity.x() = speed_m_s;
    scene.drives = {hit};
    Simulation simulation(scene);
    for (int frame = 0; frame < 30; ++frame) {
      prepareAndStep(simulation);
      EXPECT_GT(placeX(simulation, 1), placeX(simulation, 0) + 0.8 * 0.5 * kBlockLength_m)
          << speed_m_s << " m/s, frame " << frame;
    }
    EXPECT_GT(centre(simulation.state.velocity, 1).x(), 0.99 * speed_m_s);
  }
}

// On a turntable that starts with a jerk a block slips by about v^2 / (2 mu g), and then turns with it.
TEST_P(DrivenBlocks, TurnABlockAround) {
  Drive turn;
  turn.spin.z() = 2.0;
  turn.start_s = 0.1;
  turn.end_s = 0.1 + 0.5 * kHalfTurn;  // half a turn
  Simulation simulation(tableScene(GetParam(), {turn}, {restingAt(0.1, kTableTop_m)}));
  stepFor(simulation, 2.0);
  const Vec3 place = centre(simulation.state.position, 1);
  EXPECT_NEAR(std::hypot(place.x(), place.y()), 0.1, 3e-3);
  EXPECT_LT(place.x(), -0.095);
  const double slip_m = 0.2 * 0.2 / (2.0 * kTableFriction * kStandardGravity_m_s2);
  EXPECT_LT(std::abs(place.y()), 3.0 * slip_m);
}

TEST_P(DrivenBlocks, GiveTheSameBitsOnAnyNumberOfThreadsAndAfterASnapshot) {
  Drive shake;
  shake.amplitude = {0.01, 0.0, 0.0};
  shake.frequency_hz = 4.0;
  const Scene scene =
      tableScene(GetParam(), {shake}, {restingAt(-0.2, kTableTop_m), restingAt(0.2, kTableTop_m), restingAt(0.0, 0.0)});
  std::array<std::uint64_t, 2> hash{};
  for (const std::size_t threads : {1U, 2U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Simulation simulation(scene);
    stepFor(simulation, 0.1);
    const std::shared_ptr<const Snapshot> snapshot = takeSnapshot(simulation);
    stepFor(simulation, 0.1);
    hash[threads - 1] = stateHash(simulation);
    restoreSnapshot(simulation, *snapshot);
    stepFor(simulation, 0.1);
    EXPECT_EQ(stateHash(simulation), hash[threads - 1]);
  }
  EXPECT_EQ(hash[0], hash[1]);
}

// As tests/solver/frame/allocation_test.cpp has it for towers.
TEST_P(DrivenBlocks, NeedNoAllocationWhenFramesRunAgain) {
  const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
  Drive shake;
  shake.amplitude.x() = 0.01;
  shake.frequency_hz = 4.0;
  shake.start_s = 0.05;
  BlockSpec upper = restingAt(-0.2, kTableTop_m);
  upper.centre.z() += kBlockHeight_m;
  Simulation simulation(tableScene(GetParam(), {shake}, {restingAt(-0.2, kTableTop_m), upper, restingAt(0.2, kTableTop_m)}));
  prepareAndStep(simulation);
  const std::shared_ptr<const Snapshot> snapshot = takeSnapshot(simulation);
  stepFor(simulation, 0.2);
  restoreSnapshot(simulation, *snapshot);
  const long before = allocationsOfThisThread();
  stepFor(simulation, 0.2);
  EXPECT_EQ(allocationsOfThisThread() - before, 0);
}

// While it moves, all that is near a driven block is one island; a fixed one joins nothing.
TEST(DrivenTable, JoinsIslandsWhileItMoves) {
  Drive shake;
  shake.velocity.x() = 0.01;
  shake.end_s = 0.5;
  Simulation simulation(tableScene(Method::implicit, {shake}, {restingAt(-0.2, kTableTop_m), restingAt(0.2, kTableTop_m)}));
  stepFor(simulation, 0.2);
  EXPECT_EQ(simulation.engine->memo.islands.count(), 1U);
  stepFor(simulation, 0.5);
  EXPECT_EQ(simulation.engine->memo.islands.count(), 2U);
}

TEST(DrivenTable, WakesWhatSleepsOnIt) {
  Drive shake;
  shake.velocity.x() = 0.1;
  shake.start_s = 3.0;
  shake.end_s = 4.0;
  BlockSpec upper = restingAt(0.0, kTableTop_m);
  upper.centre.z() += kBlockHeight_m;
  Simulation simulation(tableScene(Method::implicit, {shake}, {restingAt(0.0, kTableTop_m), upper}, Sleep::on));
  stepFor(simulation, 2.9);
  EXPECT_TRUE(allAsleep(simulation));
  stepFor(simulation, 0.6);
  EXPECT_EQ(simulation.asleep, (std::vector<std::uint8_t>{1, 0, 0}));
  stepFor(simulation, 3.5);
  EXPECT_TRUE(allAsleep(simulation));
  const double slip_m = 0.1 * 0.1 / (2.0 * kTableFriction * kStandardGravity_m_s2);  // at its start and its end
  for (std::size_t b = 1; b < 3; ++b) EXPECT_NEAR(placeX(simulation, b), 0.1, 2.0 * slip_m) << "block " << b;
}

TEST(DrivesInput, AreChecked) {
  const auto messageOf = [](const Drive& drive) -> std::string {
    try {
      checkScene(tableScene(Method::implicit, {drive}, {restingAt(0.0, kTableTop_m)}), "scene");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Drive drive;
  EXPECT_EQ(messageOf(drive), "scene: drive 0: expected at least one of a velocity, a spin and an amplitude, got none");
  drive.velocity.x() = 1.0;
  EXPECT_EQ(messageOf(drive), "");
  drive.block = 1;
  EXPECT_EQ(messageOf(drive), "scene: drive 0: block: expected a fixed block, got block 1, which is not fixed");
  drive.block = 2;
  EXPECT_EQ(messageOf(drive), "scene: drive 0: block: expected 0 to 1, got 2");
  drive.block = 0;
  drive.frequency_hz = 1.0;
  EXPECT_EQ(messageOf(drive), "scene: drive 0: expected both an amplitude and a frequency or neither, got one without the other");
  drive.amplitude.x() = 10.0;
  drive.frequency_hz = 100.0;
  EXPECT_THAT(messageOf(drive), says("fastest corner: expected ..., got 6284"));
  drive.start_s = 2.0;
  drive.end_s = 1.0;
  EXPECT_EQ(messageOf(drive), "scene: drive 0: end: expected 2 to 10000000 s, got 1");
}

}  // namespace
}  // namespace springtower
