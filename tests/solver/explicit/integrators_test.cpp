#include "core/scene/scene.h"
#include "solver/block/inertia.h"
#include "solver/explicit/stable_step.h"
#include "solver/metrics/penetration.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

namespace springtower {
namespace {

constexpr double kTiny_m = 1e-8;  // amplitude at which springs are linear to 1e-6 of a block, far above rounding at 1e-17 m

std::string methodTestName(Method method) {
  switch (method) {
    case Method::midpoint:
      return "Midpoint";
    case Method::rungeKutta4:
      return "RungeKutta4";
    default:
      return "SemiImplicitEuler";
  }
}

struct MethodTest : ::testing::TestWithParam<Method> {};

// All three methods integrate the position under a constant acceleration without error, so only rounding is left. The velocities
// of semi-implicit Euler belong to a time half a step earlier.
TEST_P(MethodTest, FreeFallFollowsTheClosedForm) {
  Scene scene = oneBlockScene(false);
  scene.blocks[0].velocity = Vec3(0.3, -0.2, 1.5);
  scene.gravity.tilt_deg = 20.0;
  scene.gravity.direction_deg = 50.0;
  setSteps(scene.settings, GetParam(), 1.0 / 1200.0, 20);
  scene.settings.tolerance_m = 1e-3;
  Simulation simulation(scene);
  stepFor(simulation, 0.5);
  const Vec3 gravity = scene.gravity.at(0.0);
  const double t = simulation.time_s;
  const Vec3 place = scene.blocks[0].centre + scene.blocks[0].velocity * t + 0.5 * t * t * gravity;
  const double velocityTime = GetParam() == Method::semiImplicitEuler ? t - 0.5 / 1200.0 : t;
  EXPECT_LT((centre(simulation.state.position, 0) - place).norm(), 1e-11);  // 600 roundings of a metre
  EXPECT_LT((centre(simulation.state.velocity, 0) - scene.blocks[0].velocity - velocityTime * gravity).norm(), 1e-11);
}

// Springs act in pairs along their line, so momentum changes by rounding only: some 1e5 steps of 1e-16, in every method. In
// semi-implicit Euler angular momentum as well, because each kick and each drift conserves it; the others conserve it to their
// order, for which the stiffest mode's w dt is 0.2 here: 0.2^3 and 0.2^5 of the small share of the vibration.
TEST_P(MethodTest, FreeFlightKeepsMomentum) {
  Simulation simulation = ringingBlock(Inertia::cuboid, GetParam(), 1e-3, 10, 200.0);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.3, Vec3(1.0, -2.0, 0.5).normalized()));
  const Vec3 spin(1.0, -0.7, 0.4);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = turn * simulation.state.position.at(0, c);
    simulation.state.position.set(0, c, arm);
    simulation.state.velocity.set(0, c, Vec3(0.2, 0.1, -0.3) + spin.cross(arm));
  }
  stretch(simulation.state.position, 0, Vec3(2e-3, -1e-3, 3e-3));
  const Momentum before = momentum(simulation);
  stepFor(simulation, 10.0);
  const Momentum after = momentum(simulation);
  const double angularBound = GetParam() == Method::semiImplicitEuler ? 1e-11 : GetParam() == Method::midpoint ? 1e-4 : 1e-8;
  EXPECT_LT((after.linear - before.linear).norm(), 1e-12 * before.linear.norm());
  EXPECT_LT((after.angular - before.angular).norm(), angularBound * before.angular.norm());
}

