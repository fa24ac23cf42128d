#include "scenarios/loose.h"
#include "scenarios/towers.h"
#include "solver/metrics/measures.h"
#include "solver/statics/statics.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/method_names.h"
#include "tests/support/prepare_and_step.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>
#include <vector>

namespace springtower {
namespace {

struct Coefficients {
  double staticFriction;
  double kineticFriction;
};

Scene withFriction(Scene scene, const Coefficients& friction, Method method) {
  scene.staticFriction = friction.staticFriction;
  scene.kineticFriction = friction.kineticFriction;
  scene.settings.method = method;
  scene.settings.sleep = Sleep::off;
  return scene;
}

double staticAngle_deg(const Coefficients& friction) {
  return degrees(std::atan(friction.staticFriction));
}

// How far the block that moves most has gone after a time, m.
double farthestMoved(Scene scene, double seconds) {
  Simulation simulation(std::move(scene));
  prepare(simulation);  // the strain of its weight is no motion
  std::vector<Vec3> from;
  for (std::size_t b = 0; b < simulation.model.blockCount(); ++b) from.push_back(centre(simulation.state.position, b));
  stepFor(simulation, seconds);
  double farthest = 0.0;
  for (std::size_t b = 0; b < from.size(); ++b)
    farthest = std::max(farthest, (centre(simulation.state.position, b) - from[b]).norm());
  return farthest;
}

struct TwoCoefficients : ::testing::TestWithParam<Method> {};

// A patch lets go as one: a block rests up to its static angle, and beyond it slides with kinetic friction, along its length,
// along its width and between (which rigid-lcp, whose friction is bounded by a pyramid, holds beyond its angle). At 1.02 of the
// angle the kinetic coefficient alone decides what happens once it moves.
TEST_P(TwoCoefficients, ABlockRestsUpToItsStaticAngleAndSlidesBeyondIt) {
  for (const Coefficients& friction : {Coefficients{0.5, 0.3}, Coefficients{0.5, 0.45}, Coefficients{0.6, 0.3}}) {
    for (const double direction_deg : {0.0, 90.0, degrees(std::atan2(kBlockWidth_m, kBlockLength_m))}) {
      if (GetParam() == Method::rigidLcp && direction_deg != 0.0 && direction_deg != 90.0) continue;
      SCOPED_TRACE(testing::Message() << friction.staticFriction << " / " << friction.kineticFriction << " along "
                                      << direction_deg);
      const auto scene = [&](double share) {
        return withFriction(blockOnSlopeScene(share * staticAngle_deg(friction), direction_deg), friction, GetParam());
      };
      EXPECT_LT(farthestMoved(scene(0.98), 1.0), 1e-3 * kBlockHeight_m);
      // With kinetic friction it would go half a t^2; half of that way leaves time to let go.
      const double angle = 1.02 * staticAngle_deg(friction) * std::numbers::pi / 180.0;
      const double acceleration = kStandardGravity_m_s2 * (std::sin(angle) - friction.kineticFriction * std::cos(angle));
      EXPECT_GT(farthestMoved(scene(1.02), 1.0), 0.25 * acceleration);
    }
  }
}

// What slides already goes on by the kinetic coefficient, though it could rest by the static one.
TEST_P(TwoCoefficients, ASlidingBlockKeepsSliding) {
  constexpr Coefficients kFriction{0.5, 0.3};
  constexpr double kSpeed_m_s = 0.3;
  for (const double tilt_deg : {20.0, 24.0}) {
    Scene scene = withFriction(blockOnSlopeScene(tilt_deg, 0.0), kFriction, GetParam());
    scene.blocks[0].velocity.x() = kSpeed_m_s;
    const double angle = tilt_deg * std::numbers::pi / 180.0;
    const double acceleration = kStandardGravity_m_s2 * (std::sin(angle) - kFriction.kineticFriction * std::cos(angle));
    const double path = kSpeed_m_s + 0.5 * acceleration;
    EXPECT_NEAR(farthestMoved(std::move(scene), 1.0), path, 0.01 * path) << tilt_deg;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, TwoCoefficients,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::semiImplicitEuler, Method::rigidPgs,
                                           Method::rigidLcp, Method::xpbd),
                         methodName);

struct TurningFace : ::testing::TestWithParam<Method> {};

// A block that turns flat on the floor is braked as by pressure that is spread evenly over its face: by mu m g times the mean
// distance of the face from its middle. Four forces at its corners would stop it in half that angle.
TEST_P(TurningFace, StopsAsEvenPressureWouldStopIt) {
  constexpr double kSpin_rad_s = 20.0;
  Scene scene = withFriction(blockOnSlopeScene(0.0, 0.0), {0.4, 0.4}, GetParam());
  scene.blocks[0].spin.z() = kSpin_rad_s;
  double meanDistance_m = 0.0;
  constexpr int kParts = 100;
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; j < kParts; ++j)
      meanDistance_m += std::hypot(((i + 0.5) / kParts - 0.5) * kBlockLength_m, ((j + 0.5) / kParts - 0.5) * kBlockWidth_m);
  }
  meanDistance_m /= kParts * kParts;
  const double inertiaPerMass = (kBlockLength_m * kBlockLength_m + kBlockWidth_m * kBlockWidth_m) / 12.0;
  const double slowing = 0.4 * kStandardGravity_m_s2 * meanDistance_m / inertiaPerMass;
  const double angle = 0.5 * kSpin_rad_s * kSpin_rad_s / slowing;
  Simulation simulation(scene);
  double turned = 0.0;
  const auto heading = [&] {
    const Vec3 edge = simulation.state.position.at(0, 1) - simulation.state.position.at(0, 0);
    return std::atan2(edge.y(), edge.x());
  };
  for (double before = heading(); simulation.time_s < 0.5; before = heading()) {
    prepareAndStep(simulation);
    turned += std::remainder(heading() - before, 2.0 * std::numbers::pi);
  }
  EXPECT_NEAR(turned, angle, 0.05 * angle);
  EXPECT_LT((centre(simulation.state.position, 0) - Vec3(0.0, 0.0, 0.5 * kBlockHeight_m)).norm(), 0.01 * kBlockHeight_m);
}

