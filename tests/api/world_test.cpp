// Worlds through their public interface, against closed forms and against the engine behind them.
#include "api/convert.h"
#include "solver/world/simulation.h"
#include "tests/support/allocations.h"
#include "tests/support/prepare_and_step.h"
#include "tests/support/says.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <oneapi/tbb/global_control.h>
#include <springtower/springtower.h>
#include <thread>
#include <vector>

namespace springtower::api {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// One block in the air, 1 m up.
Scene flyingBlock() {
  Scene scene;
  scene.floor = false;
  scene.blocks.resize(1);
  scene.blocks[0].centre = {0.0, 0.0, 1.0};
  return scene;
}

// A block with springs and contacts for one of 20 kg, which takes far too long steps.
Scene divergingScene() {
  Scene scene;
  scene.blocks.resize(2);
  scene.blocks[0].centre = {0.0, 0.0, 0.0283};
  scene.blocks[0].mass_kg = 19.6;
  scene.blocks[1].centre = {0.0, 0.0, 0.0101};
  scene.settings.method = Method::semiImplicitEuler;
  scene.settings.substeps = 60;
  scene.settings.tolerance_m = 5e-5;
  scene.settings.allowUnstable = true;
  scene.settings.sleep = Sleep::off;
  return scene;
}

// Frames until it fails, at most so many.
int framesToFailure(World& world, int most) {
  for (int frame = 0; frame < most; ++frame) {
    if (world.step()) return frame;
  }
  return most;
}

TEST(World, TakesTheStepsOfTheEngine) {
  Scene scene = towerScene(4, {.heightsSigma_m = 0.0002, .seed = 3});
  scene.forces.push_back({7, -1, {0.4, 0.1, 0.0}, 0.1, 0.3});
  World world(scene);
  world.prepare();
  springtower::Simulation simulation(toEngine(scene));
  for (int frame = 0; frame < 40; ++frame) {
    ASSERT_EQ(world.step(), std::nullopt);
    prepareAndStep(simulation);
    ASSERT_EQ(world.stateHash(), springtower::stateHash(simulation)) << "frame " << frame;
  }
  EXPECT_EQ(world.frame(), 40U);
  EXPECT_EQ(world.time_s(), 40 * (1.0 / 60.0));
  EXPECT_EQ(world.blockCount(), 12);
  EXPECT_EQ(world.tolerance_m(), simulation.tolerance_m);
  EXPECT_EQ(world.counters().frames, 40U);
  EXPECT_EQ(world.counters().steps, simulation.counters.steps);
  EXPECT_GT(world.counters().implicitSteps, 0U);
}

// It flies as Newton says. Steps of length dt leave an error of no more than half of g t dt in the height.
TEST(World, ABlockThatFliesFollowsItsParabola) {
  Scene scene = flyingBlock();
  scene.blocks[0].orientation = {std::cos(0.3), 0.0, 0.0, std::sin(0.3)};
  scene.blocks[0].velocity = {1.0, -0.5, 2.0};
  scene.blocks[0].spin = {0.0, 0.0, 2.0};
  World world(scene);
  world.prepare();
  const Pose start = world.pose(0);
  EXPECT_NEAR(start.centre.z, 1.0, 1e-15);
  EXPECT_NEAR(start.orientation.w, std::cos(0.3), 1e-12);
  EXPECT_NEAR(start.orientation.z, std::sin(0.3), 1e-12);
  EXPECT_NEAR(world.velocity(0).angular_rad_s.z, 2.0, 1e-12);
  ASSERT_EQ(world.step(30), std::nullopt);
  const double t = world.time_s();
  const Pose pose = world.pose(0);
  EXPECT_NEAR(pose.centre.x, t, 1e-9);
  EXPECT_NEAR(pose.centre.y, -0.5 * t, 1e-9);
  EXPECT_NEAR(pose.centre.z, 1.0 + 2.0 * t - 0.5 * 9.81 * t * t, 0.5 * 9.81 * t * world.frame_s());
  EXPECT_NEAR(world.velocity(0).linear_m_s.z, 2.0 - 9.81 * t, 0.5 * 9.81 * world.frame_s());
  // About its own z axis it turns steadily; elastic blocks widen as they spin, by far less than this.
  EXPECT_NEAR(2.0 * std::atan2(pose.orientation.z, pose.orientation.w), 0.6 + 2.0 * t, 1e-3);
}

TEST(World, CornersAreNumberedByTheSidesTheyLieOn) {
  World world(flyingBlock());
  world.prepare();
  const auto corners = world.corners(0);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    EXPECT_NEAR(corners[c].x, (c & 1U) != 0 ? 0.0405 : -0.0405, 1e-15);
    EXPECT_NEAR(corners[c].y, (c & 2U) != 0 ? 0.01335 : -0.01335, 1e-15);
    EXPECT_NEAR(corners[c].z, 1.0 + ((c & 4U) != 0 ? 0.0091 : -0.0091), 1e-15);
  }
  EXPECT_EQ(world.dimensions(0), (Vec3{0.081, 0.0267, 0.0182}));
  EXPECT_EQ(world.mass_kg(0), 0.0196);
}

