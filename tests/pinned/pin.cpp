#include "tests/pinned/pin.h"

#include "solver/world/poison.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {

int frameOfHash(std::size_t hash, int frames) {
  return std::min(frames, kFramesAPin * (static_cast<int>(hash) + 1));
}

Pin pinOf(const PinnedScene& scene, int threads, bool poisoned) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute([&] {
    Simulation simulation(scene.scene());
    const Leader lead = scene.leader ? scene.leader() : Leader();
    Pin pin;
    for (int frame = 1; frame <= scene.frames; ++frame) {
      if (lead) lead(simulation);
      if (poisoned) poisonScratch(*simulation.engine);
      prepareAndStep(simulation);
      if (frame % kFramesAPin == 0 || frame == scene.frames) pin.hashes.push_back(stateHash(simulation));
    }
    pin.counters = simulation.counters;
    return pin;
  });
}

}  // namespace springtower
