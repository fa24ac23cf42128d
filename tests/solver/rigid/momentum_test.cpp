// What blocks that touch only one another keep: momentum and angular momentum.
#include "core/scene/scene.h"
#include "scenarios/registry.h"
#include "solver/world/simulation.h"
#include "tests/support/method_names.h"
#include "tests/support/momenta.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <cstddef>
#include <gtest/gtest.h>
#include <string>
#include <tuple>

namespace springtower {
namespace {

// Blocks turned at random that fly to their middle at 2 m/s a metre, while the middle drifts.
Scene cloud(Method method, int blocks, double restitution) {
  Scene scene = sceneNamed("heap:" + std::to_string(blocks));
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  scene.restitution = restitution;
  scene.settings.method = method;
  Vec3 middle = Vec3::Zero();
  for (const BlockSpec& block : scene.blocks) middle += block.centre / static_cast<double>(scene.blocks.size());
  for (BlockSpec& block : scene.blocks) block.velocity = 2.0 * (middle - block.centre) + Vec3(0.1, 0.05, 0.02);
  return scene;
}

struct Cloud : ::testing::TestWithParam<std::tuple<Method, int, double>> {};

// Every impulse acts on two blocks, equal and opposite; only rounding is left of the sum, 1e-16 of all of it each of some
// thousand times. The required bounds: 1e-12 and, about a place, 1e-9.
TEST_P(Cloud, KeepsItsMomenta) {
  const auto [method, blocks, restitution] = GetParam();
  Simulation simulation(cloud(method, blocks, restitution));
  const Momenta start = momentaOf(simulation, Vec3::Zero());
  const double begun_j = energy(simulation).kinetic;
  for (int frame = 0; frame < 60; ++frame) {
    prepareAndStep(simulation);
    const Momenta now = momentaOf(simulation, Vec3::Zero());
    ASSERT_LE((now.linear - start.linear).norm(), 1e-12 * start.linearSum) << "frame " << frame;
    ASSERT_LE((now.angular - start.angular).norm(), 1e-9 * start.angularSum) << "frame " << frame;
  }
  EXPECT_LT(energy(simulation).kinetic, 0.9 * begun_j) << "they have to meet";
}

std::string cloudName(const ::testing::TestParamInfo<Cloud::ParamType>& of) {
  const bool rebounds = std::get<2>(of.param) > 0.0;
  return methodName({std::get<0>(of.param), of.index}) + "_" + std::to_string(std::get<1>(of.param)) +
         (rebounds ? "_rebound" : "_do_not_rebound");
}

INSTANTIATE_TEST_SUITE_P(Methods, Cloud,
                         ::testing::Combine(::testing::Values(Method::implicit, Method::rigidPgs), ::testing::Values(8, 25, 60),
                                            ::testing::Values(0.0, 0.5)),
                         cloudName);

}  // namespace
}  // namespace springtower
