// User forces and torques against closed forms: what they give does not depend on the method, its steps, or where in a frame they
// begin and end.
#include "scenarios/loose.h"
#include "solver/block/inertia.h"
#include "solver/frame/inputs.h"
#include "tests/support/block_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace springtower {
namespace {

constexpr double kFrame_s = 1.0 / 60.0;
constexpr double kForce_n = 0.05;

class EveryMethod : public ::testing::TestWithParam<Method> {
 protected:
  // One block, in the air without gravity or on a smooth floor.
  [[nodiscard]] static Scene scene(bool onFloor) {
    Scene scene = oneBlockScene(onFloor);
    scene.settings.method = GetParam();
    scene.settings.frame_s = kFrame_s;
    scene.settings.sleep = Sleep::off;
    scene.floor = onFloor;
    if (!onFloor) scene.gravity.magnitude = 0.0;
    scene.staticFriction = scene.kineticFriction = 0.0;
    return scene;
  }
};

// The impulse is F t, within a thousandth, for pushes that begin and end within frames and steps; one is shorter than a step.
TEST_P(EveryMethod, APushGivesItsImpulse) {
  struct Push {
    double fromFrame;
    double toFrame;
  };
  for (const bool onFloor : {true, false}) {
    for (const Push& push : {Push{0.0, 2.68}, Push{0.0, 5.74}, Push{1.3, 9.34}, Push{3.31, 3.35}, Push{4.0, 6.0}}) {
      Scene pushed = scene(onFloor);
      pushed.forces.push_back(constantForce(0, -1, Vec3(kForce_n, 0.0, 0.0), push.fromFrame * kFrame_s, push.toFrame * kFrame_s));
      Simulation simulation(pushed);
      stepFor(simulation, 12.0 * kFrame_s);
      const double impulse_n_s = kForce_n * (push.toFrame - push.fromFrame) * kFrame_s;
      EXPECT_NEAR(momentum(simulation).linear.x(), impulse_n_s, 1e-3 * impulse_n_s)
          << (onFloor ? "floor, " : "air, ") << push.fromFrame << " to " << push.toFrame;
    }
  }
}

// From F to G in T: (F + G) T / 2.
TEST_P(EveryMethod, ARampGivesItsImpulse) {
  for (const bool onFloor : {true, false}) {
    Scene pushed = scene(onFloor);
    UserForce force{0, -1, Vec3::Zero(), 1.4 * kFrame_s, 9.1 * kFrame_s};
    force.forceAtEnd = Vec3(kForce_n, 0.0, 0.0);
    pushed.forces = {force};
    Simulation simulation(pushed);
    stepFor(simulation, 12.0 * kFrame_s);
    const double impulse_n_s = 0.5 * kForce_n * (force.end_s - force.start_s);
    EXPECT_NEAR(momentum(simulation).linear.x(), impulse_n_s, 1e-3 * impulse_n_s) << onFloor;
  }
}

// In free space the angular momentum is T t about the axis of the torque, and there is no momentum.
TEST_P(EveryMethod, ATorqueGivesItsAngularMomentum) {
  Scene turned = scene(false);
  UserForce force{0, -1, Vec3::Zero(), 0.7 * kFrame_s, 6.2 * kFrame_s};
  force.torque = Vec3(0.0, 0.0, 1e-4);
  turned.forces = {force};
  Simulation simulation(turned);
  stepFor(simulation, 12.0 * kFrame_s);
  const double given = 1e-4 * (force.end_s - force.start_s);
  const Momentum now = momentum(simulation);
  const Vec3 own = now.angular - centre(simulation.state.position, 0).cross(now.linear);
  EXPECT_NEAR(own.z(), given, 1e-3 * given);
  EXPECT_LT(own.head<2>().norm(), 1e-9 * given);
  EXPECT_LT(now.linear.norm(), 1e-12);
}

// A force at a point, for so short a time that the block hardly turns: F t, and (arm x F) t about the centre.
TEST_P(EveryMethod, AForceAtAPointGivesMomentumAndAngularMomentum) {
  Scene pushed = scene(false);
  UserForce force{0, -1, Vec3(0.0, 0.02, 0.01), 0.25 * kFrame_s, 1.5 * kFrame_s};
  force.point = Vec3(0.03, 0.01, -0.004);
  pushed.forces = {force};
  Simulation simulation(pushed);
  stepFor(simulation, 3.0 * kFrame_s);
  const double time_s = force.end_s - force.start_s;
  const Momentum now = momentum(simulation);
  const Vec3 own = now.angular - centre(simulation.state.position, 0).cross(now.linear);
  const Vec3 turning = time_s * force.point->cross(force.force);
  EXPECT_LT((now.linear - time_s * force.force).norm(), 1e-3 * time_s * force.force.norm());
  EXPECT_LT((own - turning).norm(), 0.01 * turning.norm());  // the arm turns by half a degree meanwhile
}

INSTANTIATE_TEST_SUITE_P(Forces, EveryMethod,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::implicitEigen,
                                           Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4, Method::rigidPgs,
                                           Method::rigidLcp, Method::xpbd));

