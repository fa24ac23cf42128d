#include "apps/commands/chart/scene.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace springtower {
namespace {

constexpr double kChartHeightsSigma_m = 0.0002;
constexpr double kChartPullSpeed_m_s = 0.04;
constexpr double kStrongestPull_n = 100.0;
constexpr double kDrop_m = 0.02;
constexpr int kDropRows = 3;
// The collapsing tower leans by a little more than it can stand; a short one would slide before.
constexpr double kBeyondStanding_deg = 0.6;
constexpr double kMaxTilt_deg = 30.0;
constexpr double kHeavyFactor = 10.0;
constexpr int kLeanRows = 9;
constexpr double kLean_deg = 9.0;
constexpr int kTallRows = 36;
constexpr double kMotion_s = 2.0;  // of scenes that do not come to rest

double collapseTilt_deg(int rows) {
  const double standing = std::atan(kBlockLength_m / (rows * kBlockHeight_m)) * 180.0 / std::numbers::pi;
  return std::min(standing + kBeyondStanding_deg, kMaxTilt_deg);
}

// One block that slides until friction stops it, eight that fall askew and come to lie in a heap, or two that are thrown at one
// another.
Scene looseBlocks(ChartScene kind) {
  constexpr int kHeap = 8;
  constexpr double kThrown_m_s = 3.0;
  Scene scene;
  scene.name = nameOf(kind);
  const int count = kind == ChartScene::heap ? kHeap : kind == ChartScene::thrown ? 2 : 1;
  for (int i = 0; i < count; ++i) {
    BlockSpec block;
    if (kind == ChartScene::heap) {
      block.centre = Vec3(0.02 * std::cos(2.0 * i), 0.02 * std::sin(2.0 * i), 0.04 + 0.04 * i);
      block.orientation = Eigen::AngleAxisd(1.1 * i, Vec3::UnitZ()) * Eigen::AngleAxisd(0.15 + 0.05 * i, Vec3::UnitY());
    } else if (kind == ChartScene::thrown) {
      const double side = i == 0 ? -1.0 : 1.0;
      block.centre = Vec3(0.1 * side, 0.004 * side, 0.15);
      block.velocity.x() = -kThrown_m_s * side;
      block.orientation = Eigen::AngleAxisd(0.3 + 0.4 * i, Vec3::UnitZ()) * Eigen::AngleAxisd(0.2, Vec3::UnitX());
    } else {
      block.centre.z() = 0.5 * kBlockHeight_m;
      block.velocity.x() = 0.7;
    }
    scene.blocks.push_back(block);
  }
  return scene;
}

bool hasRows(ChartScene scene) {
  return scene != ChartScene::spin && scene != ChartScene::slide && scene != ChartScene::heap && scene != ChartScene::thrown;
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
  if (!hasRows(scene)) return looseBlocks(scene);
  if (scene == ChartScene::holes) return bitCodeScene("(111)-(101)-(111)-(010)-(111)-(101)-(111)-(101)-(111)-(010)-(111)-(111)");
  if (scene == ChartScene::lean) rows = kLeanRows;
  if (scene == ChartScene::tall) rows = kTallRows;
  TowerOptions options;
  if (scene == ChartScene::heights) options.heightsSigma_m = kChartHeightsSigma_m;
  Scene tower = towerScene(scene == ChartScene::drop ? std::min(rows, kDropRows) : rows, options);
  for (BlockSpec& block : tower.blocks) {
    if (scene == ChartScene::drop) block.centre.z() += kDrop_m;
    if (scene == ChartScene::heavyLight && block.row % 2 == 1) block.mass *= kHeavyFactor;
  }
  if (scene == ChartScene::collapse) tower.gravity.tilt_deg = collapseTilt_deg(rows);
  if (scene == ChartScene::lean) tower.gravity.tilt_deg = kLean_deg;
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
      {Method::implicitEuler, Knob::tolerance, {2e-4, 5e-5, 1e-5}, {5e-5}},
      {Method::implicitEigen, Knob::tolerance, {2e-4, 5e-5, 1e-5}, {5e-5}},
      {Method::semiImplicitEuler, Knob::tolerance, {2e-4, 1e-4, 5e-5, 2e-5, 1e-5}, {1e-4, 5e-5}},
      {Method::midpoint, Knob::tolerance, {2e-4, 1e-4}, {1e-4}},
      {Method::rungeKutta4, Knob::tolerance, {2e-4, 1e-4, 5e-5}, {1e-4}},
      {Method::report, Knob::tolerance, {1e-3, 2e-4, 5e-5}, {1e-3}},
      {Method::rigidPgs, Knob::substeps, {4, 8, 16, 32, 64, 128}, {16, 64}},
      {Method::rigidLcp, Knob::substeps, {1, 2, 4}, {1}},
      {Method::automatic, Knob::tolerance, {kAutoTolerance_m}, {kAutoTolerance_m}},
      {Method::xpbd, Knob::substeps, {12, 25, 50, 100, 200}, {25, 100}},
  };
  return all;
}

