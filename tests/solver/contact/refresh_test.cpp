// When the manifold of blocks that touch is computed anew.
#include "core/tuning.h"
#include "scenarios/towers.h"
#include "solver/contact/query.h"
#include "solver/metrics/measures.h"
#include "solver/runner/run.h"
#include "solver/world/engine.h"
#include "tests/support/block_scenes.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace springtower {
namespace {

// The top of the tower moves by 0.9 mm in a second, and two blocks of it by twice as much together: five times that after which a
// pair is looked at. But no two move against each other by more than micrometres. By the way alone there are 327 refreshes.
TEST(Refresh, BlocksThatSwayTogetherKeepTheirManifolds) {
  Simulation simulation(awake(swaying(towerScene(18), 1.0, 1.0)));
  stepFor(simulation, 0.5);
  const Counters before = simulation.counters;
  const double way_m = simulation.engine->memo.blockHistory[53].travel;
  stepFor(simulation, 1.0);
  EXPECT_GT(simulation.engine->memo.blockHistory[53].travel - way_m,
            2.0 * tuning::kRefreshTravel * simulation.lengths.blockHeight_m);
  EXPECT_LT(simulation.counters.manifoldRefreshes - before.manifoldRefreshes, 20U);
}

// A block slides along the one below it, over the end of it. The outline of its contact is where the faces overlap, to within
// the way after which it is refreshed.
TEST(Refresh, TheOutlineFollowsABlockThatSlides) {
  Scene scene;
  BlockSpec block;
  block.dimensions = {kBlockLength_m, kBlockWidth_m, kBlockHeight_m};
  block.centre = {0.0, 0.0, 0.5 * kBlockHeight_m};
  scene.blocks.push_back(block);
  block.centre.z() += kBlockHeight_m;
  scene.blocks.push_back(block);
  const double weight_n = kBlockMass_kg * 9.81;
  scene.forces.push_back(constantForce(1, -1, Vec3(1.1 * scene.staticFriction * weight_n, 0.0, 0.0), 0.1, 10.0));
  Simulation simulation(awake(scene));
  stepFor(simulation, 0.3);
  const double slid_m = centre(simulation.state.position, 1).x() - centre(simulation.state.position, 0).x();
  ASSERT_GT(slid_m, 0.002);
  const Engine& engine = *simulation.engine;
  const auto at = static_cast<std::size_t>(std::ranges::find(engine.pairs.key, BlockPair{0, 1}) - engine.pairs.key.begin());
  ASSERT_LT(at, engine.pairs.size());
  const ContactView manifold = contactOf(engine, at);
  ASSERT_EQ(manifold.count, 4);
  const PointForces points = forcesNow(simulation, manifold);
  double left = points.place[0].x();
  double right = left;
  for (std::size_t i = 1; i < 4; ++i) {
    left = std::min(left, points.place[i].x());
    right = std::max(right, points.place[i].x());
  }
  EXPECT_NEAR(right - left, kBlockLength_m - slid_m, 1.5 * tuning::kSlidingRefreshTravel * simulation.lengths.blockHeight_m);
}

}  // namespace
}  // namespace springtower