TEST(World, AllPosesAtOnceAreThoseOfEachBlock) {
  World world(towerScene(2));
  world.prepare();
  ASSERT_EQ(world.step(5), std::nullopt);
  std::vector<Pose> poses(6);
  world.poses(poses);
  for (int block = 0; block < 6; ++block) {
    EXPECT_EQ(poses[static_cast<std::size_t>(block)].centre, world.pose(block).centre);
    EXPECT_EQ(poses[static_cast<std::size_t>(block)].orientation, world.pose(block).orientation);
  }
  EXPECT_THAT([&] { world.poses(std::span(poses).first(5)); },
              ThrowsMessage<InputError>(HasSubstr("expected room for 6, got room for 5")));
}

// What acts between frames is part of a snapshot: a hand under way, a force that is to come, one for the next frame, gravity.
TEST(Snapshots, BringInputsAndHandBack) {
  const Scene scene = towerScene(4);
  World world(scene);
  world.prepare();
  ASSERT_EQ(world.step(20), std::nullopt);
  pull(world, 4, {0.0, 1.0, 0.0}, 0.1);
  ASSERT_EQ(world.step(10), std::nullopt);
  applyForce(world, {10, -1, {0.2, 0.0, 0.0}, world.time_s() + 0.1, world.time_s() + 0.2});
  pushThroughFrame(world, 7, {0.1, 0.0, 0.0});
  setGravity(world, {.tilt_deg = 2.0});
  const Snapshot snapshot = world.snapshot();
  EXPECT_EQ(snapshot.time_s(), world.time_s());
  ASSERT_EQ(world.step(20), std::nullopt);
  const std::uint64_t hash = world.stateHash();

  release(world);
  clearForces(world);
  setGravity(world, {});
  setSleep(world, Sleep::off);
  ASSERT_EQ(world.step(3), std::nullopt);
  world.restore(snapshot);
  EXPECT_EQ(gravity(world).tilt_deg, 2.0);
  EXPECT_EQ(handState(world).block, 4);
  ASSERT_EQ(world.step(20), std::nullopt);
  EXPECT_EQ(world.stateHash(), hash);

  Scene renamed = scene;
  renamed.name = "the same by another name";
  renamed.seconds = 3.0;
  World other(renamed);
  other.prepare();
  other.restore(snapshot);
  ASSERT_EQ(other.step(20), std::nullopt);
  EXPECT_EQ(other.stateHash(), hash);
}

