#include "solver/frame/over_islands.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/contact/query.h"
#include "solver/world/checkpoint.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/stage_clock.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <utility>

namespace springtower {

namespace {

void runIsland(Simulation& simulation, const ContactLaw& law, std::size_t i, IslandOutcome (*advance)(IslandStep&),
               SearchMonitor* monitor) {
  IslandStep step = islandStep(simulation, law, i);
  step.monitor = monitor;
  saveFrameStart(step);
  // The search for the equilibrium, which has a monitor, is for what stands still.
  const double begin_s = simulation.time_s + step.part.begin_s;
  if (monitor == nullptr) placeDriven(step, begin_s, begin_s);
  const IslandOutcome outcome = advance(step);
  step.engine.scratch.islandOutcome[i] = outcome.inside ? outcome.substeps : -1;
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

}  // namespace

IslandStep islandStep(Simulation& simulation, const ContactLaw& law, std::size_t island) {
  Engine& engine = *simulation.engine;
  const auto first = static_cast<std::size_t>(engine.memo.pairStart[island]);
  const auto count = static_cast<std::size_t>(engine.memo.pairStart[island + 1]) - first;
  IslandStep step{simulation,
                  engine,
                  engine.memo.islands.island(island),
                  std::span<const std::int32_t>(engine.memo.islandPairs).subspan(first, count),
                  engine.scratch.islandCounters[island],
                  engine.scratch.islandTimes[island],
                  law,
                  engine.scratch.part};
  const std::vector<BlockPair>& driven = engine.scratch.drivenOfIslands;
  if (driven.empty()) return step;
  const auto number = static_cast<std::int32_t>(island);
  const auto begin = std::lower_bound(driven.begin(), driven.end(), BlockPair{number, -1});
  step.driven = {begin, std::lower_bound(begin, driven.end(), BlockPair{number + 1, -1})};
  return step;
}

bool overIslands(Simulation& simulation, IslandOutcome (*advance)(IslandStep&), SearchMonitor* monitor) {
  Engine& engine = *simulation.engine;
  const std::size_t islands = engine.memo.islands.count();
  engine.scratch.islandCounters.assign(islands, Counters{});
  engine.scratch.islandTimes.assign(islands, StageTimes{});
  engine.scratch.islandOutcome.assign(islands, 0);
  const ContactLaw law = contactLaw(simulation);
  prepareFrameStart(simulation);
  bool wide = false;
  for (std::size_t i = 0; i < islands; ++i) wide = wide || engine.memo.islands.island(i).size() >= tuning::kParallelBlocks;
  engine.contacts.reserve(engine.pairs.size(), wide);
  if (engine.memo.topologyChanged) {
    for (const std::int32_t contact : engine.pairs.contact) {
      if (contact >= 0) engine.contacts.setPose(contact, RelativePose{});
    }
  }
  FirstDivergence divergence;
  forEach(islands, [&](std::size_t i) {
    if (engine.scratch.takesPart[i] == 0) return;
    try {
      runIsland(simulation, law, i, advance, monitor);
    } catch (const DivergenceError&) {
      divergence.keep(i, std::current_exception());
    }
  });
  divergence.throwIfAny();
  bool inside = true;
  for (std::size_t i = 0; i < islands; ++i) inside = inside && engine.scratch.islandOutcome[i] >= 0;
  for (std::size_t i = 0; i < islands; ++i) simulation.stageTimes += engine.scratch.islandTimes[i];
  return inside;
}

}  // namespace springtower
