#include "solver/hand/grip.h"

#include "core/tuning.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

constexpr double kFrame_s = 1.0 / 60.0;
constexpr double kStep_m = 0.1;
constexpr int kSettled = 9;  // frames in 0.15 s

Scene blockInTheAir() {
  Scene scene = oneBlockScene(false);
  scene.blocks[0].centre.z() = 1.0;
  return scene;
}

// A simulation and the hand that acts on it.
struct Held {
  explicit Held(const Scene& scene) : simulation(scene) {}
  Simulation simulation;
  Grip grip;
  GripForce force;
};

void step(Held& held, const Hand& hand) {
  hold(hand, contactForces(held.simulation), held.grip, held.simulation);
  prepareAndStep(held.simulation);
  held.force = gripForce(held.simulation);
}

void wait(Held& held, int frames) {
  for (int i = 0; i < frames; ++i) prepareAndStep(held.simulation);
}

// Moves the hand in a straight line by `way` at a speed, then holds it still for a time.
void lead(Held& held, Hand& hand, const Vec3& way, double speed_m_s, double still_s = 0.2) {
  const int frames = std::max(1, static_cast<int>(std::ceil(way.norm() / (speed_m_s * kFrame_s))));
  const Vec3 from = hand.place;
  for (int i = 1; i <= frames; ++i) {
    hand.place = from + way * (static_cast<double>(i) / frames);
    step(held, hand);
  }
  for (int i = 0; i < std::lround(still_s / kFrame_s); ++i) step(held, hand);
}

Hold holdOf(const Held& held, BlockId block) {
  return holdOf(contactForces(held.simulation), block);
}

// Largest depth of contacts and of geometry over a run.
double deepest(Held& held, const Hand& hand, int frames) {
  PenetrationWorkspace workspace;
  double depth = 0.0;
  for (int i = 0; i < frames; ++i) {
    step(held, hand);
    depth = std::max(depth, maxPenetration(held.simulation.state.position, true, workspace).depth);
  }
  return depth;
}

TEST(Grip, TheClosedFormFallsAndIsSettledInTime) {
  double last = 1.0;
  for (int k = 1; k <= 60; ++k) {
    const double now = followCourse(tuning::kFollowFrequency_rad_s, k * kFrame_s);
    EXPECT_LT(now, last);
    EXPECT_GT(now, 0.0);  // never beyond: no overshoot at all
    last = now;
  }
  EXPECT_LT(followCourse(tuning::kFollowFrequency_rad_s, kSettled * kFrame_s), 0.02);
}

// Simulated path of a held block against the closed form: overshoot under 2 % and settled in 0.15 s.
TEST(Grip, ABlockInTheAirFollowsCriticallyDamped) {
  struct Engine {
    Method method;
    Inertia inertia;
  };
  for (const auto& [method, inertia] :
       {Engine{Method::semiImplicitEuler, Inertia::cuboid}, Engine{Method::semiImplicitEuler, Inertia::lumped},
        Engine{Method::implicit, Inertia::cuboid}}) {
    for (const Vec3& direction : {Vec3(1.0, 0.0, 0.0), Vec3(0.0, -1.0, 0.0), Vec3(0.0, 0.0, 1.0), Vec3(0.6, 0.0, -0.8)}) {
      Scene scene = blockInTheAir();
      scene.settings.inertia = inertia;
      scene.settings.method = method;
      Held held(scene);
      Hand hand = handOn(held.simulation, blockId(0));
      const Vec3 target = hand.place + kStep_m * direction;
      hand.place = target;
      for (int k = 1; k <= 60; ++k) {
        step(held, hand);
        const Vec3 missing = target - centre(held.simulation.state.position, 0);
        EXPECT_NEAR(missing.dot(direction), kStep_m * followCourse(tuning::kFollowFrequency_rad_s, k * kFrame_s), 0.012 * kStep_m)
            << k;
        EXPECT_GT(missing.dot(direction), -0.02 * kStep_m) << k;
        EXPECT_LT((missing - missing.dot(direction) * direction).norm(), 1e-3 * kStep_m) << k;
        if (k >= kSettled) {
          EXPECT_LT(missing.norm(), 0.02 * kStep_m) << k;
        }
      }
      EXPECT_LT((target - centre(held.simulation.state.position, 0)).norm(), 1e-6);
    }
  }
}

