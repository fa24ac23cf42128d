#include "apps/chart_scene.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace springtower {
namespace {

constexpr double kHeightsSigma_m = 0.0002;
constexpr double kDrop_m = 0.02;
constexpr int kDropRows = 3;
// The collapsing tower leans by a little more than it can stand; a short one would slide before.
constexpr double kBeyond_deg = 0.6;
constexpr double kMostTilt_deg = 30.0;
constexpr double kHeavy = 10.0;
constexpr double kMotion_s = 2.0;  // of scenes that do not come to rest

double collapseTilt_deg(int rows) {
  const double standing = std::atan(kBlockLength_m / (rows * kBlockHeight_m)) * 180.0 / std::numbers::pi;
  return std::min(standing + kBeyond_deg, kMostTilt_deg);
}

Scene blocksOf(ChartScene scene, int rows) {
  if (scene == ChartScene::spin) {
    Scene one;
    one.name = "one block";
    BlockSpec block;
    block.spin = Vec3(0.05, 10.0, 0.02);  // about the axis of middle moment, so that it tumbles
    one.blocks.push_back(block);
    one.floor = false;
    one.gravity.magnitude = 0.0;
    return one;
  }
  TowerOptions options;
  if (scene == ChartScene::heights) options.heightsSigma_m = kHeightsSigma_m;
  Scene tower = towerScene(scene == ChartScene::drop ? std::min(rows, kDropRows) : rows, options);
  for (BlockSpec& block : tower.blocks) {
    if (scene == ChartScene::drop) block.centre.z() += kDrop_m;
    if (scene == ChartScene::heavyLight && block.row % 2 == 1) block.mass *= kHeavy;
  }
  if (scene == ChartScene::collapse) tower.gravity.tilt_deg = collapseTilt_deg(rows);
  return tower;
}

struct Sweep {
  Method method;
  Knob knob;
  std::vector<double> values;
  std::vector<double> quick;
};

const std::vector<Sweep>& sweeps() {
  static const std::vector<Sweep> all = {
      {Method::implicit, Knob::tolerance, {2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 1e-6}, {5e-5, 1e-5}},
      {Method::semiImplicitEuler, Knob::tolerance, {2e-4, 1e-4, 5e-5, 2e-5, 1e-5}, {1e-4, 5e-5}},
      {Method::midpoint, Knob::tolerance, {2e-4, 1e-4}, {1e-4}},
      {Method::rungeKutta4, Knob::tolerance, {2e-4, 1e-4, 5e-5}, {1e-4}},
      {Method::report, Knob::tolerance, {1e-3, 2e-4, 5e-5}, {1e-3}},
      {Method::rigidPgs, Knob::substeps, {4, 8, 16, 32, 64, 128}, {16, 64}},
      {Method::rigidLcp, Knob::substeps, {1, 2, 4}, {1}},
      {Method::xpbd, Knob::substeps, {12, 25, 50, 100, 200}, {25, 100}},
  };
  return all;
}

}  // namespace

std::string nameOf(const ChartCase& what) {
  if (what.knob == Knob::tolerance) return fmt::format("{} {:g} mm", nameOf(what.method), 1e3 * what.value);
  return fmt::format("{} {:g} step{}", nameOf(what.method), what.value, what.value == 1.0 ? "" : "s");
}

Scene sceneOf(const ChartCase& what, const ChartLimits& limits) {
  Scene scene = blocksOf(what.scene, limits.rows);
  scene.settings.method = what.method;
  scene.settings.sleep = Sleep::off;
  if (what.knob == Knob::tolerance) {
    scene.settings.tolerance_m = what.value;
  } else {
    scene.settings.substeps = static_cast<int>(what.value);
  }
  return scene;
}

std::vector<ChartCase> casesOf(ChartScene scene, const std::vector<Method>& methods, bool quick) {
  std::vector<ChartCase> cases;
  for (const Sweep& sweep : sweeps()) {
    if (std::find(methods.begin(), methods.end(), sweep.method) == methods.end()) continue;
    for (const double value : quick ? sweep.quick : sweep.values) cases.push_back({scene, sweep.method, sweep.knob, value});
  }
  return cases;
}

ChartTimes timesOf(ChartScene scene, const ChartLimits& limits) {
  const double half_s = 0.5 * limits.seconds;
  switch (scene) {
    case ChartScene::uniform:
    case ChartScene::heights:
    case ChartScene::heavyLight:
      return {half_s, half_s, limits.seconds};
    case ChartScene::pull:
      return {0.2 * limits.seconds, 0.2 * limits.seconds, 0.2 * limits.seconds + std::min(kMotion_s, half_s)};
    case ChartScene::drop:
      return {0.0, half_s, limits.seconds};
    case ChartScene::collapse:
    case ChartScene::spin:
      break;
  }
  return {0.0, 0.0, std::min(kMotion_s, limits.seconds)};
}

std::optional<bool> expectedToStand(ChartScene scene) {
  if (scene == ChartScene::spin) return {};
  return scene != ChartScene::collapse;
}

int pulledBlock(ChartScene scene, const Scene& blocks, int rows) {
  if (scene != ChartScene::pull) return -1;
  const auto found = std::find_if(blocks.blocks.begin(), blocks.blocks.end(),
                                  [&](const BlockSpec& block) { return block.row == rows / 2 && block.position == 2; });
  return static_cast<int>(found - blocks.blocks.begin());
}

}  // namespace springtower