// A block starts stretched and spinning. Relative to a run with Runge-Kutta steps at least 16 times finer, the error in position
// and velocity together decreases by 2^order when the step is halved. w dt of the stiffest mode is at most 0.1, so the leading
// term dominates: a tenth in the exponent is allowed for the rest.
struct OrderOfConvergence {
  static Simulation run(Method method, int steps) {
    constexpr double kOmega = 40.0;
    constexpr double kTime_s = 0.3;
    Simulation simulation = ringingBlock(Inertia::cuboid, method, kTime_s / steps, 10, kOmega);
    stretch(simulation.state.position, 0, Vec3(0.02, -0.01, 0.03));
    const Vec3 spin(0.8, 0.5, -0.6);
    for (std::size_t c = 0; c < kCorners; ++c)
      simulation.state.velocity.set(0, c, spin.cross(simulation.state.position.at(0, c)));
    for (int frame = 0; frame < steps / 10; ++frame) prepareAndStep(simulation);
    return simulation;
  }
  static double error(const Simulation& simulation, const Simulation& reference) {
    const Vector24 x = cornerVector(simulation.state.position, 0) - cornerVector(reference.state.position, 0);
    const Vector24 v = cornerVector(simulation.state.velocity, 0) - cornerVector(reference.state.velocity, 0);
    return std::hypot(x.norm(), v.norm() / 40.0);
  }
};

TEST_P(MethodTest, ConvergesWithItsOrder) {
  const double order = GetParam() == Method::rungeKutta4 ? 4.0 : GetParam() == Method::midpoint ? 2.0 : 1.0;
  const Simulation reference = OrderOfConvergence::run(Method::rungeKutta4, 120 * 64);
  double last = 0.0;
  for (const int steps : {120, 240, 480}) {
    const double error = OrderOfConvergence::error(OrderOfConvergence::run(GetParam(), steps), reference);
    ASSERT_GT(error, 0.0);
    if (last > 0.0) {
      EXPECT_NEAR(std::log2(last / error), order, 0.1) << steps << " steps, error " << error << " m";
    }
    last = error;
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, MethodTest, ::testing::Values(Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4),
                         [](const auto& test) { return methodTestName(test.param); });

// A symplectic method has no drift: the energy changes only by the spring's nonlinearity over a period. Three amplitudes; the
// bound is a tenth of the sum of a drift of 1e-9 a step.
TEST(Energy, OfUndampedSpringsStaysBoundedOverAMillionSteps) {
  for (const double amplitude : {1e-4, 1e-3, 3e-3}) {
    Simulation simulation = ringingBlock(Inertia::cuboid, Method::semiImplicitEuler, 1e-3, 100, 500.0);  // w dt = 0.5
    stretch(simulation.state.position, 0, amplitude * Vec3(1.0, -0.6, 0.8));
    prepareAndStep(simulation);  // the first kick is half, so the conserved energy is that of the steps after it
    const double start = energy(simulation).total();
    double lowest = start;
    double highest = start;
    for (int frame = 1; frame < 10000; ++frame) {
      prepareAndStep(simulation);
      const double now = energy(simulation).total();
      lowest = std::min(lowest, now);
      highest = std::max(highest, now);
    }
    ASSERT_EQ(simulation.counters.steps, 1000000U);
    EXPECT_LT((highest - lowest) / start, 1e-4) << "amplitude " << amplitude;
  }
}

// Tens of thousands a frame where contacts deform by micrometres and dashpots are strong; with 6000 the rows burst at once.
TEST(ExplicitSteps, AreAsManyAsStiffnessAndDashpotsRequire) {
  Scene scene = towerScene(6);
  scene.settings.method = Method::semiImplicitEuler;
  scene.settings.tolerance_m = 1e-6;
  scene.settings.stiffnessDamping = 0.01;
  Simulation simulation(scene);
  for (int frame = 0; frame < 3; ++frame) prepareAndStep(simulation);
  EXPECT_GT(simulation.substeps, 6000);
  PenetrationWorkspace workspace;
  EXPECT_LE(maxPenetration(simulation.state.position, true, workspace).depth, *scene.settings.tolerance_m);
}

struct InertiaTest : ::testing::TestWithParam<Inertia> {};

// Each breathing mode separately: 50 periods timed by their zero crossings. Steps of a hundredth of the shortest period shift the
// frequency by (w dt)^2 / 24 < 2e-4.
TEST_P(InertiaTest, ModesVibrateAtTheFrequencyOfTheory) {
  Simulation pattern = ringingBlock(GetParam(), Method::semiImplicitEuler, 1e-3, 1, 20.0);
  const BreathingModes modes = breathingModes(pattern.model, GetParam(), 0);
  for (Eigen::Index mode = 0; mode < 3; ++mode) {
    const double omega = std::sqrt(modes.squares[mode]);
    const double step_s = 2.0 * std::numbers::pi / omega / 100.0;
    Simulation simulation = ringingBlock(GetParam(), Method::semiImplicitEuler, step_s, 1, 20.0);
    const Vec3 shape = modes.stretches.col(mode).normalized();
    stretch(simulation.state.position, 0, 1e-6 * shape);
    const auto elongation = [&] {
      Vec3 stretched;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        stretched[axis] = meanEdge(simulation.state.position, 0, a).norm() / simulation.model.dimensions[0][axis] - 1.0;
      }
      return stretched.dot(shape);
    };
    double before = elongation();
    double first_s = -1.0;
    double last_s = 0.0;
    int crossings = 0;
    for (int step = 0; step < 5000; ++step) {
      prepareAndStep(simulation);
      const double now = elongation();
      if (before * now < 0.0) {
        last_s = simulation.time_s - step_s * now / (now - before);
        if (crossings == 0) first_s = last_s;
        ++crossings;
      }
      before = now;
    }
    ASSERT_GT(crossings, 90) << "mode " << mode;
    const double measured = std::numbers::pi * (crossings - 1) / (last_s - first_s);
    EXPECT_NEAR(measured / omega, 1.0, 0.01) << "mode " << mode;
  }
}

