#include "scenarios/falling.h"
#include "scenarios/loose.h"
#include "tests/pinned/pinned_scene.h"

#include <memory>

namespace springtower {
namespace {

constexpr int kSnapshotFrame = 30;  // rigid steps carry the fall by then
constexpr int kFramesGoneOn = 20;

// A tower topples: rigid steps carry the fall, implicit ones what has landed.
Scene collapse(int rows) {
  Scene scene = leaning(awake(towerScene(rows)), kTopplingTilt_deg);
  scene.settings.tolerance_m = 1e-5;
  return scene;
}

Scene rowsThatLand() {
  Scene scene = raised(awake(towerScene(3)), 0.02);
  scene.settings.tolerance_m = 1e-5;
  return scene;
}

Scene rowsApart() {
  TowerOptions options;
  options.startGap_m = 0.004;
  options.heightsSigma_m = 0.0002;
  return towerScene(3, options);
}

Scene blocksThatFly() {
  Scene scene = towerScene(1);
  for (BlockSpec& block : scene.blocks) {
    block.centre += Vec3(0.0, 2.0 * block.centre.y(), 1.0);
    block.velocity = Vec3(0.3, 0.0, 1.0);
    block.spin = Vec3(3.0, 2.0, 10.0);
  }
  return scene;
}

// Steps on from a snapshot, goes back to it and takes the same way again.
Leader backToASnapshot() {
  return [played = 0, kept = std::shared_ptr<const Snapshot>()](Simulation& simulation) mutable {
    if (played == kSnapshotFrame) kept = takeSnapshot(simulation);
    if (played == kSnapshotFrame + kFramesGoneOn) restoreSnapshot(simulation, *kept);
    ++played;
  };
}

}  // namespace

std::vector<PinnedScene> pinnedFalls() {
  return {
      {"DropFlat", 60, [] { return droppedBlockScene(0.05); }},
      {"DropOnCorner", 90, [] { return droppedBlockScene(0.1, ontoACorner()); }},
      {"DroppedBlock", 90, [] { return sceneOfFile("dropped_block"); }},
      {"HeapOf8", 120, [] { return shaftScene(8); }},
      {"CollapseAndBack", 180, [] { return collapse(18); }},
      {"RowsThatLand", 60, rowsThatLand},
      {"RowsApart", 60, rowsApart},
      {"RestoredFall", 80, [] { return collapse(18); }, backToASnapshot},
      {"SpinWithoutGravity", 120, spinningBlockScene},
      {"BlocksThatFly", 40, blocksThatFly},
      {"ThrownPair", 60, [] { return sceneOfFile("two_thrown_blocks"); }},
      {"ThinWall", 40, [] { return sceneOfFile("thin_wall"); }},
      {"ShotTower", 40, [] { return shotTowerScene(6); }},
      {"SleeperHit", 160, sleeperHitScene},
  };
}

}  // namespace springtower
