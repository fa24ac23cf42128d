#include "scenarios/gate.h"

#include "scenarios/towers.h"

namespace springtower {
namespace {

constexpr GateTower kGates[] = {{"rest", 18, 0.0, 0.0, 0.0},
                                {"uneven", 6, kUnevenHeightsSigma_m, 0.0, 0.0},
                                {"pull", 18, 0.0, 0.0, 0.04},
                                {"collapse", 18, 0.0, kTopplingTilt_deg, 0.0}};

}  // namespace

std::span<const GateTower> gateTowers() {
  return kGates;
}

Scene sceneOf(const GateTower& gate, Method method) {
  TowerOptions options;
  options.heightsSigma_m = gate.heightsSigma_m;
  Scene scene = leaning(towerScene(gate.rows, options), gate.tilt_deg);
  scene.settings.method = method;
  return awake(scene);
}

}  // namespace springtower
