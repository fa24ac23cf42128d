#include "solver/frame/prepare.h"

#include "core/error.h"
#include "core/parallel.h"
#include "core/processor_time.h"
#include "core/tuning.h"
#include "solver/contact/query.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/contact/update.h"
#include "solver/frame/over_islands.h"
#include "solver/frame/pairs.h"
#include "solver/implicit/equal_islands.h"
#include "solver/implicit/equilibrium.h"
#include "solver/implicit/system.h"
#include "solver/world/checkpoint.h"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <span>
#include <vector>

namespace springtower {

namespace {

// Where no equilibrium is known, overlaps at the start have no force (rest depth): the blocks would be thrown apart otherwise. Of
// pairs for which isWithout(block) holds.
template <class IsWithout>
void unloadOverlaps(IslandStep& step, const IsWithout& isWithout) {
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    if (!step.engine.pairs.touches(at) || !isWithout(static_cast<std::size_t>(step.engine.pairs.key[at].a))) continue;
    const ContactView manifold = contactOf(step.engine, at);
    const PointForces points = forcesNow(step.simulation, manifold);
    const PointRows rows = step.engine.contacts.points(step.engine.pairs.contact[at]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
      if (points.depth[i] <= step.simulation.lengths.contactError_m) continue;
      PointRow& row = *rows[rowOf(i)];
      if (manifold.kind == PointKind::impulse) row.impulse.restDepth[laneOf(i)] = points.depth[i];
      if (manifold.kind != PointKind::penalty) continue;
      row.penalty.restDepth[laneOf(i)] = points.depth[i];
      row.penalty.stiffening[laneOf(i)] = 1.0;
      row.penalty.touching[laneOf(i)] = kTouchingWithoutForce;
    }
  }
}

// Finds an island's contacts and its equilibrium, unless it is equal to one before it; `substeps` of the result is 1 where there
// is an equilibrium, 0 where it starts as placed. `inside` is false where none was found and a block left its swept box.
IslandOutcome prepareIsland(IslandStep& step) {
  const std::int32_t island = step.engine.memo.islands.islandOf[static_cast<std::size_t>(step.blocks.front())];
  if (step.engine.scratch.firstEqualIsland[static_cast<std::size_t>(island)] != island) return {};
  const Settings& settings = step.simulation.scene.settings;
  step.pointKind = pointKindOf(settings.method);
  copyFrameStart(step);
  findTouching(step);
  IslandOutcome outcome;
  if (traitsOf(settings.method).family != MethodFamily::rigid && startInEquilibrium(step)) {
    outcome.substeps = 1;
  } else if (step.leftBox) {
    outcome.inside = false;
    return outcome;
  } else {
    unloadOverlaps(step, [](std::size_t) { return true; });
  }
  step.monitor->islandDone(step.blocks.size());
  return outcome;
}

// Ends the preparation of blocks whose islands left their swept boxes and are not searched again: they start as placed. (With the
// larger boxes they may be in one island with others that have their equilibrium.)
IslandOutcome leaveAsPlaced(IslandStep& step) {
  const std::vector<std::uint8_t>& leftBox = step.engine.scratch.leftBox;
  const auto left = [&](std::size_t b) { return leftBox[b] != 0; };
  unloadOverlaps(step, left);
  step.monitor->islandDone(static_cast<std::size_t>(std::count_if(
      step.blocks.begin(), step.blocks.end(), [&](std::int32_t block) { return left(static_cast<std::size_t>(block)); })));
  return {};
}

// Gives the islands that are equal to one before them what was found for it.
void copyToEqualIslands(Simulation& simulation, SearchMonitor& monitor) {
  Scratch& scratch = simulation.engine->scratch;
  const ContactLaw law = contactLaw(simulation);
  forRanges(scratch.firstEqualIsland.size(), 1, true, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto first = static_cast<std::size_t>(scratch.firstEqualIsland[i]);
      if (first == i || scratch.takesPart[i] == 0) continue;
      IslandStep step = islandStep(simulation, law, i);
      copyEquilibrium(islandStep(simulation, law, first), step);
      scratch.islandOutcome[i] = scratch.islandOutcome[first];
      if (scratch.islandOutcome[i] >= 0) monitor.islandDone(step.blocks.size());
    }
  });
}

