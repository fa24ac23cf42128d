// Slender blocks: their springs hardly resist a twist of the ends.
#include "core/scene/scene.h"
#include "solver/block/springs.h"
#include "solver/frame/prepare.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/world/simulation.h"
#include "tests/support/block_scenes.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

Scene sceneOf(const Vec3& dimensions_m, double drop_m) {
  Scene scene;
  scene.settings.sleep = Sleep::off;
  BlockSpec block;
  block.dimensions = dimensions_m;
  block.mass = 600.0 * dimensions_m.prod();
  block.centre.z() = drop_m + 0.5 * dimensions_m.z();
  scene.blocks = {block};
  return scene;
}

// Twists a block by an angle between its ends, about its x axis.
void twist(double angle_rad, Simulation& simulation) {
  ParticleArray& x = simulation.state.position;
  const Vec3 middle = centre(x, 0);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm = x.at(0, c) - middle;
    const double turn_rad = 0.5 * angle_rad * cornerSide(c, 0);
    x.set(0, c, middle + Eigen::AngleAxisd(turn_rad, Vec3::UnitX()) * arm);
  }
}

// What carries a block acts on its mean edges. As the ends twist by t these get shorter by t^2 / 8: a load N sinks by that share
// of the height. The springs must store four times as much.
TEST(Warps, StoreMoreThanALoadGivesWhereTheEndsTwist) {
  for (const Vec3& size : {Vec3(0.075, 0.025, 0.015), Vec3(0.117, 0.0234, 0.0078), Vec3(0.5, 0.02, 0.02), Vec3(1.0, 0.02, 0.02),
                           Vec3(1.0, 0.04, 0.005)}) {
    Simulation simulation(sceneOf(size, 0.0));
    constexpr double kTwist_rad = 1e-3;
    const double load_n = 4.0 * simulation.stiffness.edge_n_m[0] * simulation.tolerance_m;
    twist(kTwist_rad, simulation);
    const double given_j = load_n * kTwist_rad * kTwist_rad / 8.0 * std::max(size.y(), size.z());
    EXPECT_GE(springEnergy(simulation.model, simulation.state.position, 0), 3.99 * given_j) << size.transpose();
  }
}

// A standard block has enough by its springs.
TEST(Warps, OfAStandardBlockAreLeftToItsSprings) {
  const Simulation simulation(sceneOf(Vec3(kBlockLength_m, kBlockWidth_m, kBlockHeight_m), 0.0));
  EXPECT_EQ(simulation.model.warpStiffnessOf(0), 0.0);
}

// Forces are minus the derivative of the energy, by central differences; and they move and turn nothing.
TEST(Warps, HaveForcesThatFollowFromTheirEnergy) {
  Simulation simulation(sceneOf(Vec3(1.0, 0.02, 0.02), 0.0));
  twist(0.02, simulation);
  ParticleArray& x = simulation.state.position;
  ParticleArray force;
  force.resize(1);
  const std::vector<AffineField> none(1);
  const std::vector<std::int32_t> only = {0};
  springForces(simulation.model, simulation.state, only, none, force);
  constexpr double kShift_m = 1e-7;
  Vec3 sum = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  double largest = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) {
    sum += force.at(0, c);
    torque += x.at(0, c).cross(force.at(0, c));
    largest = std::max(largest, force.at(0, c).norm());
    for (Eigen::Index a = 0; a < 3; ++a) {
      const Vec3 shift = kShift_m * Vec3::Unit(a);
      x.add(0, c, shift);
      const double more_j = springEnergy(simulation.model, x, 0);
      x.add(0, c, -2.0 * shift);
      const double less_j = springEnergy(simulation.model, x, 0);
      x.add(0, c, shift);
      EXPECT_NEAR(force.at(0, c)[a], (less_j - more_j) / (2.0 * kShift_m), 1e-5 * largest + 1e-6);
    }
  }
  EXPECT_LT(sum.norm(), 1e-12 * largest);
  EXPECT_LT(torque.norm(), 1e-9 * largest);
}

// Beams and a lath that land flat: they twisted by themselves, and their corners got 1 mm into the floor.
TEST(Warps, BeamsRestOnTheFloor) {
  for (const Vec3& size : {Vec3(1.0, 0.02, 0.02), Vec3(0.5, 0.02, 0.02), Vec3(1.0, 0.04, 0.005)}) {
    SCOPED_TRACE(testing::Message() << size.transpose());
    Simulation simulation(sceneOf(size, 0.02));
    prepare(simulation);
    for (int frame = 0; frame < 240; ++frame) stepFrame(simulation);
    PenetrationWorkspace workspace;
    EXPECT_LE(maxPenetration(simulation.state.position, true, workspace).depth, simulation.tolerance_m);
    EXPECT_LT(rootMeanSquareCornerSpeed(simulation.state.velocity), 1e-6);
  }
}

}  // namespace
}  // namespace springtower
