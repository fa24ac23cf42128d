#include "scenarios/loose.h"

#include "core/elementary.h"
#include "core/rotation_vector.h"

#include <cmath>

namespace springtower {

Scene oneBlockScene(bool floor) {
  Scene scene;
  scene.name = "one block";
  BlockSpec block;
  block.centre.z() = 0.5 * block.dimensions.z();
  scene.blocks.push_back(block);
  scene.floor = floor;
  scene.settings.sleep = Sleep::off;
  return scene;
}

Scene droppedBlockScene(double height_m, const Eigen::Quaterniond& turn) {
  Scene scene;
  BlockSpec block;
  block.centre.z() = height_m;
  block.orientation = turn;
  scene.blocks = {block};
  return scene;
}

Eigen::Quaterniond ontoACorner() {
  return Eigen::Quaterniond(0.8, 0.4, 0.4, 0.2).normalized();
}

Scene blockOnSlopeScene(double tilt_deg, double direction_deg) {
  Scene scene = droppedBlockScene(0.5 * kBlockHeight_m);
  scene.gravity.tilt_deg = tilt_deg;
  scene.gravity.direction_deg = direction_deg;
  return scene;
}

Scene steepSlopeScene() {
  Scene scene = blockOnSlopeScene(21.583, 30.0);
  scene.seconds = 61.0;
  return scene;
}

Scene slidingBlockScene() {
  Scene scene = droppedBlockScene(0.5 * kBlockHeight_m);
  scene.blocks[0].velocity.x() = 0.7;
  return scene;
}

Scene spinningBlockScene() {
  Scene scene = droppedBlockScene(0.0);
  scene.blocks[0].spin = Vec3(0.05, 10.0, 0.02);
  scene.floor = false;
  scene.gravity.magnitude = 0.0;
  return scene;
}

Scene thrownPairScene() {
  constexpr double kThrown_m_s = 3.0;
  Scene scene;
  for (int i = 0; i < 2; ++i) {
    BlockSpec block;
    const double side = i == 0 ? -1.0 : 1.0;
    block.centre = Vec3(0.1 * side, 0.004 * side, 0.15);
    block.velocity.x() = -kThrown_m_s * side;
    block.orientation = rotationAbout(Vec3::UnitZ(), 0.3 + 0.4 * i) * rotationAbout(Vec3::UnitX(), 0.2);
    scene.blocks.push_back(block);
  }
  return scene;
}

Scene thinWallScene() {
  constexpr double kBetween_m = 0.0815;
  Scene scene;
  for (int i = -1; i <= 1; ++i) {
    BlockSpec block;
    block.centre = Vec3(0.0, kBetween_m * i, 0.03);
    block.dimensions = Vec3(0.01, 0.081, 0.06);
    block.mass = 0.0242;
    scene.blocks.push_back(block);
  }
  BlockSpec thrown;
  thrown.centre = Vec3(-0.2, 0.0, 0.035);
  thrown.velocity.x() = 5.0;
  scene.blocks.push_back(thrown);
  scene.seconds = 1.0;
  return scene;
}

Scene askewPileScene(int blocks) {
  Scene scene;
  for (int i = 0; i < blocks; ++i) {
    BlockSpec block;
    block.centre = Vec3(0.02 * elementary::cos(2.0 * i), 0.02 * elementary::sin(2.0 * i), 0.04 + 0.04 * i);
    block.orientation = rotationAbout(Vec3::UnitZ(), 1.1 * i) * rotationAbout(Vec3::UnitY(), 0.15 + 0.05 * i);
    scene.blocks.push_back(block);
  }
  return scene;
}

}  // namespace springtower