// Searches the islands that take part; of equal ones the first. Adds what has come of it to `result`, and marks the blocks of
// those that left their swept boxes: they are then as placed. Returns whether there are none.
bool searchIslands(Simulation& simulation, SearchMonitor& monitor, PrepareResult& result) {
  Engine& engine = *simulation.engine;
  std::vector<std::int32_t>& first = engine.scratch.firstEqualIsland;
  first = firstEqualIslands(simulation);
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (engine.scratch.takesPart[static_cast<std::size_t>(first[i])] == 0) first[i] = static_cast<std::int32_t>(i);
  }
  overIslands(simulation, prepareIsland, &monitor);
  copyToEqualIslands(simulation, monitor);
  first = {};
  bool inside = true;
  for (std::size_t i = 0; i < engine.memo.islands.count(); ++i) {
    if (engine.scratch.takesPart[i] == 0) continue;
    const std::span<const std::int32_t> blocks = engine.memo.islands.island(i);
    const bool left = engine.scratch.islandOutcome[i] < 0;
    inside = inside && !left;
    for (const std::int32_t block : blocks) engine.scratch.leftBox[static_cast<std::size_t>(block)] = left ? 1 : 0;
    if (engine.scratch.islandOutcome[i] > 0) result.blocksInBalance += blocks.size();
    engine.scratch.islandCounters[i].newtonFailures = 0;  // the search has other ways to go on, and takes no explicit steps
    simulation.counters += engine.scratch.islandCounters[i];
  }
  return inside;
}

// The islands of which all blocks left their swept boxes, or any, take part.
void takePartAgain(Engine& engine, bool all) {
  engine.scratch.takesPart.assign(engine.memo.islands.count(), 0);
  for (std::size_t i = 0; i < engine.memo.islands.count(); ++i) {
    const std::span<const std::int32_t> blocks = engine.memo.islands.island(i);
    const auto left = [&](std::int32_t block) { return engine.scratch.leftBox[static_cast<std::size_t>(block)] != 0; };
    const bool takesPart =
        all ? std::all_of(blocks.begin(), blocks.end(), left) : std::any_of(blocks.begin(), blocks.end(), left);
    engine.scratch.takesPart[i] = takesPart ? 1 : 0;
  }
}

// Searches all islands, and those that left their swept boxes once more, with larger ones. Boxes for the whole way of every block
// would find far more pairs than ever meet. An island that is then joined with one that has its equilibrium is left as placed.
void searchAll(Simulation& simulation, SearchMonitor& monitor, PrepareResult& result) {
  Engine& engine = *simulation.engine;
  engine.scratch.leftBox.assign(simulation.model.blockCount(), 0);
  // With the margins of the setup: on its way into equilibrium the top of a tower sinks by the gaps of all rows.
  findNearPairs(simulation);
  engine.scratch.takesPart.assign(engine.memo.islands.count(), 1);
  for (std::size_t i = 0; i < engine.memo.islands.count(); ++i) result.blocks += engine.memo.islands.island(i).size();
  if (searchIslands(simulation, monitor, result)) return;
  if (!monitor.isStopped()) {
    growSweepMargins(engine);
    findNearPairs(simulation);
    takePartAgain(engine, true);
    searchIslands(simulation, monitor, result);
  }
  takePartAgain(engine, false);
  overIslands(simulation, leaveAsPlaced, &monitor);
}

}  // namespace

bool isPrepared(const Simulation& simulation) {
  return simulation.engine->memo.prepared;
}

PrepareResult prepare(Simulation& simulation, const PrepareOptions& options) {
  if (!(options.budget_s >= 0.0))
    throw InputError(fmt::format("prepare: expected a budget of 0 s or more, got {} s", options.budget_s));
  PrepareResult result;
  Engine& engine = *simulation.engine;
  if (engine.memo.prepared) return result;
  if (traitsOf(simulation.scene.settings.method).family == MethodFamily::report) {
    engine.memo.prepared = true;
    return result;
  }
  const StageTimes before = simulation.stageTimes;
  const double processorStart_s = processorTime_s();
  SearchMonitor monitor(engine.sleep.awakeCount, options.budget_s, options.goesOn);
  std::fill(engine.scratch.inParts.begin(), engine.scratch.inParts.end(), 0);
  searchAll(simulation, monitor, result);
  simulation.counters.blockPairs = 0;  // counts the sweeps of frames
  for (NewtonSystem& island : engine.memo.newtonSystems.all()) {
    island.forcesKnown = false;  // they are those of a law without dashpots
    island.changedIterations = 0;
    // The search takes more directions and tangents than the frames to come.
    static_cast<NewtonWork&>(island) = {};
    layOutWork(island);
    // So does the order of elimination that was tried first and given up.
    island.matrix.row.shrink_to_fit();
    island.matrix.target.shrink_to_fit();
  }
  releaseFrameStart(engine);  // the search has changed all pairs
  simulation.substeps = 0;
  simulation.stageTimes = before;  // of frames
  engine.memo.prepared = true;
  if (monitor.isStopped()) result.end = monitor.isOutOfTime() ? PrepareEnd::outOfTime : PrepareEnd::cancelled;
  result.wall_s = monitor.elapsed_s();
  result.processor_s = processorTime_s() - processorStart_s;
  return result;
}

}  // namespace springtower
