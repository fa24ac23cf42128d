#include "tests/pinned/pin.h"

#include "core/byte_stream.h"
#include "solver/world/poison.h"
#include "solver/world/snapshot.h"
#include "tests/support/prepare_and_step.h"

#include <algorithm>
#include <memory>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {

int frameOfHash(std::size_t hash, int frames) {
  return std::min(frames, kFramesAPin * (static_cast<int>(hash) + 1));
}

namespace {

// Another simulation of the scene, at the same point. Settings that a leader has changed are of the scene.
Simulation resumed(const Simulation& simulation, const Scene& scene) {
  ByteWriter writer;
  writeSnapshot(*takeSnapshot(simulation), writer);
  ByteReader reader(writer.bytes(), "bytes");
  const std::shared_ptr<const Snapshot> snapshot = readSnapshot(reader);
  reader.end();
  Simulation other(scene);
  checkFits(*snapshot, other, "bytes");
  restoreSnapshot(other, *snapshot);
  return other;
}

}  // namespace

Pin pinOf(const PinnedScene& scene, int threads, Played how) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute([&] {
    Simulation simulation(scene.scene());
    const Leader lead = scene.leader ? scene.leader() : Leader();
    Pin pin;
    for (int frame = 1; frame <= scene.frames; ++frame) {
      if (lead) lead(simulation);
      if (how == Played::poisoned) poisonScratch(*simulation.engine);
      prepareAndStep(simulation);
      if (frame % kFramesAPin != 0 && frame != scene.frames) continue;
      pin.hashes.push_back(stateHash(simulation));
      if (how == Played::savedAndResumed) simulation = resumed(simulation, scene.scene());
    }
    pin.counters = simulation.counters;
    return pin;
  });
}

}  // namespace springtower
