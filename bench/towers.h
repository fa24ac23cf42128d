#pragma once

#include "core/scene/scene.h"
#include "scenarios/towers.h"
#include "solver/frame/prepare.h"
#include "solver/world/engine.h"
#include "solver/world/simulation.h"

#include <cstdint>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

namespace springtower {

/// Towers of 18 rows on a square (squareOf) that never sleep, stepped by a method.
inline Scene towersScene(int towers, Method method) {
  Scene scene = awake(squareOf(towerScene(18), towers));
  scene.settings.method = method;
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
    prepare(simulation);
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
