#include "scenarios/falling.h"

#include "core/random.h"

#include <algorithm>

namespace springtower {
namespace {

// A block's largest diagonal is 87.2 mm.
constexpr double kHeapSpacing_m = 0.09;
constexpr double kHeapLowest_m = 0.145;
constexpr double kRainSpacing_m = 0.1;
constexpr double kRainLowest_m = 0.06;

// Without sines, so that it does not depend on a mathematical library.
BlockSpec turnedAtRandom(RandomStream& random, const Vec3& centre) {
  BlockSpec block;
  block.centre = centre;
  for (Eigen::Index a = 0; a < 4; ++a) block.orientation.coeffs()[a] = random.normal();
  block.orientation.normalize();
  return block;
}

}  // namespace

Scene heapScene(int blocks) {
  int side = 3;
  while (1.5 * (side + 0.5) * (side + 0.5) * (side + 0.5) < blocks) ++side;
  RandomStream random(1, 0);
  Scene scene;
  const double middle = 0.5 * (side - 1);
  for (int i = 0; i < blocks; ++i) {
    const int row = i / side % side;
    const int level = i / (side * side);
    const Vec3 centre(kHeapSpacing_m * (i % side - middle), kHeapSpacing_m * (row - middle),
                      kHeapLowest_m + kHeapSpacing_m * level);
    scene.blocks.push_back(turnedAtRandom(random, centre));
  }
  return scene;
}

Scene shaftScene(int blocks) {
  constexpr int kSide = 2;
  RandomStream random(1, 0);
  Scene scene;
  for (int i = 0; i < blocks; ++i) {
    const int row = i / kSide % kSide;
    const int level = i / (kSide * kSide);
    const Vec3 centre(kHeapSpacing_m * (i % kSide), kHeapSpacing_m * row, 0.1 + kHeapSpacing_m * level);
    scene.blocks.push_back(turnedAtRandom(random, centre));
  }
  return scene;
}

Scene rainScene(int blocks) {
  constexpr int kSide = 4;
  constexpr double kMiddle = 0.5 * (kSide - 1);
  const int layers = (blocks + kSide * kSide - 1) / (kSide * kSide);
  RandomStream random(2, 0);
  Scene scene;
  double height_m = kRainLowest_m;
  for (int i = 0; i < blocks; ++i) {
    const int row = i / kSide % kSide;
    if (i % (kSide * kSide) == 0) {
      const int layer = i / (kSide * kSide);
      const double lands_s = static_cast<double>(layer + 1) / layers;
      height_m = std::max(height_m + kHeapSpacing_m, 0.5 * kStandardGravity_m_s2 * lands_s * lands_s);
    }
    const Vec3 centre(kRainSpacing_m * (i % kSide - kMiddle), kRainSpacing_m * (row - kMiddle), height_m);
    scene.blocks.push_back(turnedAtRandom(random, centre));
  }
  return scene;
}

Scene shotTowerScene(int rows) {
  Scene scene = towerScene(rows);
  BlockSpec shot;
  shot.centre = Vec3(-0.3, 0.0, 3.0 * rows / 5.0 * kBlockHeight_m);
  shot.velocity = Vec3(5.0, 0.0, 0.0);
  scene.blocks.push_back(shot);
  return scene;
}

}  // namespace springtower