// Other engines: as they come, then their own knobs. Our own iterating methods have the second knob too.
struct StepsAndIterations {
  double substeps;
  int iterations;
};
const std::vector<StepsAndIterations> kPeerKnobs = {{1, 0}, {1, 200}, {4, 0}, {4, 50}, {8, 0}, {16, 0}, {32, 0}};
const std::vector<StepsAndIterations> kQuickPeerKnobs = {{1, 0}, {16, 0}};
const std::vector<StepsAndIterations> kMoreIterations = {{4, 16}, {8, 16}, {16, 16}};

}  // namespace

std::string nameOf(const ChartCase& what) {
  if (what.knob == Knob::tolerance) return fmt::format("{} {:g} mm", methodOf(what), 1e3 * what.value);
  const std::string steps = fmt::format("{} {:g} step{}", methodOf(what), what.value, what.value == 1.0 ? "" : "s");
  return what.iterations == 0 ? steps : fmt::format("{}, {} iterations", steps, what.iterations);
}

Scene sceneOf(const ChartCase& what, const ChartLimits& limits) {
  Scene scene = blocksOf(what.scene, limits.rows);
  scene.settings.method = what.peer == Peer::none ? what.method : Method::rigidPgs;  // whose blocks are rigid as well
  scene.settings.sleep = Sleep::off;
  if (what.knob == Knob::tolerance) {
    scene.settings.tolerance_m = what.value;
  } else {
    scene.settings.substeps = static_cast<int>(what.value);
    if (what.peer == Peer::none && what.iterations > 0) scene.settings.iterations = what.iterations;
  }
  return scene;
}

std::vector<ChartCase> casesOf(ChartScene scene, const std::vector<Method>& methods, const std::vector<Peer>& peers, bool quick) {
  std::vector<ChartCase> cases;
  for (const Sweep& sweep : sweeps()) {
    if (std::find(methods.begin(), methods.end(), sweep.method) == methods.end()) continue;
    for (const double value : quick ? sweep.quick : sweep.values) cases.push_back({scene, sweep.method, sweep.knob, value});
    if (quick || (sweep.method != Method::rigidPgs && sweep.method != Method::xpbd)) continue;
    for (const StepsAndIterations& knobs : kMoreIterations)
      cases.push_back({scene, sweep.method, Knob::substeps, knobs.substeps, Peer::none, knobs.iterations});
  }
  for (const Peer peer : peers) {
    for (const StepsAndIterations& knobs : quick ? kQuickPeerKnobs : kPeerKnobs) {
      cases.push_back({scene, Method::rigidPgs, Knob::substeps, knobs.substeps, peer, knobs.iterations});
    }
  }
  return cases;
}

ChartTimes timesOf(ChartScene scene, const ChartLimits& limits) {
  const double half_s = 0.5 * limits.seconds;
  switch (scene) {
    case ChartScene::uniform:
    case ChartScene::heights:
    case ChartScene::heavyLight:
    case ChartScene::holes:
    case ChartScene::lean:
    case ChartScene::tall:
      return {half_s, half_s, limits.seconds};
    case ChartScene::pull:
      return {0.2 * limits.seconds, 0.2 * limits.seconds, 0.2 * limits.seconds + std::min(kMotion_s, half_s)};
    case ChartScene::drop:
    case ChartScene::slide:
    case ChartScene::heap:
    case ChartScene::thrown:
      return {0.0, half_s, limits.seconds};
    case ChartScene::collapse:
    case ChartScene::spin:
      break;
  }
  return {0.0, 0.0, std::min(kMotion_s, limits.seconds)};
}

int towerRows(ChartScene scene, const ChartLimits& limits) {
  if (scene == ChartScene::tall) return kTallRows;
  return isCharted(scene) && scene != ChartScene::drop && scene != ChartScene::spin ? limits.rows : 0;
}

std::optional<bool> expectedToStand(ChartScene scene) {
  if (!hasRows(scene)) return {};
  return scene != ChartScene::collapse;
}

int pulledBlock(ChartScene scene, const Scene& blocks, int rows) {
  if (scene != ChartScene::pull) return -1;
  const auto found = std::find_if(blocks.blocks.begin(), blocks.blocks.end(),
                                  [&](const BlockSpec& block) { return block.row == rows / 2 && block.position == 2; });
  return static_cast<int>(found - blocks.blocks.begin());
}

void pull(SteadyPull& hand, Simulation& simulation) {
  // Gains per frame, as shares of what would give the block the missing speed within one frame.
  constexpr double kProportional = 0.5;
  constexpr double kIntegral = 0.2;
  const auto block = static_cast<std::size_t>(hand.block);
  const double missing = kChartPullSpeed_m_s - centre(simulation.state.velocity, block).dot(hand.direction);
  const double unit = simulation.model.mass[block] / simulation.scene.settings.frame_s * missing;
  hand.held_n = std::clamp(hand.held_n + kIntegral * unit, 0.0, kStrongestPull_n);
  const double force_n = std::clamp(hand.held_n + kProportional * unit, 0.0, kStrongestPull_n);
  const double now = simulation.time_s;
  simulation.scene.forces = {{hand.block, -1, force_n * hand.direction, now, now + 1.5 * simulation.scene.settings.frame_s}};
}

}  // namespace springtower