TEST(Grip, AFarStepAtFullForceDoesNotOvershootEither) {
  Held held(blockInTheAir());
  Hand hand = handOn(held.simulation, blockId(0));
  const double start = hand.place.x();
  hand.place.x() += 1.0;
  double most = 0.0;
  bool limited = false;
  for (int k = 0; k < 90; ++k) {
    step(held, hand);
    most = std::max(most, centre(held.simulation.state.position, 0).x() - start);
    limited = limited || held.force.limited;
    EXPECT_LE(held.force.force.norm(), tuning::kGripForce_n + 1e-12);
  }
  EXPECT_TRUE(limited);
  EXPECT_LT(most, 1.02);
  EXPECT_NEAR(centre(held.simulation.state.position, 0).x() - start, 1.0, 1e-3);
}

TEST(Grip, TurnsTheBlockWithoutOvershoot) {
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
    Held held(blockInTheAir());
    Hand hand = handOn(held.simulation, blockId(0));
    const double angle = 0.5;
    hand.turn = Eigen::AngleAxisd(angle, axis) * hand.turn;
    for (int k = 1; k <= 40; ++k) {
      step(held, hand);
      const Eigen::AngleAxisd left(hand.turn * orientationOf(held.simulation.state.position, 0).conjugate());
      EXPECT_GT(left.angle() * left.axis().dot(axis), -0.02 * angle) << k;
      if (k >= kSettled) {
        EXPECT_LT(std::abs(left.angle()), 0.02 * angle) << k;
      }
    }
    EXPECT_LT((centre(held.simulation.state.position, 0) - hand.place).norm(), 1e-5);
  }
}

TEST(Grip, ForcesAtTheCornersAddUp) {
  Simulation simulation(blockInTheAir());
  Grip grip;
  Hand hand = handOn(simulation, blockId(0));
  hold(hand, {}, grip, simulation);
  simulation.tether.place += Vec3(0.004, -0.01, 0.002);
  simulation.tether.turn = Eigen::AngleAxisd(0.01, Vec3(0.6, 0.0, 0.8)) * hand.turn;
  for (const double torqueLimit : {1.0, 1e-3}) {
    simulation.tether.torqueLimit_n_m = torqueLimit;
    std::array<Vec3, kCorners> corner;
    const GripForce sum = tetherForces(simulation.tether, simulation.model, simulation.state, simulation.tether.time_s, corner);
    const Vec3 middle = centre(simulation.state.position, 0);
    Vec3 force = Vec3::Zero();
    Vec3 torque = Vec3::Zero();
    for (std::size_t c = 0; c < kCorners; ++c) {
      force += corner[c];
      torque += (simulation.state.position.at(0, c) - middle).cross(corner[c]);
    }
    EXPECT_LT((force - sum.force).norm(), 1e-11);
    EXPECT_LT((torque - sum.torque).norm(), 1e-12);
    EXPECT_LE(sum.torque.norm(), torqueLimit * (1.0 + 1e-12));
    EXPECT_GT(sum.torque.norm(), 0.99e-3);
  }
}

// The hand acts on a block's edges: warps are left to the springs, which the matrix of implicit steps relies on.
TEST(Grip, LeavesWarpsToTheBlock) {
  Simulation simulation(blockInTheAir());
  Grip grip;
  hold(handOn(simulation, blockId(0)), {}, grip, simulation);
  std::array<Vec3, kCorners> before;
  tetherForces(simulation.tether, simulation.model, simulation.state, simulation.tether.time_s, before);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const double warp = 1e-4 * cornerSide(c, 0) * cornerSide(c, 1);
    simulation.state.position.values(2, 0)[c] += warp;
    simulation.state.velocity.values(0, 0)[c] += warp;
  }
  std::array<Vec3, kCorners> after;
  tetherForces(simulation.tether, simulation.model, simulation.state, simulation.tether.time_s, after);
  for (std::size_t c = 0; c < kCorners; ++c)
    EXPECT_LT((after[c] - before[c]).norm(), 1e-9 * simulation.tether.cornerStiffness_n_m * 1e-4) << c;
}

// On the floor: below the friction limit the block stays, above it slides.
TEST(Grip, FrictionAnswersTheHand) {
  Scene scene = oneBlockScene(true);
  const double bound = scene.staticFriction * scene.blocks[0].mass * kStandardGravity_m_s2;
  const double perMetre = scene.blocks[0].mass * tuning::kFollowFrequency_rad_s * tuning::kFollowFrequency_rad_s;
  for (const double share : {0.8, 1.3}) {
    Held held(scene);
    wait(held, 60);
    Hand hand = handOn(held.simulation, blockId(0));
    const Vec3 start = hand.place;
    lead(held, hand, {share * bound / perMetre, 0.0, 0.0}, 0.01, 0.5);
    const double moved = (centre(held.simulation.state.position, 0) - start).norm();
    if (share < 1.0) {
      EXPECT_LT(moved, 2e-5);
      EXPECT_EQ(holdOf(held, blockId(0)), Hold::sticks);
      EXPECT_NEAR(held.force.force.norm(), share * bound, 0.02 * bound);
    } else {
      EXPECT_GT(moved, 1e-4);
      EXPECT_NEAR(held.force.force.norm(), bound, 0.05 * bound);
    }
  }
}