// Whether a tiny vibration of the stiffest mode grows a hundredfold within some hundred steps. Just inside the limit the
// amplitude of semi-implicit Euler is up to 1 / sqrt(1 - (w dt / 2)^2) times the initial one, 7 times at 0.99 of the limit.
bool grows(Method method, Inertia inertia, double omegaStep) {
  constexpr double kOmega = 100.0;
  Simulation simulation = ringingBlock(inertia, method, omegaStep / kOmega, 1, kOmega);
  const Vector24 start = cornerVector(simulation.state.position, 0);
  addCornerVector(kTiny_m * stiffestMode(simulation, 0), simulation.state.position, 0);
  for (int step = 0; step < 1500; ++step) {
    prepareAndStep(simulation);
    if ((cornerVector(simulation.state.position, 0) - start).cwiseAbs().maxCoeff() > 100.0 * kTiny_m) return true;
  }
  return false;
}

double stabilityLimit(Method method, Inertia inertia) {
  double stable = 1.0;
  double unstable = 4.0;
  EXPECT_FALSE(grows(method, inertia, stable));
  EXPECT_TRUE(grows(method, inertia, unstable));
  while (unstable - stable > 1e-3) {
    const double middle = 0.5 * (stable + unstable);
    (grows(method, inertia, middle) ? unstable : stable) = middle;
  }
  return 0.5 * (stable + unstable);
}

TEST_P(InertiaTest, StabilityEndsWhereTheorySays) {
  EXPECT_NEAR(stabilityLimit(Method::semiImplicitEuler, GetParam()), 2.0, 0.02);
  EXPECT_NEAR(stabilityLimit(Method::rungeKutta4, GetParam()), 2.0 * std::numbers::sqrt2, 0.0283);
}

// The amplitude of the mode in phase space, sqrt(q^2 + (dq/dt / w)^2), which the method multiplies by sqrt(1 + (w dt)^4 / 4) each
// step: (w dt)^4 / 8 to within 5 % for w dt up to 0.6.
TEST_P(InertiaTest, MidpointGrowsByTheFourthPowerOfTheStep) {
  constexpr double kOmega = 100.0;
  for (const double omegaStep : {0.2, 0.4, 0.6}) {
    Simulation simulation = ringingBlock(GetParam(), Method::midpoint, omegaStep / kOmega, 1, kOmega);
    const Vector24 start = cornerVector(simulation.state.position, 0);
    const Vector24 mode = stiffestMode(simulation, 0);
    addCornerVector(kTiny_m * mode, simulation.state.position, 0);
    const auto amplitude = [&] {
      const double q = (cornerVector(simulation.state.position, 0) - start).dot(mode);
      return std::hypot(q, cornerVector(simulation.state.velocity, 0).dot(mode) / kOmega);
    };
    const double before = amplitude();
    const int steps = 200;
    for (int step = 0; step < steps; ++step) prepareAndStep(simulation);
    const double growth = std::pow(amplitude() / before, 1.0 / steps) - 1.0;
    const double expected = std::pow(omegaStep, 4) / 8.0;
    EXPECT_NEAR(growth, expected, 0.05 * expected) << "w dt = " << omegaStep;
  }
}

