#include "core/scene/scene.h"
#include "solver/world/simulation.h"
#include "tests/support/prepare_and_step.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

class SweptPathTest : public ::testing::TestWithParam<Method> {};

// A toppling tower: its blocks rotate and are thrown aside within a frame, so that their paths are longer than the margins of
// their swept boxes, and yet rarely lead out of these. When every such path had its frame run again, that happened 39 and 56
// times in these 90 frames.
TEST_P(SweptPathTest, SeldomLeadsOutOfItsBox) {
  Scene scene = towerScene(6);
  scene.gravity.tilt_deg = 35.0;
  scene.settings.method = GetParam();
  scene.settings.tolerance_m = 2e-4;
  Simulation simulation(scene);
  for (int frame = 0; frame < 90; ++frame) prepareAndStep(simulation);
  EXPECT_LE(simulation.counters.replayedFrames, 4U);
  EXPECT_GT(simulation.counters.contactsCreated, 100U) << "blocks meet all the time";
  EXPECT_EQ(simulation.counters.contactsCreatedPenetrating, 0U);
}

INSTANTIATE_TEST_SUITE_P(Methods, SweptPathTest, ::testing::Values(Method::implicit, Method::semiImplicitEuler),
                         [](const auto& tested) { return tested.param == Method::implicit ? "implicit" : "explicit"; });

}  // namespace
}  // namespace springtower
