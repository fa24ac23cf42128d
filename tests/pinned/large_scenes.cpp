#include "scenarios/walls.h"
#include "tests/pinned/pinned_scene.h"

namespace springtower {
namespace {

Scene hundredTowers() {
  TowerOptions options;
  options.heightsSigma_m = kUnevenHeightsSigma_m;
  options.seed = 3;
  return grid(towerScene(2, options), 10, 10, 0.2);
}

// Five full towers end against end, which sway: one island of 270 blocks that bends.
Scene touchingTowers() {
  return swaying(awake(touchingTowersScene(5)), 0.1, 2.0);
}

Scene landingPile() {
  Scene scene = pileScene(3, {.fall_m = 0.01});
  scene.settings.tolerance_m = 2e-4;
  return scene;
}

// Eight leaning stacks that slide and topple, each an island of its own.
Scene toppling() {
  return leaning(grid(towerScene(4), 4, 2, kTowerSpacing_m), 30.0);
}

// A wall of 306 blocks that slides over the floor until friction stops it: what has fallen is solved without fill.
Scene slidingWall() {
  Scene scene = awake(wallScene(25, 12));
  for (BlockSpec& block : scene.blocks) block.velocity = Vec3(0.3, 0.0, 0.0);
  return scene;
}

}  // namespace

std::vector<PinnedScene> pinnedLarge() {
  return {
      {"WallOf246", 30, [] { return awake(wallScene(20, 12)); }},
      {"SlidingWallOf306", 24, slidingWall},
      {"SmallWallFallsAsleep", 200, [] { return wallScene(5, 6); }},
      {"PyramidOf10", 60, [] { return awake(cubePyramidScene(10)); }},
      {"PyramidFallsAsleep", 200, [] { return cubePyramidScene(6); }},
      {"PileLands", 3, landingPile},
      {"PileRests", 20, [] { return awake(pileScene(3)); }},
      {"HundredTowers", 20, hundredTowers},
      {"TouchingTowers", 20, touchingTowers},
      {"TopplingStacks", 40, toppling},
  };
}

}  // namespace springtower
