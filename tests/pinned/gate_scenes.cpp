#include "scenarios/gate.h"
#include "solver/frame/inputs.h"
#include "tests/pinned/pinned_scene.h"

#include <algorithm>
#include <cctype>
#include <cstdint>

namespace springtower {
namespace {

// Played as bench/gate_scenes.cpp does. A test compares their last hashes with bench/baseline.json.
constexpr int kGateFrames = 25;
constexpr std::uint64_t kGatePullFrom = 12;  // frames; by then the block carries its load
constexpr double kGateFirstPull_n = 0.8;     // about its friction

// Pulls the middle block of the middle row along its length: the force that brings it to the speed in one frame, on top of what
// friction took so far.
Leader gatePull(double speed_m_s) {
  return [speed_m_s, friction_n = kGateFirstPull_n](Simulation& simulation) mutable {
    if (simulation.frame < kGatePullFrom) return;
    const std::size_t block = middleBlock(simulation.scene);
    const Vec3 along = simulation.scene.blocks[block].orientation * Vec3::UnitX();
    const double missing = speed_m_s - centre(simulation.state.velocity, block).dot(along);
    const double unit_n = simulation.model.mass[block] / simulation.scene.settings.frame_s * missing;
    friction_n = std::max(0.0, friction_n + 0.2 * unit_n);
    setOnlyForce(simulation, forceForOneFrame(simulation, block, (friction_n + 0.5 * unit_n) * along));
  };
}

// "rest" as "GateRest".
std::string pinNameOf(const GateTower& gate) {
  std::string name(gate.name);
  name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return "Gate" + name;
}

}  // namespace

std::vector<PinnedScene> pinnedGates() {
  std::vector<PinnedScene> scenes;
  for (const Method method : {Method::implicit, Method::semiImplicitEuler}) {
    const std::string end = method == Method::implicit ? "Implicit" : "Explicit";
    for (const GateTower& gate : gateTowers()) {
      scenes.push_back({pinNameOf(gate) + end, kGateFrames, [&gate, method] { return sceneOf(gate, method); }});
      if (gate.pull_m_s > 0.0) scenes.back().leader = [&gate] { return gatePull(gate.pull_m_s); };
    }
  }
  return scenes;
}

}  // namespace springtower
