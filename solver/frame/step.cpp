#include "core/error.h"
#include "core/tuning.h"
#include "solver/contact/query.h"
#include "solver/frame/island.h"
#include "solver/frame/over_islands.h"
#include "solver/frame/pairs.h"
#include "solver/frame/plane.h"
#include "solver/frame/prepare.h"
#include "solver/reference/report_frame.h"
#include "solver/sleep/rest.h"
#include "solver/world/checkpoint.h"
#include "solver/world/island_step.h"
#include "solver/world/poison.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <mutex>
#include <optional>
#include <utility>

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
  if (!isPrepared(simulation))
    throw InputError("stepFrame: found a simulation that is not prepared, allowed is one after prepare");
  const bool isReport = traitsOf(simulation.scene.settings.method).family == MethodFamily::report;
#ifndef NDEBUG
  poisonScratch(engine);
#endif
  wakeForInputs(simulation);
  engine.scratch.lostNeighbours.clear();
  if (engine.sleep.awakeCount > 0) {
    double margin = tuning::kSweepMargin * simulation.lengths.blockHeight_m;
    findNearPairs(simulation, margin);
    while (true) {
      // The frame is run again with a larger swept box where a block was hit and left its own, so that no contact is missed; and
      // with sleeping blocks awake where their supports failed.
      if (wakeOnImpact(simulation)) findNearPairs(simulation, margin);
      if (isReport) prepareReportFrame(simulation);
      const bool inside = overIslands(simulation, advanceIsland);
      const bool failed = inside && wakeFailedSupports(simulation);
      if (inside && !failed) break;
      ++simulation.counters.replayedFrames;
      if (!inside) margin *= tuning::kReplayMarginGrowth;
      restoreFrame(simulation);
      if (isReport) rewindReportFrame(simulation);
      findNearPairs(simulation, margin);
    }
    for (const Counters& island : engine.scratch.islandCounters) simulation.counters += island;
    simulation.counters.steps += static_cast<std::uint64_t>(simulation.substeps);
  } else {
    simulation.substeps = 0;
  }
  ++simulation.frame;
  ++simulation.counters.frames;
  simulation.time_s = static_cast<double>(simulation.frame) * simulation.scene.settings.frame_s;
  if (engine.sleep.awakeCount > 0) {
    checkShapes(simulation, engine.scratch.awakeBlocks);
    if (simulation.scene.plane) keepInPlane(simulation);
    const StageTimer timer(simulation.stageTimes, Stage::islandsAndSleep);
    updateRest(simulation);
  }
}

}  // namespace springtower