// A couple of four forces at the corners of each end, about the vertical through the centre, in free fall. Eight lumps have three
// times a cuboid's moment of inertia.
TEST_P(InertiaTest, ACoupleTurnsABlockAsTheorySays) {
  Scene scene = oneBlockScene(false);
  scene.settings.inertia = GetParam();
  const double end_s = 3.0 / 60.0;
  const double force = 2.5e-4;
  setSteps(scene.settings, Method::semiImplicitEuler, 1.0 / 12000.0, 200);  // the first kick is half: 0.1 % of all
  for (int corner = 0; corner < 8; ++corner) {
    const double side = cornerSide(static_cast<std::size_t>(corner), 0);
    scene.forces.push_back(constantForce(0, corner, Vec3(0.0, side * force, 0.0), 0.0, end_s));
  }
  Simulation simulation(scene);
  stepFor(simulation, 2.0 * end_s);
  const Vec3& size = scene.blocks[0].dimensions;
  const double torque = 8.0 * force * 0.5 * size.x();
  const double moment = kBlockMass_kg * (size.x() * size.x() + size.y() * size.y()) / 12.0;
  const double factor = GetParam() == Inertia::cuboid ? 1.0 : 3.0;
  const double expected = torque * end_s / (factor * moment);
  const Vec3 spin = rigidMotion(simulation.state, 0).spin;
  EXPECT_NEAR(spin.z(), expected, 0.01 * expected);
  EXPECT_LT(std::hypot(spin.x(), spin.y()), 0.001 * expected);
}

// A block of the game stands on one of its faces, held by friction, with gravity tilted by six degrees beyond the angle at which
// it balances on its lower edge: it tips about that edge. The pressure first moves there, and the edge vibrates for some
// milliseconds; from the angle and spin at 1/30 s on the spin increases like that of a rigid pendulum until 0.1 s. Eight lumps
// have 1.5 times a cuboid's moment about an edge. Returns the increase over that of the pendulum, minus 1.
double tippingError(const Vec3& size, const Settings& settings) {
  Scene scene = oneBlockScene(true);
  scene.blocks[0].dimensions = size;
  scene.blocks[0].centre.z() = 0.5 * size.z();
  scene.staticFriction = scene.kineticFriction = 10.0;
  const double balance = std::atan2(size.y(), size.z());
  scene.gravity.tilt_deg = degrees(balance) + 6.0;
  scene.gravity.direction_deg = 90.0;
  scene.settings = settings;
  scene.settings.sleep = Sleep::off;
  Simulation simulation(scene);
  const auto turned = [&] { return std::asin(-fittedBox(simulation.state.position, 0).axis[1].z()); };
  const auto spin = [&] { return -rigidMotion(simulation.state, 0).spin.x(); };
  stepFor(simulation, 2.0 / 60.0);
  const double start_s = simulation.time_s;
  const double start = spin();
  double rate = start;
  double angle = turned() + scene.gravity.tilt_deg * std::numbers::pi / 180.0 - balance;  // of the centre from above the edge
  stepFor(simulation, 4.0 / 60.0);

  const double squared = size.y() * size.y() + size.z() * size.z();
  const double arm = 0.5 * std::sqrt(squared);
  const double moment = settings.inertia == Inertia::cuboid ? squared / 3.0 : squared / 2.0;  // about the edge, over the mass
  const int steps = 100000;
  const double step_s = (simulation.time_s - start_s) / steps;
  for (int step = 0; step < steps; ++step) {
    rate += step_s * kStandardGravity_m_s2 * arm / moment * std::sin(angle);
    angle += step_s * rate;
  }
  return (spin() - start) / (rate - start) - 1.0;
}

