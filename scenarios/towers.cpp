#include "scenarios/towers.h"

#include "core/elementary.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace springtower {
namespace {

// Tilt of the collapsing tower beyond its limit; a short tower would slide first.
constexpr double kBeyondStanding_deg = 0.6;
constexpr double kMaxTilt_deg = 30.0;

void addCopy(const std::vector<BlockSpec>& blocks, const Vec3& by, Scene& scene) {
  for (BlockSpec block : blocks) {
    block.centre += by;
    scene.blocks.push_back(block);
  }
}

}  // namespace

Scene awake(Scene scene) {
  scene.settings.sleep = Sleep::off;
  return scene;
}

Scene leaning(Scene scene, double tilt_deg) {
  scene.gravity.tilt_deg = tilt_deg;
  return scene;
}

Scene swaying(Scene scene, double amplitude_deg, double frequency_hz) {
  scene.gravity.sway_deg = amplitude_deg;
  scene.gravity.sway_hz = frequency_hz;
  return scene;
}

Scene raised(Scene scene, double by_m) {
  for (BlockSpec& block : scene.blocks) block.centre.z() += by_m;
  return scene;
}

Scene withHeavyRows(Scene scene, double factor) {
  for (BlockSpec& block : scene.blocks) {
    if (block.row % 2 == 1) block.mass *= factor;
  }
  return scene;
}

Scene grid(Scene one, int along, int across, double spacing_m) {
  const std::vector<BlockSpec> blocks = std::exchange(one.blocks, {});
  for (int x = 0; x < along; ++x) {
    for (int y = 0; y < across; ++y) addCopy(blocks, Vec3(spacing_m * x, spacing_m * y, 0.0), one);
  }
  return one;
}

Scene squareOf(Scene one, int copies) {
  const std::vector<BlockSpec> blocks = std::exchange(one.blocks, {});
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(copies))));
  for (int i = 0; i < copies; ++i) {
    const int line = i / side;
    addCopy(blocks, kTowerSpacing_m * Vec3(i - line * side, line, 0.0), one);
  }
  return one;
}

Scene touchingTowersScene(int towers, const TowerOptions& options) {
  return grid(towerScene(18, options), towers, 1, kBlockLength_m);
}

Scene towerWithHolesScene(const TowerOptions& options) {
  return bitCodeScene("(111)-(101)-(111)-(010)-(111)-(101)-(111)-(101)-(111)-(010)-(111)-(111)", options);
}

double collapseTilt_deg(int rows) {
  const double standing = elementary::atan(kBlockLength_m / (rows * kBlockHeight_m)) * 180.0 / std::numbers::pi;
  return std::min(standing + kBeyondStanding_deg, kMaxTilt_deg);
}

Scene sleeperHitScene() {
  Scene scene = towerScene(2);
  BlockSpec block;
  block.centre = Vec3(0.01, 0.0, 21.0);  // lands after some 2 s, when the tower sleeps
  block.orientation = Eigen::Quaterniond(0.99, 0.1, 0.05, 0.0).normalized();
  scene.blocks.push_back(block);
  return scene;
}

std::size_t middleBlock(const Scene& tower) {
  const int rows = tower.blocks.back().row + 1;
  const auto found = std::find_if(tower.blocks.begin(), tower.blocks.end(),
                                  [&](const BlockSpec& block) { return block.row == rows / 2 && block.position == 2; });
  return static_cast<std::size_t>(found - tower.blocks.begin());
}

}  // namespace springtower
