#include "solver/law/tether.h"

#include "core/tuning.h"
#include "solver/block/affine.h"
#include "solver/hand/grip.h"
#include "tests/support/block_scenes.h"
#include "tests/support/prepare_and_step.h"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace springtower {
namespace {

constexpr double kStep_s = 0.003;
constexpr double kStiffness_n_m = 400.0;
constexpr double kNoLimit = 1e6;

struct Limits {
  std::string name;
  double force_n;
  double across_n;
  double torque_n_m;
  bool onLine;
};

// A moving block that deviates from its copy by some millimetres and hundredths of a radian in every direction.
struct HeldBlock {
  explicit HeldBlock(const Limits& limits) {
    Tether& tether = simulation.tether;
    tether.block = blockId(0);
    tether.place = centre(simulation.state.position, 0) + Vec3(0.004, -0.002, 0.003);
    tether.velocity = Vec3(0.02, 0.01, -0.03);
    tether.turn = Eigen::AngleAxisd(0.03, Vec3(0.48, 0.6, 0.64)) * orientationOf(simulation.state.position, 0);
    tether.spin = Vec3(0.1, -0.2, 0.3);
    tether.time_s = simulation.time_s + 0.01;
    tether.stiffness_n_m = kStiffness_n_m;
    tether.damping_n_s_m = 3.0;
    tether.cornerStiffness_n_m = 2000.0;
    tether.cornerDamping_n_s_m = 1.0;
    tether.tiltStiffness_n_m = 500.0;
    tether.tiltDamping_n_s_m = 0.3;
    tether.carried_n = Vec3(0.0, 0.0, 0.1);
    tether.carriedOnEdges_n = forcesOnEdges(Vec3(0.0, 5e-4, 0.0), meanEdges(simulation.state.position, 0));
    tether.limit_n = limits.force_n;
    if (limits.onLine) tether.line = Vec3(0.8, 0.6, 0.0);
    tether.acrossLimit_n = limits.across_n;
    tether.torqueLimit_n_m = limits.torque_n_m;
  }

  // Forces on [C, E_0, E_1, E_2] with the block displaced by `way`, and its velocities changed by 1 / step of it.
  Eigen::Matrix<double, 12, 1> forcesAt(const Eigen::Matrix<double, 12, 1>& way) const {
    MotionState state = simulation.state;
    for (std::size_t c = 0; c < kCorners; ++c) {
      Vec3 moved = way.head<3>();
      for (int a = 0; a < 3; ++a) moved += 0.5 * cornerSide(c, static_cast<std::size_t>(a)) * way.segment<3>(3 + 3 * a);
      state.position.set(0, c, state.position.at(0, c) + moved);
      state.velocity.set(0, c, state.velocity.at(0, c) + moved / kStep_s);
    }
    std::array<Vec3, kCorners> corner;
    tetherForces(simulation.tether, simulation.model, state, simulation.time_s, corner);
    Eigen::Matrix<double, 12, 1> force = Eigen::Matrix<double, 12, 1>::Zero();
    for (std::size_t c = 0; c < kCorners; ++c) {
      force.head<3>() += corner[c];
      for (int a = 0; a < 3; ++a) force.segment<3>(3 + 3 * a) += 0.5 * cornerSide(c, static_cast<std::size_t>(a)) * corner[c];
    }
    return force;
  }

