// Whole frames, processor time on one thread. Before each sample the state is restored and one frame is left out; then ten frames
// are timed. Items are blocks times frames; bytes are the state, springs and contacts that each step goes through once.

#include "bench/towers.h"
#include "core/processor_time.h"
#include "solver/world/memory_use.h"
#include "solver/world/simulation.h"

#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>
#include <string>

namespace springtower {
namespace {

constexpr int kTimedFrames = 10;

struct FrameScene {
  int towers = 1;
  int before = 0;  // frames until the state that is restored
  double tilt_deg = 0.0;
  Sleep sleep = Sleep::off;
};

void wholeFrames(benchmark::State& run, const std::string& name, const FrameScene& what, Method method) {
  const tbb::global_control oneThread(tbb::global_control::max_allowed_parallelism, 1);
  Scene scene = towersScene(what.towers, method);
  scene.gravity.tilt_deg = what.tilt_deg;
  scene.settings.sleep = what.sleep;
  Simulation simulation = startedScene(name, scene, what.before);
  const auto snapshot = takeSnapshot(simulation);
  double steps = 0.0;
  double bytes = 0.0;
  for (auto iteration : run) {
    restoreSnapshot(simulation, *snapshot);
    stepFrame(simulation);
    const std::uint64_t stepsBefore = simulation.counters.steps;
    const double start_s = processorTime_s();
    for (int frame = 0; frame < kTimedFrames; ++frame) stepFrame(simulation);
    run.SetIterationTime(processorTime_s() - start_s);
    const MemoryUse use = memoryUse(simulation);
    const auto taken = static_cast<double>(simulation.counters.steps - stepsBefore);
    steps += taken;
    bytes += taken * static_cast<double>(use.state + use.model + use.contacts);
  }
  const std::int64_t frames = run.iterations() * kTimedFrames;
  run.SetItemsProcessed(frames * static_cast<std::int64_t>(scene.blocks.size()));
  run.SetBytesProcessed(static_cast<std::int64_t>(bytes));
  run.counters["frames"] = benchmark::Counter(static_cast<double>(frames), benchmark::Counter::kIsRate);
  run.counters["steps"] = steps / static_cast<double>(frames);
}

// One line for each scene and method, by name.
void add(const std::string& name, const FrameScene& what, Method method) {
  const std::string full = "wholeFrames/" + name + "/" + std::string(nameOf(method));
  benchmark::RegisterBenchmark(full.c_str(), wholeFrames, full, what, method)->UseManualTime()->Unit(benchmark::kMillisecond);
}

bool registered() {
  const Method usual = Settings{}.method;
  for (const Method method : {usual, Method::semiImplicitEuler}) {
    add("rest", {.before = 120}, method);
    add("collapse", {.before = 60, .tilt_deg = 14.5}, method);
    add("asleep", {.before = 600, .sleep = Sleep::on}, method);
    add("64_towers", {.towers = 64, .before = 3}, method);
    if (usual == Method::semiImplicitEuler) break;
  }
  return true;
}

const bool kRegistered = registered();

}  // namespace
}  // namespace springtower
