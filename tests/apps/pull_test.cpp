// A block drawn out of the tower, as `springtower profile` times it.
#include "apps/profile_scene.h"

#include <gtest/gtest.h>

namespace springtower {
namespace {

// Friction on a drawn block follows the loads on it, which no symmetric matrix tells: with that alone a step took three
// iterations and a frame more than one new factorisation. With the contacts' tangents beside the factors most steps take one.
TEST(Pull, ADrawnBlockTakesHardlyMoreThanAnIterationAStep) {
  ProfileCase what;
  what.scene = ProfileScene::pull;
  what.rows = 18;
  what.method = Method::implicit;
  what.tolerance_m = 1e-5;
  const std::unique_ptr<PreparedScene> scene = prepareScene(what, ProfileLimits{});
  ASSERT_EQ(scene->failure, "");
  constexpr int kFrames = 24;
  for (int frame = 0; frame < 5; ++frame) scene->step();
  const Counters before = scene->simulation.counters;
  const double start =
      centre(scene->simulation.state.position, static_cast<std::size_t>(scene->hand.block)).dot(scene->hand.direction);
  for (int frame = 0; frame < kFrames; ++frame) scene->step();
  const Counters& after = scene->simulation.counters;
  const double end =
      centre(scene->simulation.state.position, static_cast<std::size_t>(scene->hand.block)).dot(scene->hand.direction);
  EXPECT_NEAR(end - start, kProfilePullSpeed_m_s * kFrames / 60.0, 0.003) << "it slides all the time";
  const auto steps = static_cast<double>(after.implicitSteps - before.implicitSteps);
  EXPECT_EQ(steps, 4.0 * kFrames);
  EXPECT_LE(static_cast<double>(after.implicitIterations - before.implicitIterations), 1.5 * steps);
  EXPECT_LE(after.factorisations - before.factorisations, kFrames / 3U);
}

}  // namespace
}  // namespace springtower
