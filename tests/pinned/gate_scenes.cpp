#include "tests/pinned/pinned_scene.h"

#include <algorithm>
#include <cstdint>

namespace springtower {
namespace {

// Tests do not know bench/, so its scenes are written here once more. A test compares their last hashes with bench/baseline.json.
constexpr int kGateFrames = 25;
constexpr double kGatePull_m_s = 0.04;
constexpr std::uint64_t kGatePullFrom = 12;  // frames; by then the block carries its load
constexpr double kGateFirstPull_n = 0.8;     // about its friction

Scene gateTower(int rows, double heightsSigma_m, double tilt_deg, Method method) {
  TowerOptions options;
  options.heightsSigma_m = heightsSigma_m;
  Scene scene = towerScene(rows, options);
  scene.gravity.tilt_deg = tilt_deg;
  scene.settings.method = method;
  return awake(scene);
}

// Pulls the middle block of the middle row along its length: the force that brings it to the speed in one frame, on top of what
// friction took so far.
Leader gatePull() {
  return [friction_n = kGateFirstPull_n](Simulation& simulation) mutable {
    if (simulation.frame < kGatePullFrom) return;
    const std::vector<BlockSpec>& blocks = simulation.scene.blocks;
    const int middle = (blocks.back().row + 1) / 2;
    const auto found =
        std::find_if(blocks.begin(), blocks.end(), [&](const BlockSpec& b) { return b.row == middle && b.position == 2; });
    const auto block = static_cast<std::size_t>(found - blocks.begin());
    const Vec3 along = found->orientation * Vec3::UnitX();
    const double missing = kGatePull_m_s - centre(simulation.state.velocity, block).dot(along);
    const double unit_n = simulation.model.mass[block] / simulation.scene.settings.frame_s * missing;
    friction_n = std::max(0.0, friction_n + 0.2 * unit_n);
    const double end_s = simulation.time_s + 1.5 * simulation.scene.settings.frame_s;
    simulation.scene.forces = {{static_cast<int>(block), -1, (friction_n + 0.5 * unit_n) * along, simulation.time_s, end_s}};
  };
}

}  // namespace

std::vector<PinnedScene> pinnedGates() {
  std::vector<PinnedScene> scenes;
  for (const Method method : {Method::implicit, Method::semiImplicitEuler}) {
    const std::string end = method == Method::implicit ? "Implicit" : "Explicit";
    const auto add = [&](const char* name, int rows, double heightsSigma_m, double tilt_deg) {
      const auto make = [=] { return gateTower(rows, heightsSigma_m, tilt_deg, method); };
      scenes.push_back({name + end, kGateFrames, make});
    };
    add("GateRest", 18, 0.0, 0.0);
    add("GateUneven", 6, 0.0002, 0.0);
    add("GatePull", 18, 0.0, 0.0);
    scenes.back().leader = gatePull;
    add("GateCollapse", 18, 0.0, 14.5);
  }
  return scenes;
}

}  // namespace springtower