  Simulation simulation{oneBlockScene(false)};
};

class TetherResistanceTest : public testing::TestWithParam<Limits> {};

// Central differences over a nanometre: within a millionth of the largest entry.
TEST_P(TetherResistanceTest, IsTheDerivativeOfItsForces) {
  const HeldBlock held(GetParam());
  std::array<Vec3, kCorners> corner;
  const Simulation& simulation = held.simulation;
  const GripForce now = tetherForces(simulation.tether, simulation.model, simulation.state, simulation.time_s, corner);
  EXPECT_EQ(now.limited, GetParam().force_n < kNoLimit);
  EXPECT_EQ(now.acrossLimited, GetParam().across_n < kNoLimit);
  EXPECT_EQ(now.turnLimited, GetParam().torque_n_m < kNoLimit);
  const TetherMatrix told = tetherResistance(simulation.tether, simulation.model, simulation.state, simulation.time_s, kStep_s);
  TetherMatrix found;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Matrix<double, 12, 1> way = 1e-9 * Eigen::Matrix<double, 12, 1>::Unit(i);
    found.col(i) = (held.forcesAt(-way) - held.forcesAt(way)) / 2e-9;
  }
  EXPECT_LT((told - found).cwiseAbs().maxCoeff(), 1e-6 * told.cwiseAbs().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(
    Tether, TetherResistanceTest,
    testing::Values(Limits{"None", kNoLimit, kNoLimit, kNoLimit, true}, Limits{"NoLine", kNoLimit, kNoLimit, kNoLimit, false},
                    Limits{"Force", 0.5, kNoLimit, kNoLimit, true}, Limits{"ForceWithoutLine", 0.5, kNoLimit, kNoLimit, false},
                    Limits{"Across", kNoLimit, 0.3, kNoLimit, true}, Limits{"ForceAndAcross", 0.5, 0.3, kNoLimit, true},
                    Limits{"Torque", kNoLimit, kNoLimit, 1e-3, true}, Limits{"All", 0.5, 0.3, 1e-3, true}),
    [](const testing::TestParamInfo<Limits>& tested) { return tested.param.name; });

// The middle block of the tenth of 18 rows, awake and settled, and the target to which it is drawn.
struct LoadedBlock {
  explicit LoadedBlock(double tolerance_m) : simulation(sceneWith(tolerance_m)) { stepFor(simulation, 1.0); }

  static Scene sceneWith(double tolerance_m) {
    Scene scene = towerScene(18);
    scene.settings.sleep = Sleep::off;
    scene.settings.tolerance_m = tolerance_m;
    return scene;
  }

  static double speedAt(int frame) { return 0.04 * std::min(1.0, frame / 12.0); }

  Simulation simulation;
  BlockId block = blockId(9 * 3 + 1);
  Vec3 along = simulation.scene.blocks[index(block)].orientation * Vec3::UnitX();
  Vec3 start = centre(simulation.state.position, index(block));

  double drawn() const { return (centre(simulation.state.position, index(block)) - start).dot(along); }
};

// A hand that keeps a loaded block level while it draws it out: the block tilts on its neighbours by more than the torque limit
// can correct. Steps in which a torque at its limit was taken as constant took 9 iterations and more than a factorisation a
// frame, and farther out explicit steps.
TEST(Tether, ABlockLedAtTheLimitOfTheTorqueTakesImplicitSteps) {
  LoadedBlock loaded(1e-5);
  Simulation& simulation = loaded.simulation;
  Hand hand = handOn(simulation, loaded.block);
  hand.rate_rad_s = tuning::kDrawFrequency_rad_s;
  Grip grip;
  int limited = 0;
  constexpr int kFrames = 42;
  const Counters before = simulation.counters;
  for (int frame = 0; frame < kFrames; ++frame) {
    hand.velocity = LoadedBlock::speedAt(frame) * loaded.along;
    hand.place += simulation.scene.settings.frame_s * hand.velocity;
    hold(hand, contactForcesOn(simulation, loaded.block), grip, simulation);
    prepareAndStep(simulation);
    limited += gripForce(simulation).turnLimited ? 1 : 0;
  }
  EXPECT_GT(loaded.drawn(), 0.015);
  EXPECT_GT(limited, kFrames / 2);
  EXPECT_EQ(simulation.counters.newtonFailures, before.newtonFailures);
  EXPECT_LT(simulation.counters.implicitIterations - before.implicitIterations, 8U * kFrames);
  EXPECT_LT(simulation.counters.factorisations - before.factorisations, 1U * kFrames);
}

// A loaded block is drawn out completely, past the edges of its supports, one after the other: no frame requires explicit steps,
// which are hundreds.
TEST(Tether, ABlockDrawnOutTakesImplicitSteps) {
  for (const double tolerance_m : {1e-5, 2e-5, 5e-5, 1e-4}) {
    LoadedBlock loaded(tolerance_m);
    Simulation& simulation = loaded.simulation;
    Draw draw = drawingFrom(simulation, loaded.block, loaded.along, 0.0);
    int most = 0;
    for (int frame = 0; frame < 200 && loaded.drawn() < kBlockLength_m; ++frame) {
      draw.speed_m_s = LoadedBlock::speedAt(frame);
      advancePull(draw, contactForcesOn(simulation, loaded.block), simulation);
      prepareAndStep(simulation);
      most = std::max(most, simulation.substeps);
    }
    EXPECT_GE(loaded.drawn(), kBlockLength_m);
    EXPECT_LE(most, 8) << tolerance_m;
  }
}

}  // namespace
}  // namespace springtower