INSTANTIATE_TEST_SUITE_P(Methods, TurningFace,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::semiImplicitEuler, Method::rigidPgs),
                         methodName);

// By statics these towers stand: the least margin is 0.8 degrees. Their uphill patches are at their static limit, those downhill
// hold them.
TEST(Friction, TowersStandByTheStaticCoefficient) {
  struct Case {
    Coefficients friction;
    double tilt_deg;
  };
  for (const int rows : {3, 6}) {
    for (const Case& one : {Case{{0.5, 0.3}, 21.0}, Case{{0.5, 0.3}, 24.0}, Case{{0.4, 0.2}, 18.0}, Case{{0.4, 0.2}, 20.0},
                            Case{{0.4, 0.2}, 21.0}}) {
      Scene scene = withFriction(towerScene(rows), one.friction, Method::implicit);
      scene.gravity.tilt_deg = one.tilt_deg;
      EXPECT_LT(farthestMoved(std::move(scene), 2.0), 0.05 * kBlockHeight_m) << rows << " rows at " << one.tilt_deg;
    }
  }
}

struct SurfacesTest : ::testing::TestWithParam<Method> {};

// Three blocks on a slope of 20 degrees (tangent 0.364), on a floor of 0.25: the first has 0.64, so sqrt(0.25 * 0.64) = 0.4 and
// rests; the second 0.36, so 0.3, and slides with it; the third 0.64 as well, but 0.2 with the floor by a pair of its own.
TEST_P(SurfacesTest, BlocksRestAndSlideByTheirOwnCoefficients) {
  constexpr double kTilt_deg = 20.0;
  Scene scene = withFriction(blockOnSlopeScene(kTilt_deg, 0.0), {0.5, 0.5}, GetParam());
  scene.floorFriction = Friction{0.25, 0.25};
  for (const double aside_m : {0.1, 0.2}) {
    scene.blocks.push_back(scene.blocks.front());
    scene.blocks.back().centre.y() = aside_m;
  }
  scene.blocks[0].friction = scene.blocks[2].friction = Friction{0.64, 0.64};
  scene.blocks[1].friction = Friction{0.36, 0.36};
  scene.frictionPairs = {{2, -1, {0.2, 0.2}}};
  Simulation simulation(scene);
  stepFor(simulation, 1.0);
  const double angle = kTilt_deg * std::numbers::pi / 180.0;
  const auto wayWith = [&](double friction) {
    return 0.5 * kStandardGravity_m_s2 * (std::sin(angle) - friction * std::cos(angle));
  };
  EXPECT_LT(std::abs(centre(simulation.state.position, 0).x()), 1e-3 * kBlockHeight_m);
  EXPECT_NEAR(centre(simulation.state.position, 1).x(), wayWith(0.3), 0.02 * wayWith(0.3));
  EXPECT_NEAR(centre(simulation.state.position, 2).x(), wayWith(0.2), 0.02 * wayWith(0.2));
}

