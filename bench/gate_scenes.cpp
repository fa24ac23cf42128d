// Fixed scenes whose instructions are counted by callgrind (bench/callgrind.py): one thread, a few frames each; towers with
// everything awake, and parts of the recorded game as it was played.
//   gate_scenes            lists the scenes
//   gate_scenes SCENE      runs one and prints a JSON object: accuracy and the hash of the state at the end. Only the last frames
//                          are counted; what comes before brings the scene to where it is interesting.
//   gate_scenes SCENE 300  runs a tower for 300 frames instead: what accuracy it settles to

#include "core/error.h"
#include "core/scene/scene.h"
#include "core/version.h"
#include "scenarios/gate.h"
#include "scenarios/recorded/recorded_game.h"
#include "scenarios/towers.h"
#include "solver/frame/inputs.h"
#include "solver/frame/prepare.h"
#include "solver/hand/played_frame.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/world/simulation.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <string>
#include <string_view>
#include <vector>

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else  // without valgrind's header the program still runs, and nothing counts
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_STOP_INSTRUMENTATION
#endif

namespace springtower {
namespace {

// What is run of a tower before, and what of it is counted, frames.
constexpr int kBefore = 20;
constexpr int kCounted = 5;

constexpr std::uint64_t kPullFrom = 12;  // frames; by then the block carries its load
constexpr double kFirstPull_n = 0.8;     // about its friction

// The default method, and the explicit one that others fall back on.
std::vector<Method> methods() {
  const Method usual = Settings{}.method;
  if (usual == Method::semiImplicitEuler) return {usual};
  return {usual, Method::semiImplicitEuler};
}

// Pulls a block along its length: the force that brings it to the speed in one frame, on top of what friction took so far.
void pull(Simulation& simulation, std::size_t block, double speed_m_s, double& friction_n) {
  const Vec3 along = simulation.scene.blocks[block].orientation * Vec3::UnitX();
  const double missing = speed_m_s - centre(simulation.state.velocity, block).dot(along);
  const double unit_n = simulation.model.mass[block] / simulation.scene.settings.frame_s * missing;
  friction_n = std::max(0.0, friction_n + 0.2 * unit_n);
  setOnlyForce(simulation, forceForOneFrame(simulation, block, (friction_n + 0.5 * unit_n) * along));
}

std::string nameOf(const GamePart& part) {
  return fmt::format("{} {}", part.name, nameOf(recordedGame().frames.front().input.tuning.method));
}

// `pulled`: the block of the hand.
void printFigures(const std::string& name, const Simulation& simulation, const ParticleArray& start, std::size_t pulled) {
  PenetrationWorkspace workspace;
  const ParticleArray& position = simulation.state.position;
  std::vector<int> row;
  for (const BlockSpec& block : simulation.scene.blocks) row.push_back(block.row);
  fmt::print(
      "{{\"scene\": \"{}\", \"max_penetration_mm\": {}, \"bottom_row_compression_mm\": {}, \"max_strain\": {}, "
      "\"speed_mm_s\": {}, \"energy_j\": {}, \"pulled_mm\": {}, \"steps\": {}, \"contact_evaluations\": {}, \"state_hash\": "
      "\"{:016x}\", \"compiler\": \"{}\", \"flags\": \"{}\"}}\n",
      name, 1e3 * maxPenetration(position, simulation.scene.floor, workspace).depth,
      1e3 * meanRowCompression(simulation.model, start, position, bottomRow(simulation.model, start, row)),
      maxStrain(simulation.model, position), 1e3 * rootMeanSquareCornerSpeed(simulation.state.velocity),
      energy(simulation).total(), 1e3 * (centre(position, pulled) - centre(start, pulled)).norm(), simulation.counters.steps,
      simulation.counters.contactEvaluations, stateHash(simulation), kCompiler, kCompilerFlags);
}

void runGate(const GateTower& gate, Method method, int frames) {
  Simulation simulation(sceneOf(gate, method));
  prepare(simulation);
  const ParticleArray start = simulation.state.position;
  const std::size_t pulled = middleBlock(simulation.scene);
  double friction_n = kFirstPull_n;
  const auto step = [&] {
    if (gate.pull_m_s > 0.0 && simulation.frame >= kPullFrom) pull(simulation, pulled, gate.pull_m_s, friction_n);
    stepFrame(simulation);
  };
  const int before = std::max(0, frames - kCounted);
  for (int frame = 0; frame < before; ++frame) step();
  CALLGRIND_START_INSTRUMENTATION;
  for (int frame = 0; frame < kCounted; ++frame) step();
  CALLGRIND_STOP_INSTRUMENTATION;
  printFigures(fmt::format("{} {}", gate.name, nameOf(method)), simulation, start, pulled);
}

// With the default method, with which it was played.
void runPart(const GamePart& part) {
  const std::vector<LoggedFrame>& frames = recordedGame().frames;
  Simulation simulation(recordedTower());
  prepare(simulation);
  const ParticleArray start = simulation.state.position;
  Grip grip;
  std::vector<ContactForce> contacts = contactForces(simulation);
  const auto playTo = [&](std::size_t last) {
    while (simulation.frame < last) stepPlayed(frames[simulation.frame].input.hand, grip, contacts, simulation);
  };
  playTo(part.first - 1);
  CALLGRIND_START_INSTRUMENTATION;
  playTo(part.last);
  CALLGRIND_STOP_INSTRUMENTATION;
  printFigures(nameOf(part), simulation, start, index(frames[part.first - 1].input.hand.block));
}

int gate(const std::vector<std::string_view>& arguments) {
  const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
  bool found = arguments.empty();
  for (const Method method : methods()) {
    for (const GateTower& gate : gateTowers()) {
      const std::string name = fmt::format("{} {}", gate.name, nameOf(method));
      if (arguments.empty()) {
        fmt::print("{}\n", name);
      } else if (arguments[0] == name) {
        found = true;
        runGate(gate, method, arguments.size() > 1 ? std::stoi(std::string(arguments[1])) : kBefore + kCounted);
      }
    }
  }
  for (const GamePart& part : gameParts()) {
    if (arguments.empty()) {
      fmt::print("{}\n", nameOf(part));
    } else if (arguments[0] == nameOf(part)) {
      found = true;
      runPart(part);
    }
  }
  if (found) return 0;
  std::fputs(  // which does not throw where standard error is closed
      fmt::format("gate_scenes: expected a scene as the program lists them without arguments, got '{}'\n", arguments[0]).c_str(),
      stderr);
  return 2;
}

}  // namespace
}  // namespace springtower

int main(int argc, char** argv) {
  try {
    return springtower::gate({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "gate_scenes: %s\n", error.what());
    return 3;
  }
}
