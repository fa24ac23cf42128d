#include "core/error.h"
#include "core/tuning.h"
#include "solver/contact/query.h"
#include "solver/frame/island.h"
#include "solver/frame/pairs.h"
#include "solver/frame/plane.h"
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
#include <oneapi/tbb/parallel_for.h>
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

// Runs an island through the frame.
void runIsland(Simulation& simulation, const ContactLaw& law, std::size_t i) {
  Engine& engine = *simulation.engine;
  const auto first = static_cast<std::size_t>(engine.memo.pairStart[i]);
  IslandStep step{simulation,
                  engine,
                  engine.memo.islands.island(i),
                  std::span<const std::int32_t>(engine.memo.islandPairs)
                      .subspan(first, static_cast<std::size_t>(engine.memo.pairStart[i + 1]) - first),
                  engine.scratch.islandCounters[i],
                  engine.scratch.islandTimes[i],
                  law};
  saveFrameStart(step);
  const IslandOutcome outcome = advanceIsland(step);
  engine.scratch.islandOutcome[i] = outcome.inside ? outcome.substeps : -1;
}

// Of the islands that diverge in a frame the first in their order, whichever thread comes first: the message is the same on any
// number of threads. All of them are run, so that the state is as well.
class FirstDivergence {
 public:
  void keep(std::size_t island, std::exception_ptr error) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (error_ != nullptr && island_ < island) return;
    island_ = island;
    error_ = std::move(error);
  }
  void throwIfAny() const {
    if (error_ != nullptr) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::size_t island_ = 0;
  std::exception_ptr error_;
};

// Runs all islands through the frame; false when one has left its swept boxes.
bool runIslands(Simulation& simulation) {
  const bool isReport = traitsOf(simulation.scene.settings.method).family == MethodFamily::report;
  Engine& engine = *simulation.engine;
  const std::size_t islands = engine.memo.islands.count();
  engine.scratch.islandCounters.assign(islands, Counters{});
  engine.scratch.islandTimes.assign(islands, StageTimes{});
  engine.scratch.islandOutcome.assign(islands, 0);
  const ContactLaw law = contactLaw(simulation);
  prepareFrameStart(simulation);
  if (isReport) prepareReportFrame(simulation);
  bool wide = false;
  for (std::size_t i = 0; i < islands; ++i) wide = wide || engine.memo.islands.island(i).size() >= tuning::kParallelBlocks;
  engine.contacts.reserve(engine.pairs.size(), wide);
  if (engine.memo.topologyChanged) {
    for (const std::int32_t contact : engine.pairs.contact) {
      if (contact >= 0) engine.contacts.pose(contact) = RelativePose{};
    }
  }
  FirstDivergence divergence;
  tbb::parallel_for(std::size_t{0}, islands, [&](std::size_t i) {
    try {
      runIsland(simulation, law, i);
    } catch (const DivergenceError&) {
      divergence.keep(i, std::current_exception());
    }
  });
  divergence.throwIfAny();
  bool inside = true;
  simulation.substeps = 0;
  for (std::size_t i = 0; i < islands; ++i) {
    inside = inside && engine.scratch.islandOutcome[i] >= 0;
    simulation.substeps = std::max(simulation.substeps, engine.scratch.islandOutcome[i]);
  }
  for (std::size_t i = 0; i < islands; ++i) simulation.stageTimes += engine.scratch.islandTimes[i];
  return inside;
}

}  // namespace

void stepFrame(Simulation& simulation) {
  Engine& engine = *simulation.engine;
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
      const bool inside = runIslands(simulation);
      const bool failed = inside && wakeFailedSupports(simulation);
      if (inside && !failed) break;
      ++simulation.counters.replayedFrames;
      if (!inside) margin *= tuning::kReplayMarginGrowth;
      restoreFrame(simulation);
      if (traitsOf(simulation.scene.settings.method).family == MethodFamily::report) rewindReportFrame(simulation);
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