INSTANTIATE_TEST_SUITE_P(Methods, SurfacesTest,
                         ::testing::Values(Method::implicit, Method::implicitEuler, Method::semiImplicitEuler, Method::rigidPgs,
                                           Method::rigidLcp, Method::xpbd),
                         methodName);

// A block on a rough one on a smooth floor: by statics it stands up to the least of both angles, whichever contact it is of.
TEST(Friction, StaticsUsesPairs) {
  Scene scene;
  scene.blocks.resize(2);
  scene.blocks[0].centre.z() = 0.5 * kBlockHeight_m;
  scene.blocks[1].centre.z() = 1.5 * kBlockHeight_m;
  scene.floorFriction = Friction{0.1, 0.1};
  const auto stands = [&](double tilt_deg) {
    scene.gravity.tilt_deg = tilt_deg;
    return staticScene(scene).rest == Rest::stands;
  };
  const double floorAngle_deg = degrees(std::atan(std::sqrt(0.1 * 0.4)));
  EXPECT_TRUE(stands(0.99 * floorAngle_deg));
  EXPECT_FALSE(stands(1.01 * floorAngle_deg));
  scene.frictionPairs = {{0, 1, {0.05, 0.05}}};
  EXPECT_FALSE(stands(0.99 * floorAngle_deg));
  EXPECT_TRUE(stands(0.99 * degrees(std::atan(0.05))));
}

// A force of 0.99 of the friction limit that begins at once on a block at rest: a rigid block does not move, one on springs by
// their strain. Springs that it strikes would swing to twice that, and the block would slip.
TEST(Friction, WhatFrictionHoldsDoesNotSlipWhenAForceBegins) {
  for (const double start_s : {0.0, 1.0}) {
    for (const Method method : {Method::implicit, Method::implicitEuler}) {
      Scene scene = withFriction(oneBlockScene(true), {0.5, 0.5}, method);
      const double held_n = 0.5 * scene.blocks[0].mass * kStandardGravity_m_s2;
      scene.forces.push_back(constantForce(0, -1, Vec3(0.99 * held_n, 0.0, 0.0), start_s, 100.0));
      EXPECT_LT(farthestMoved(std::move(scene), start_s + 1.0), kBlockTolerance_m) << start_s << " s, " << nameOf(method);
    }
  }
}

// A force beyond the limit takes effect at once: half the acceleration times the square of the time.
TEST(Friction, AForceBeyondTheLimitAcceleratesAtOnce) {
  Scene scene = withFriction(oneBlockScene(true), {0.5, 0.5}, Method::implicit);
  scene.forces.push_back(
      constantForce(0, -1, Vec3(1.5 * 0.5 * scene.blocks[0].mass * kStandardGravity_m_s2, 0.0, 0.0), 0.0, 100.0));
  const double way = 0.5 * 0.5 * 0.5 * kStandardGravity_m_s2;
  EXPECT_NEAR(farthestMoved(std::move(scene), 1.0), way, 0.02 * way);
}

}  // namespace
}  // namespace springtower