TEST(Grip, TakingABlockOfTheTowerMovesNothing) {
  Held held(towerScene(6));
  wait(held, 150);
  const ParticleArray before = held.simulation.state.position;
  Hand hand = handOn(held.simulation, blockId(7));
  lead(held, hand, Vec3::Zero(), 1.0, 1.0);
  EXPECT_LT(largestCornerMove(before, held.simulation.state.position), 2e-5);
  EXPECT_LT(held.force.force.norm(), 0.02);
  EXPECT_EQ(holdOf(held, hand.block), Hold::sticks);
}

// Before the first frame blocks are put into equilibrium without the hand. There are no contacts yet, so the hand supports the
// block's weight and transfers it to the contacts within some frames.
TEST(Grip, MayHoldABlockFromTheFirstFrame) {
  Held held(towerScene(3));
  const ParticleArray before = held.simulation.state.position;
  Hand hand = handOn(held.simulation, blockId(4));
  lead(held, hand, Vec3::Zero(), 1.0, 0.5);
  EXPECT_LT(largestCornerMove(before, held.simulation.state.position), 2.0 * toleranceOf(held.simulation.scene));
}

// Rigid methods have long steps, in which the hand's springs are solved implicitly; the block reaches its target nevertheless.
TEST(Grip, RigidMethodsFollowToo) {
  for (const Method method : {Method::rigidPgs, Method::rigidLcp, Method::xpbd}) {
    Scene scene = blockInTheAir();
    scene.settings.method = method;
    Held held(scene);
    Hand hand = handOn(held.simulation, blockId(0));
    hand.place += Vec3(0.06, 0.0, 0.08);
    hand.turn = Eigen::AngleAxisd(0.3, Vec3::UnitZ()) * hand.turn;
    for (int i = 0; i < 60; ++i) step(held, hand);
    EXPECT_LT((centre(held.simulation.state.position, 0) - hand.place).norm(), 1e-3) << nameOf(method);
    EXPECT_LT(orientationOf(held.simulation.state.position, 0).angularDistance(hand.turn), 0.01) << nameOf(method);
  }
}

// Friction on both faces shears a block by a tenth of a radian: bottom and top keep their orientation, so it is not rotated.
TEST(Grip, AShearedBlockIsNotTurned) {
  Simulation simulation(oneBlockScene(false));
  const Eigen::Quaterniond turn = orientationOf(simulation.state.position, 0);
  const double height = simulation.model.dimensions[0].z();
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 shear(0.05 * cornerSide(c, 2) * height, 0.0, 0.0);
    simulation.state.position.set(0, c, simulation.state.position.at(0, c) + shear);
  }
  EXPECT_LT(orientationOf(simulation.state.position, 0).angularDistance(turn), 1e-7);
}

// A hand that releases one block and takes another in the same frame.
TEST(Grip, TakesAnotherBlockAtOnce) {
  Held held(towerScene(6));
  wait(held, 60);
  const ParticleArray before = held.simulation.state.position;
  for (const std::size_t block : {7U, 10U, 16U}) {
    Hand hand = handOn(held.simulation, blockId(block));
    lead(held, hand, Vec3::Zero(), 1.0, 0.1);
    EXPECT_EQ(held.simulation.tether.block, blockId(block));
  }
  EXPECT_LT(largestCornerMove(before, held.simulation.state.position), 2e-5);
}

// The middle block of the third of six rows: the hand draws it out completely, at its speed and nearly level, and the tower
// stands.
TEST(Grip, DrawsABlockOutAtItsSpeed) {
  constexpr double kSpeed_m_s = 0.04;
  Simulation simulation(towerScene(6));
  for (int i = 0; i < 120; ++i) prepareAndStep(simulation);
  const std::size_t block = 7;
  const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
  std::vector<std::uint8_t> leftOut(18, 0);
  leftOut[block] = 1;
  Draw draw = drawingFrom(simulation, blockId(block), Vec3::UnitX(), kSpeed_m_s);
  std::vector<double> times_s;  // times at which it has moved by so many millimetres
  double tilt = 0.0;
  for (int i = 0; i < 240 && times_s.size() < 90; ++i) {
    advancePull(draw, contactForces(simulation), simulation);
    prepareAndStep(simulation);
    EXPECT_LE(gripForce(simulation).force.norm(), tuning::kGripForce_n * (1.0 + 1e-12));
    const double moved = (centre(simulation.state.position, block) - start[block].centre).x();
    while (times_s.size() < 90 && moved > 1e-3 * static_cast<double>(times_s.size() + 1)) times_s.push_back(simulation.time_s);
    tilt = std::max(tilt, orientationOf(simulation.state.position, block).angularDistance(draw.hand.turn));
  }
  ASSERT_EQ(times_s.size(), 90U);
  EXPECT_NEAR(0.05 / (times_s[59] - times_s[9]), kSpeed_m_s, 0.05 * kSpeed_m_s);
  EXPECT_LT(
      tilt,
      kFallTurn_deg /
          57.29577951);  // it droops while its weight is transferred to the hand, but never so far that it would have fallen
  EXPECT_TRUE(standing(simulation.model, start, simulation.state.position, leftOut).stands);
}

