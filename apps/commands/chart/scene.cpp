#include "apps/commands/chart/scene.h"

#include "scenarios/falling.h"
#include "scenarios/loose.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"
#include "solver/frame/inputs.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace springtower {
namespace {

constexpr double kChartPullSpeed_m_s = 0.04;
constexpr double kStrongestPull_n = 100.0;
constexpr double kDrop_m = 0.02;
constexpr int kDropRows = 3;
constexpr double kHeavyFactor = 10.0;
constexpr int kLeanRows = 9;
constexpr double kLean_deg = 9.0;
constexpr int kTallRows = 36;
constexpr int kFallingBlocks = 200;
constexpr int kPileRows = 3;
constexpr double kMotion_s = 2.0;  // of scenes that do not come to rest
constexpr double kStack_s = 2.0;   // in half of which a wall or pyramid has sunk as deep as an engine lets it

// Blocks that are no tower.
Scene looseBlocks(ChartScene kind) {
  constexpr int kHeap = 8;
  switch (kind) {
    case ChartScene::heap:
      return askewPileScene(kHeap);
    case ChartScene::thrown:
      return thrownPairScene();
    case ChartScene::spin:
      return spinningBlockScene();
    case ChartScene::heap200:
      return heapScene(kFallingBlocks);
    case ChartScene::rain200:
      return rainScene(kFallingBlocks);
    case ChartScene::pile3:
      return pileScene(kPileRows, {.fall_m = kPileFall_m});
    default:
      return slidingBlockScene();
  }
}

bool hasRows(ChartScene scene) {
  return !hasHundreds(scene) && scene != ChartScene::spin && scene != ChartScene::slide && scene != ChartScene::heap &&
         scene != ChartScene::thrown;
}

Scene blocksOf(ChartScene scene, const ChartLimits& limits) {
  int rows = limits.rows;
  if (scene == ChartScene::wall) return wallScene(limits.wallColumns, limits.wallCourses);
  if (scene == ChartScene::pyramid) return cubePyramidScene(limits.pyramidRows);
  if (!hasRows(scene)) {
    Scene loose = looseBlocks(scene);
    loose.name = scene == ChartScene::spin ? "one block" : nameOf(scene);
    return loose;
  }
  if (scene == ChartScene::shot) return shotTowerScene(rows);
  if (scene == ChartScene::holes) return towerWithHolesScene();
  if (scene == ChartScene::lean) rows = kLeanRows;
  if (scene == ChartScene::tall) rows = kTallRows;
  TowerOptions options;
  if (scene == ChartScene::heights) options.heightsSigma_m = kUnevenHeightsSigma_m;
  Scene tower = towerScene(scene == ChartScene::drop ? std::min(rows, kDropRows) : rows, options);
  if (scene == ChartScene::drop) return raised(std::move(tower), kDrop_m);
  if (scene == ChartScene::heavyLight) return withHeavyRows(std::move(tower), kHeavyFactor);
  if (scene == ChartScene::collapse) return leaning(std::move(tower), collapseTilt_deg(rows));
  if (scene == ChartScene::lean) return leaning(std::move(tower), kLean_deg);
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

// Other engines: with their defaults, then their own parameters. Our own iterating methods have the second parameter too.
struct StepsAndIterations {
  double substeps;
  int iterations;
};
const std::vector<StepsAndIterations> kPeerKnobs = {{1, 0}, {1, 200}, {4, 0}, {4, 50}, {8, 0}, {16, 0}, {32, 0}};
const std::vector<StepsAndIterations> kQuickPeerKnobs = {{1, 0}, {16, 0}};
const std::vector<StepsAndIterations> kMoreIterations = {{4, 16}, {8, 16}, {16, 16}};

// Of hundreds of blocks, whose frames take twenty times as long as a tower's: no explicit steps, which take seconds for one, no
// matrices of pivoting or of Eigen's, and of what iterates a few settings. Bullet has all of its own.
const std::vector<Sweep>& sweepsOfHundreds() {
  static const std::vector<Sweep> all = {
      {Method::implicit, Knob::tolerance, {2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 1e-6}, {5e-5, 1e-5}},
      {Method::implicitEuler, Knob::tolerance, {2e-4, 5e-5, 1e-5}, {5e-5}},
      {Method::rigidPgs, Knob::substeps, {8, 16, 32, 64}, {16}},
      {Method::xpbd, Knob::substeps, {12, 25, 50, 100}, {25}},
  };
  return all;
}
const std::vector<StepsAndIterations> kOdeKnobsOfHundreds = {{1, 0}, {4, 0}};

const std::vector<StepsAndIterations>& peerKnobs(ChartScene scene, Peer peer, bool quick) {
  if (quick) return kQuickPeerKnobs;
  return hasHundreds(scene) && peer == Peer::ode ? kOdeKnobsOfHundreds : kPeerKnobs;
}

}  // namespace

std::string nameOf(const ChartCase& what) {
  if (what.knob == Knob::tolerance) return fmt::format("{} {:g} mm", methodOf(what), 1e3 * what.value);
  const std::string steps = fmt::format("{} {:g} step{}", methodOf(what), what.value, what.value == 1.0 ? "" : "s");
  return what.iterations == 0 ? steps : fmt::format("{}, {} iterations", steps, what.iterations);
}

std::string sizeText(ChartScene scene, const ChartLimits& limits) {
  if (scene == ChartScene::wall) return fmt::format("{}x{}", limits.wallColumns, limits.wallCourses);
  if (scene == ChartScene::heap200 || scene == ChartScene::rain200) return fmt::format("{}", kFallingBlocks);
  if (scene == ChartScene::pile3) return fmt::format("{}", kPileRows);
  return fmt::format("{}", scene == ChartScene::pyramid ? limits.pyramidRows : limits.rows);
}

Scene sceneOf(const ChartCase& what, const ChartLimits& limits) {
  Scene scene = blocksOf(what.scene, limits);
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
  for (const Sweep& sweep : hasHundreds(scene) ? sweepsOfHundreds() : sweeps()) {
    if (std::find(methods.begin(), methods.end(), sweep.method) == methods.end()) continue;
    for (const double value : quick ? sweep.quick : sweep.values) cases.push_back({scene, sweep.method, sweep.knob, value});
    if (quick || hasHundreds(scene) || (sweep.method != Method::rigidPgs && sweep.method != Method::xpbd)) continue;
    for (const StepsAndIterations& knobs : kMoreIterations)
      cases.push_back({scene, sweep.method, Knob::substeps, knobs.substeps, Peer::none, knobs.iterations});
  }
  for (const Peer peer : peers) {
    for (const StepsAndIterations& knobs : peerKnobs(scene, peer, quick)) {
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
    case ChartScene::wall:
    case ChartScene::pyramid:
      return {std::min(half_s, 0.5 * kStack_s), std::min(half_s, 0.5 * kStack_s), std::min(limits.seconds, kStack_s)};
    case ChartScene::pull:
      return {0.2 * limits.seconds, 0.2 * limits.seconds, 0.2 * limits.seconds + std::min(kMotion_s, half_s)};
    case ChartScene::drop:
    case ChartScene::slide:
    case ChartScene::heap:
    case ChartScene::thrown:
      return {0.0, half_s, limits.seconds};
    case ChartScene::collapse:
    case ChartScene::spin:
    case ChartScene::shot:
    case ChartScene::heap200:
    case ChartScene::rain200:
    case ChartScene::pile3:
      break;
  }
  return {0.0, 0.0, std::min(kMotion_s, limits.seconds)};
}

int towerRows(ChartScene scene, const ChartLimits& limits) {
  if (scene == ChartScene::tall) return kTallRows;
  return isCharted(scene) && hasRows(scene) && scene != ChartScene::drop ? limits.rows : 0;
}

std::optional<bool> expectedToStand(ChartScene scene) {
  if (isStack(scene)) return true;
  if (!hasRows(scene) || scene == ChartScene::shot) return {};
  return scene != ChartScene::collapse;
}

int pulledBlock(ChartScene scene, const Scene& blocks) {
  return scene == ChartScene::pull ? static_cast<int>(middleBlock(blocks)) : -1;
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
  setOnlyForce(simulation, forceForOneFrame(simulation, block, force_n * hand.direction));
}

}  // namespace springtower
