#pragma once

#include "core/scene/scene.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace springtower {

/// Towers of 18 rows on a square grid, 0.3 m apart, that never sleep, stepped by a method.
inline Scene towersScene(int towers, Method method) {
  constexpr double kSpacing_m = 0.3;
  Scene scene = towerScene(18);
  const std::vector<BlockSpec> tower = scene.blocks;
  scene.blocks.clear();
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(towers))));
  for (int i = 0; i < towers; ++i) {
    const int line = i / side;
    for (BlockSpec block : tower) {
      block.centre += kSpacing_m * Vec3(i - line * side, line, 0.0);
      scene.blocks.push_back(block);
    }
  }
  scene.settings.method = method;
  scene.settings.sleep = Sleep::off;
  return scene;
}

/// A scene `frames` frames after its start. Google Benchmark calls a benchmark several times: a name is prepared once.
inline Simulation startedScene(const std::string& name, const Scene& scene, int frames) {
  static std::map<std::string, std::shared_ptr<const Snapshot>> kept;
  Simulation simulation(scene);
  std::shared_ptr<const Snapshot>& snapshot = kept[name];
  if (snapshot) {
    restoreSnapshot(simulation, *snapshot);
  } else {
    for (int frame = 0; frame < frames; ++frame) stepFrame(simulation);
    snapshot = takeSnapshot(simulation);
  }
  return simulation;
}

/// Towers under way, stepped by the explicit method, whose kernels are timed one by one.
inline Simulation startedTowers(int towers, int frames) {
  return startedScene(std::to_string(towers) + " towers after " + std::to_string(frames) + " frames",
                      towersScene(towers, Method::semiImplicitEuler), frames);
}

/// The numbers of all blocks.
inline std::vector<std::int32_t> allBlocks(std::size_t blocks) {
  std::vector<std::int32_t> all(blocks);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace springtower