// Full force for two seconds against the tower: no penetration exceeds a millimetre, whether the tower stands or topples.
TEST(Grip, PushedAtFullForceNothingPenetratesAMillimetre) {
  struct Push {
    std::size_t block;
    Vec3 way;
  };
  const Push pushes[] = {{16, {0.0, 0.5, 0.0}}, {16, {0.0, 0.0, -0.5}}, {1, {0.5, 0.0, 0.0}}, {10, {0.2, 0.3, -0.4}}};
  for (const Method method : {Method::semiImplicitEuler, Method::implicit}) {
    Scene scene = towerScene(6);
    scene.settings.method = method;
    for (const Push& push : pushes) {
      Held held(scene);
      wait(held, 30);
      Hand hand = handOn(held.simulation, blockId(push.block));
      hand.place += push.way;
      EXPECT_LT(deepest(held, hand, 120), 1e-3) << nameOf(method) << ", block " << push.block;
    }
  }
}

// A hand that jerks its block back and forth: at the start of the frame nothing moves yet towards the neighbour that it hits in
// it.
TEST(Grip, ABlockJerkedAgainstItsNeighbourStaysOutside) {
  for (const Method method : {Method::semiImplicitEuler, Method::implicit}) {
    for (const double gap_m : {0.0002, 0.0005, 0.001, 0.002, 0.005}) {
      Scene scene = oneBlockScene(true);
      scene.settings.method = method;
      scene.blocks.push_back(scene.blocks[0]);
      scene.blocks[1].centre.y() += scene.blocks[0].dimensions.y() + gap_m;
      Held held(scene);
      wait(held, 30);
      Hand hand = handOn(held.simulation, blockId(0));
      double depth = 0.0;
      for (const double way_m : {0.1, -0.2, 0.2}) {
        hand.place.y() += way_m;
        depth = std::max(depth, deepest(held, hand, 2));
      }
      EXPECT_LT(depth, 6e-4) << nameOf(method) << ", gap " << gap_m;  // an impact has a target depth of 0.4 mm
    }
  }
}

// Held still just above another block and released: the island is quiescent, so one implicit step would be chosen for the frame,
// in which it falls by more than a millimetre.
TEST(Grip, ABlockLetGoJustAboveAnotherLandsOnIt) {
  for (const double gap_m : {0.00005, 0.0001, 0.0002, 0.0005, 0.001}) {
    Scene scene = oneBlockScene(true);
    scene.settings.method = Method::implicit;
    scene.blocks.push_back(scene.blocks[0]);
    scene.blocks[1].centre += Vec3(0.03, 0.0, scene.blocks[0].dimensions.z() + 0.001 + gap_m);
    Held held(scene);
    Hand hand = handOn(held.simulation, blockId(1));
    lead(held, hand, {0.0, 0.0, -0.001}, 0.005, 1.0);
    letGo(held.simulation);
    PenetrationWorkspace workspace;
    double depth = 0.0;
    for (int i = 0; i < 60; ++i) {
      prepareAndStep(held.simulation);
      depth = std::max(depth, maxPenetration(held.simulation.state.position, true, workspace).depth);
    }
    EXPECT_LT(depth, 2.5e-4) << "gap " << gap_m;
  }
}

// The same with a block in the hand as a tool, pushed from outside against the side of the tower.
TEST(Grip, AToolPushedIntoTheSideOfTheTowerStaysOutside) {
  Scene scene = towerScene(6);
  BlockSpec tool;
  tool.centre = {0.2, 0.0, 0.06};
  scene.blocks.push_back(tool);
  for (const Method method : {Method::semiImplicitEuler, Method::implicit}) {
    scene.settings.method = method;
    Held held(scene);
    Hand hand = handOn(held.simulation, blockId(scene.blocks.size() - 1));
    lead(held, hand, {-0.06, 0.0, 0.0}, 0.3);
    hand.place.x() = -0.4;
    EXPECT_LT(deepest(held, hand, 120), 1e-3) << nameOf(method);
  }
}

}  // namespace
}  // namespace springtower
