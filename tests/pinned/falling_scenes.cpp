#include "core/random.h"
#include "tests/pinned/pinned_scene.h"

#include <memory>

namespace springtower {
namespace {

constexpr int kSnapshotFrame = 30;  // rigid steps carry the fall by then
constexpr int kFramesGoneOn = 20;

Scene oneBlockAt(double height_m, const Eigen::Quaterniond& turn) {
  Scene scene;
  BlockSpec block;
  block.centre.z() = height_m;
  block.orientation = turn;
  scene.blocks = {block};
  return scene;
}

// Turned at random, on a lattice in which none can touch another. Without sines: no mathematical library has a say in it.
Scene heap(int blocks) {
  constexpr double kSpacing_m = 0.09;
  RandomStream random(1, 0);
  Scene scene;
  for (int i = 0; i < blocks; ++i) {
    BlockSpec block;
    block.centre = Vec3(kSpacing_m * (i % 2), kSpacing_m * (i / 2 % 2), 0.1 + kSpacing_m * (i / 4));
    for (Eigen::Index a = 0; a < 4; ++a) block.orientation.coeffs()[a] = random.normal();
    block.orientation.normalize();
    scene.blocks.push_back(block);
  }
  return scene;
}

// A tower topples: rigid steps carry the fall, implicit ones what has landed.
Scene collapse(int rows) {
  Scene scene = awake(towerScene(rows));
  scene.settings.tolerance_m = 1e-5;
  scene.gravity.tilt_deg = 14.5;
  return scene;
}

Scene rowsThatLand() {
  Scene scene = awake(towerScene(3));
  for (BlockSpec& block : scene.blocks) block.centre.z() += 0.02;
  scene.settings.tolerance_m = 1e-5;
  return scene;
}

Scene rowsApart() {
  TowerOptions options;
  options.startGap_m = 0.004;
  options.heightsSigma_m = 0.0002;
  return towerScene(3, options);
}

// About the axis of middle moment, so that it tumbles.
Scene spinWithoutGravity() {
  Scene scene = oneBlockAt(0.0, Eigen::Quaterniond::Identity());
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  scene.blocks[0].spin = Vec3(0.05, 10.0, 0.02);
  return scene;
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

Scene shotTower() {
  Scene scene = towerScene(6);
  BlockSpec shot;
  shot.centre = Vec3(-0.3, 0.0, 3.6 * kBlockHeight_m);
  shot.velocity = Vec3(5.0, 0.0, 0.0);
  scene.blocks.push_back(shot);
  return scene;
}

Scene sleeperHit() {
  Scene scene = towerScene(2);
  BlockSpec block;
  block.centre = Vec3(0.01, 0.0, 21.0);  // lands after some 2 s, when the tower sleeps
  block.orientation = Eigen::Quaterniond(0.99, 0.1, 0.05, 0.0).normalized();
  scene.blocks.push_back(block);
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
  const Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
  const Eigen::Quaterniond onCorner = Eigen::Quaterniond(0.8, 0.4, 0.4, 0.2).normalized();
  return {
      {"DropFlat", 60, [=] { return oneBlockAt(0.05, level); }},
      {"DropOnCorner", 90, [=] { return oneBlockAt(0.1, onCorner); }},
      {"DroppedBlock", 90, [] { return sceneOfFile("dropped_block"); }},
      {"HeapOf8", 120, [] { return heap(8); }},
      {"CollapseAndBack", 180, [] { return collapse(18); }},
      {"RowsThatLand", 60, rowsThatLand},
      {"RowsApart", 60, rowsApart},
      {"RestoredFall", 80, [] { return collapse(18); }, backToASnapshot},
      {"SpinWithoutGravity", 120, spinWithoutGravity},
      {"BlocksThatFly", 40, blocksThatFly},
      {"ThrownPair", 60, [] { return sceneOfFile("two_thrown_blocks"); }},
      {"ThinWall", 40, [] { return sceneOfFile("thin_wall"); }},
      {"ShotTower", 40, shotTower},
      {"SleeperHit", 160, sleeperHit},
  };
}

}  // namespace springtower