// Friction holds a block against a force that grows, and it slips when the force has reached mu N: from then on its acceleration
// is mu g r t, with the rate r of the force over that limit, and its way mu g r t^3 / 6. A slip at a force off by one in a
// hundred would change that by seven.
TEST(Forces, ARampPullsABlockLooseAtItsFrictionLimit) {
  Scene scene = oneBlockScene(true);
  const double limit_n = scene.staticFriction * scene.blocks[0].mass * kStandardGravity_m_s2;
  UserForce force{0, -1, Vec3::Zero(), 0.5, 1.5};
  force.forceAtEnd = Vec3(2.0 * limit_n, 0.0, 0.0);
  scene.forces = {force};
  Simulation simulation(scene);
  const double start_m = centre(simulation.state.position, 0).x();
  const auto way_m = [&] { return centre(simulation.state.position, 0).x() - start_m; };
  stepFor(simulation, 0.95);
  EXPECT_LT(way_m(), 2.0 * kBlockTolerance_m);
  stepFor(simulation, 0.25);
  const double slips_s = 0.2;
  const double expected_m = scene.staticFriction * kStandardGravity_m_s2 * 2.0 * std::pow(slips_s, 3) / 6.0;
  EXPECT_NEAR(way_m(), expected_m, 0.05 * expected_m);
}

// A force below the limit of friction does not let a block slip, whenever it begins: it moves by the
// deflection of its springs.
TEST(Forces, APushBelowTheFrictionLimitMovesNothing) {
  for (const double start_s : {0.0, 1.0, 1.0 + 0.3 * kFrame_s}) {
    Scene scene = oneBlockScene(true);
    const double limit_n = scene.staticFriction * scene.blocks[0].mass * kStandardGravity_m_s2;
    scene.forces.push_back(constantForce(0, -1, Vec3(0.9 * limit_n, 0.0, 0.0), start_s, 3.0));
    Simulation simulation(scene);
    stepFor(simulation, 2.5);
    EXPECT_LT(centre(simulation.state.position, 0).x(), 1e-4) << start_s;
  }
}

// Pushes given anew in each frame add up to one that lasts.
TEST(Forces, GivenFrameByFrameAreOneThatLasts) {
  for (const Method method : {Method::implicit, Method::semiImplicitEuler, Method::rigidPgs}) {
    Scene scene = oneBlockScene(false);
    scene.settings.method = method;
    scene.gravity.magnitude = 0.0;
    Simulation simulation(scene);
    for (int frame = 0; frame < 6; ++frame) {
      setOnlyForce(simulation, forceForOneFrame(simulation, 0, Vec3(kForce_n, 0.0, 0.0)));
      prepareAndStep(simulation);
    }
    clearForces(simulation);
    stepFor(simulation, 2.0 * kFrame_s);
    const double impulse_n_s = kForce_n * 6.0 * scene.settings.frame_s;
    EXPECT_NEAR(momentum(simulation).linear.x(), impulse_n_s, 1e-9 * impulse_n_s);
  }
}

}  // namespace
}  // namespace springtower