// Three faces to stand on, two directions to tip in from each.
const std::array<Vec3, 6>& waysToTip() {
  static const std::array<Vec3, 6> ways = {
      Vec3(kBlockHeight_m, kBlockWidth_m, kBlockLength_m), Vec3(kBlockWidth_m, kBlockHeight_m, kBlockLength_m),
      Vec3(kBlockHeight_m, kBlockLength_m, kBlockWidth_m), Vec3(kBlockLength_m, kBlockHeight_m, kBlockWidth_m),
      Vec3(kBlockWidth_m, kBlockLength_m, kBlockHeight_m), Vec3(kBlockLength_m, kBlockWidth_m, kBlockHeight_m)};
  return ways;
}

// Default settings of users: implicit steps and the default tolerance. The centre starts 2 to 4 mm beyond the edge, and a
// compression of the edge by some hundredths of a millimetre shifts that by up to 0.8 %.
TEST_P(InertiaTest, TipsAboutEachBottomEdgeAsTheorySays) {
  Settings settings;
  settings.inertia = GetParam();
  for (const Vec3& size : waysToTip()) EXPECT_NEAR(tippingError(size, settings), 0.0, 0.01) << 1e3 * size.transpose() << " mm";
}

// At the default tolerance the edge vibrates while the block tips. Explicit steps resolve that, and the spin varies by several
// percent, by more where little weight holds the block down; this is the compliance of the contact, not an error of inertia. A
// tolerance of a micrometre, fifty times as stiff, makes it negligible.
TEST_P(InertiaTest, TipsAboutEachStiffBottomEdgeByAnyMethod) {
  Settings settings;
  settings.inertia = GetParam();
  settings.tolerance_m = 1e-6;
  for (const Method method : {Method::implicit, Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4}) {
    settings.method = method;
    for (const Vec3& size : waysToTip()) {
      EXPECT_NEAR(tippingError(size, settings), 0.0, 0.01) << nameOf(method) << ", " << 1e3 * size.transpose() << " mm";
    }
  }
}

// Without torque a spin about a principal axis is constant; about another axis it follows Euler's equations. All three moments of
// eight lumps are three times a cuboid's, so both inertias move alike. Gravity has no torque.
TEST_P(InertiaTest, TorqueFreeSpinFollowsEulersEquations) {
  const Vec3 size(kBlockLength_m, kBlockWidth_m, kBlockHeight_m);
  const Vec3 squares = size.cwiseAbs2();
  const Vec3 moments = Vec3::Constant(squares.sum()) - squares;
  for (const Vec3& spin : {Vec3(10.0, 0.0, 0.0), Vec3(0.0, 0.0, 10.0), Vec3(8.0, 3.0, -5.0)}) {
    Scene scene = oneBlockScene(false);
    scene.settings.inertia = GetParam();
    scene.blocks[0].spin = spin;
    Simulation simulation(scene);
    stepFor(simulation, 0.5);

    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Vec3 body = spin;  // angular velocity in the block's own axes
    const int steps = 100000;
    const double step_s = simulation.time_s / steps;
    const auto rate = [&](const Vec3& w) -> Vec3 { return -w.cross(moments.cwiseProduct(w)).cwiseQuotient(moments); };
    for (int step = 0; step < steps; ++step) {
      const Vec3 middle = body + 0.5 * step_s * rate(body);
      turn = turn * Eigen::Quaterniond(Eigen::AngleAxisd(step_s * middle.norm(), middle.normalized()));
      body += step_s * rate(middle);
    }
    const Vec3 expected = turn * body;
    EXPECT_LT((rigidMotion(simulation.state, 0).spin - expected).norm(), 0.01 * expected.norm()) << spin.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Inertias, InertiaTest, ::testing::Values(Inertia::cuboid, Inertia::lumped),
                         [](const auto& test) { return std::string(nameOf(test.param)); });

}  // namespace
}  // namespace springtower