// Into another world, as of another process: through bytes, with a hand under way, a force that is to come and one for the next
// frame.
TEST(Snapshots, GoOnFromBytes) {
  Scene scene = towerScene(4, {.heightsSigma_m = 0.0001, .seed = 5});
  World world(scene);
  world.prepare();
  pull(world, 7, {0.0, 1.0, 0.0}, 0.05);
  ASSERT_FALSE(world.step(20));
  applyForce(world, {10, -1, {0.1, 0.0, 0.0}, 0.4, 0.5});
  pushThroughFrame(world, 9, {0.0, 0.0, -0.2});
  setGravity(world, {.magnitude_m_s2 = 9.0, .tilt_deg = 1.0, .direction_deg = 30.0});
  const std::vector<std::byte> bytes = world.snapshot().bytes();
  World other(scene);
  other.restore(Snapshot::fromBytes(bytes));
  EXPECT_EQ(other.time_s(), world.time_s());
  EXPECT_EQ(other.snapshot().bytes(), bytes);
  for (int frame = 0; frame < 30; ++frame) {
    ASSERT_FALSE(world.step());
    ASSERT_FALSE(other.step());
    ASSERT_EQ(other.stateHash(), world.stateHash()) << frame;
  }
  EXPECT_EQ(other.counters(), world.counters());
  EXPECT_EQ(handState(other).force_n.y, handState(world).force_n.y);
}

TEST(Snapshots, OfBytesThatAreCutOrChangedAreRefused) {
  World world(towerScene(1));
  world.prepare();
  const std::vector<std::byte> bytes = world.snapshot().bytes();
  for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 8)
    EXPECT_THROW(static_cast<void>(Snapshot::fromBytes(std::span(bytes).first(size))), InputError) << size;
  for (std::size_t at = 0; at < bytes.size(); at += 1 + at / 8) {
    std::vector<std::byte> changed = bytes;
    changed[at] ^= std::byte{4};
    EXPECT_THROW(static_cast<void>(Snapshot::fromBytes(changed)), InputError) << at;
  }
  EXPECT_THAT([&] { static_cast<void>(Snapshot::fromBytes({})); },
              ThrowsMessage<InputError>(says("snapshot: expected ..., got nothing")));
  EXPECT_THAT([&] { static_cast<void>(Snapshot().bytes()); }, ThrowsMessage<InputError>(HasSubstr("empty")));
  World larger(towerScene(2));
  EXPECT_THAT([&] { larger.restore(Snapshot::fromBytes(bytes)); }, ThrowsMessage<InputError>(HasSubstr("another scene")));
}

TEST(Snapshots, OfAnotherSceneAndEmptyOnesAreRefused) {
  World world(towerScene(2));
  Scene heavier = towerScene(2);
  heavier.blocks[3].mass_kg = 0.02;
  Scene softer = towerScene(2);
  softer.settings.stiffnessDamping = 1e-3;
  for (const Scene& scene : {heavier, softer, towerScene(3)}) {
    EXPECT_THAT([&] { world.restore(World(scene).snapshot()); }, ThrowsMessage<InputError>(HasSubstr("another scene")));
  }
  EXPECT_THAT([&] { world.restore(Snapshot()); },
              ThrowsMessage<InputError>(HasSubstr("expected a snapshot that a world has taken, got an empty one")));
  EXPECT_THAT([&] { static_cast<void>(Snapshot().time_s()); }, ThrowsMessage<InputError>(HasSubstr("empty")));
  EXPECT_EQ(world.stateHash(), World(towerScene(2)).stateHash());
}

TEST(World, ASimulationThatFailsIsAValue) {
  World world(divergingScene());
  world.prepare();
  const Snapshot start = world.snapshot();
  const std::uint64_t hash = world.stateHash();
  const int frames = framesToFailure(world, 600);
  ASSERT_LT(frames, 600);
  const std::optional<Divergence> failed = world.divergence();
  ASSERT_TRUE(failed.has_value());
  EXPECT_EQ(failed->block, 1);
  EXPECT_NEAR(failed->time_s, world.time_s(), 1.001 * world.frame_s());
  EXPECT_THAT(failed->cause, HasSubstr("block 1 diverged"));

  const auto again = world.step();
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->time_s, failed->time_s);
  EXPECT_THAT([&] { static_cast<void>(world.pose(0)); }, ThrowsMessage<InputError>(HasSubstr("block 1 diverged")));
  EXPECT_THAT([&] { kick(world, 0, {}); }, ThrowsMessage<InputError>(HasSubstr("restore a snapshot")));
  EXPECT_THAT([&] { static_cast<void>(world.snapshot()); }, ThrowsMessage<InputError>(HasSubstr("has failed")));

  world.restore(start);
  EXPECT_EQ(world.divergence(), std::nullopt);
  EXPECT_EQ(world.stateHash(), hash);
  EXPECT_EQ(framesToFailure(world, 600), frames);
  ASSERT_TRUE(world.divergence().has_value());
  EXPECT_EQ(world.divergence()->time_s, failed->time_s);
}

