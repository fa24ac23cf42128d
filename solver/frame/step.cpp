#include "core/error.h"
#include "core/tuning.h"
#include "solver/frame/parts.h"
#include "solver/frame/plane.h"
#include "solver/frame/prepare.h"
#include "solver/sleep/rest.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/poison.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fmt/format.h>
#include <span>
#include <vector>

namespace springtower {

namespace {

// Throws if a block is turned inside out or flattened: the volume of its mean edges against that of its dimensions.
void checkShapes(const Simulation& simulation, std::span<const std::int32_t> blocks) {
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    const ParticleArray& x = simulation.state.position;
    const double volume =
        meanEdge(x, b, 0).cross(meanEdge(x, b, 1)).dot(meanEdge(x, b, 2)) / simulation.model.dimensions[b].prod();
    if (volume > tuning::kMinVolumeRatio) continue;
    throw DivergenceError(fmt::format("block {} diverged at {:.6f} s: it was turned inside out (volume {:.3g} of its own)", block,
                                      simulation.time_s, volume),
                          block, simulation.time_s);
  }
}

}  // namespace

void stepFrame(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  if (!isPrepared(simulation)) throw InputError("stepFrame: expected a simulation after prepare, got one that is not prepared");
#ifndef NDEBUG
  poisonScratch(engine);
#endif
  wakeForInputs(simulation);
  engine.scratch.lostNeighbours.clear();
  simulation.substeps = 0;
  const double end_s = simulation.time_s + simulation.scene.settings.frame_s;
  if (engine.sleep.awakeCount > 0 || anyDriveActs(simulation, simulation.time_s, end_s)) {
    advanceThroughParts(simulation);
    simulation.counters.steps += static_cast<std::uint64_t>(simulation.substeps);
  }
  engine.memo.forcesBefore = simulation.scene.forces;
  ++simulation.frame;
  ++simulation.counters.frames;
  simulation.time_s = static_cast<double>(simulation.frame) * simulation.scene.settings.frame_s;
  finishDriven(simulation);
  if (engine.sleep.awakeCount > 0) {
    checkShapes(simulation, engine.scratch.awakeBlocks);
    if (simulation.scene.plane) keepInPlane(simulation);
    const StageTimer timer(simulation.stageTimes, Stage::islandsAndSleep);
    updateRest(simulation);
  }
}

}  // namespace springtower