TEST(World, IsPreparedOnceBeforeItsFirstStep) {
  World world(towerScene(6));
  EXPECT_THAT([&] { static_cast<void>(world.step()); },
              ThrowsMessage<InputError>(says("step: expected a world after prepare(), got one that is not")));
  EXPECT_THAT([&] { static_cast<void>(world.prepare({.budget_s = -1.0})); },
              ThrowsMessage<InputError>(HasSubstr("expected a budget of 0 s or more, got -1")));
  int calls = 0;
  const Preparation done = world.prepare({.goesOn = [&](const PrepareProgress& now) {
    ++calls;
    EXPECT_EQ(now.blocks, 18);
    return true;
  }});
  EXPECT_GE(calls, 1);
  EXPECT_EQ(done.end, Preparation::End::complete);
  EXPECT_EQ(done.blocksInBalance, 18);
  EXPECT_THAT([&] { static_cast<void>(world.prepare()); },
              ThrowsMessage<InputError>(HasSubstr("expected a world that is not prepared, got one that is")));
  EXPECT_EQ(world.step(60), std::nullopt);
}

TEST(World, WithoutTimeItStartsAsPlaced) {
  World world(towerScene(6));
  const Pose placed = world.pose(17);
  const Preparation done = world.prepare({.budget_s = 0.0});
  EXPECT_EQ(done.end, Preparation::End::outOfTime);
  EXPECT_EQ(done.blocksInBalance, 0);
  EXPECT_EQ(world.pose(17).centre, placed.centre);
}

TEST(World, RefusesBlocksThatAreNotThere) {
  World world(towerScene(1));
  world.prepare();
  for (const int block : {-1, 3, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    const auto message = ThrowsMessage<InputError>(HasSubstr("expected 0 to 2, got " + std::to_string(block)));
    EXPECT_THAT([&] { static_cast<void>(world.pose(block)); }, message);
    EXPECT_THAT([&] { static_cast<void>(world.velocity(block)); }, message);
    EXPECT_THAT([&] { static_cast<void>(world.corners(block)); }, message);
    EXPECT_THAT([&] { static_cast<void>(world.dimensions(block)); }, message);
    EXPECT_THAT([&] { static_cast<void>(world.mass_kg(block)); }, message);
    EXPECT_THAT([&] { static_cast<void>(contactsOn(world, block)); }, message);
    EXPECT_THAT([&] { static_cast<void>(isAsleep(world, block)); }, message);
    EXPECT_THAT([&] { static_cast<void>(islandOf(world, block)); }, message);
    EXPECT_THAT([&] { kick(world, block, {}); }, message);
    EXPECT_THAT([&] { pushThroughFrame(world, block, {}); }, message);
    EXPECT_THAT([&] { grab(world, block); }, message);
    EXPECT_THAT([&] { pull(world, block, {1.0, 0.0, 0.0}); }, message);
    EXPECT_THAT([&] { applyForce(world, {block, -1, {}, 0.0, 1.0}); }, ThrowsMessage<InputError>(HasSubstr("expected 0 to 2")));
  }
  EXPECT_THAT([&] { static_cast<void>(world.step(-1)); },
              ThrowsMessage<InputError>(HasSubstr("expected 0 or more frames, got -1")));
}

TEST(World, RefusesScenesThatAreNotAllowed) {
  EXPECT_THAT([] { World world{Scene{}}; }, ThrowsMessage<InputError>(says("scene: number of blocks: expected ..., got 0")));
  Scene scene = towerScene(1);
  scene.blocks[1].centre.y += 0.001;
  scene.name = "two\nlines";
  EXPECT_THAT([&] { World world(scene); }, ThrowsMessage<InputError>(HasSubstr("two\\x0alines: block 1")));
  scene = towerScene(1);
  scene.settings.method = static_cast<Method>(99);
  EXPECT_THAT([&] { World world(scene); },
              ThrowsMessage<InputError>(HasSubstr("method: expected a number from 0 to 10, got 99")));
  scene = towerScene(1);
  scene.blocks[2].orientation = {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0, 0.0};
  EXPECT_THAT([&] { World world(scene); }, ThrowsMessage<InputError>(HasSubstr("got nan")));
}

TEST(World, MayBeMovedAndIsEmptyThen) {
  World world(towerScene(1));
  world.prepare();
  const std::uint64_t hash = world.stateHash();
  World other = std::move(world);
  EXPECT_EQ(other.stateHash(), hash);
  // NOLINTNEXTLINE(bugprone-use-after-move)
  EXPECT_THAT([&] { static_cast<void>(world.time_s()); }, ThrowsMessage<InputError>(HasSubstr("moved from")));
  world = World(towerScene(2));
  EXPECT_EQ(world.blockCount(), 6);
}

TEST(World, ReplacesTheMethodThatIsAutomatic) {
  Scene scene = towerScene(2);
  scene.settings.method = Method::automatic;
  EXPECT_EQ(World(scene).method(), Method::implicit);
}

// Worlds share nothing: each thread has one of its own, and finds what one world alone finds.
TEST(World, ManyRunSideBySide) {
  const auto run = [](int tower) {
    Scene scene = towerScene(5, {.heightsSigma_m = 0.0002, .seed = static_cast<std::uint64_t>(tower)});
    scene.gravity.tilt_deg = 14.0;
    World world(scene);
    world.prepare();
    return world.step(40) ? 0 : world.stateHash();
  };
  constexpr int kWorlds = 4;
  std::vector<std::uint64_t> together(kWorlds);
  {
    std::vector<std::jthread> threads;
    for (int tower = 0; tower < kWorlds; ++tower)
      threads.emplace_back([&, tower] { together[static_cast<std::size_t>(tower)] = run(tower); });
  }
  const ThreadLimit oneThread(1);
  for (int tower = 0; tower < kWorlds; ++tower) {
    EXPECT_NE(together[static_cast<std::size_t>(tower)], 0U);
    EXPECT_EQ(run(tower), together[static_cast<std::size_t>(tower)]) << "tower " << tower;
  }
}

TEST(ThreadLimit, CountsWhileItLives) {
  const auto allowed = [] { return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism); };
  const std::size_t before = allowed();
  {
    const ThreadLimit two(2);
    EXPECT_EQ(allowed(), 2U);
    {
      const ThreadLimit one(1);
      EXPECT_EQ(allowed(), 1U);
    }
    const ThreadLimit three(3);
    EXPECT_EQ(allowed(), 2U);
  }
  EXPECT_EQ(allowed(), before);
}

TEST(ThreadLimit, RefusesNumbersThatAreNone) {
  EXPECT_THAT([] { const ThreadLimit none(0); }, ThrowsMessage<InputError>(HasSubstr("threads: expected 1 to 4096, got 0")));
}

// Frames that have run once run again without a call to the allocator, and poses are read without one.
TEST(World, AllocatesNothingInFramesThatAreOrdinary) {
  const ThreadLimit oneThread(1);
  World world(towerScene(6));
  world.prepare();
  ASSERT_EQ(world.step(2), std::nullopt);
  const Snapshot snapshot = world.snapshot();
  ASSERT_EQ(world.step(30), std::nullopt);
  world.restore(snapshot);
  std::vector<Pose> poses(18);
  const long before = allocationsOfThisThread();
  bool failed = false;
  for (int frame = 0; frame < 30; ++frame) {
    failed = world.step().has_value() || failed;
    world.poses(poses);
    static_cast<void>(world.velocity(3));
    static_cast<void>(world.stateHash());
  }
  EXPECT_EQ(allocationsOfThisThread() - before, 0);
  EXPECT_FALSE(failed);
}

TEST(BuildInfo, NamesVersionAndCompiler) {
  EXPECT_FALSE(buildInfo().version.empty());
  EXPECT_FALSE(buildInfo().compiler.empty());
}

}  // namespace
}  // namespace springtower::api
