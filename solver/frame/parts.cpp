#include "solver/frame/parts.h"

#include "core/tuning.h"
#include "solver/contact/approach.h"
#include "solver/frame/island.h"
#include "solver/frame/over_islands.h"
#include "solver/frame/pairs.h"
#include "solver/reference/report_frame.h"
#include "solver/sleep/rest.h"
#include "solver/world/checkpoint.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

void resetSweepMargins(Simulation& simulation) {
  std::vector<double>& margin_m = simulation.engine->memo.sweepMargin;
  for (std::size_t b = 0; b < margin_m.size(); ++b) {
    const bool inParts = simulation.engine->scratch.inParts[b] != 0;
    margin_m[b] = (inParts ? tuning::kPartSweepMargin : tuning::kSweepMargin) * simulation.lengths.blockHeight_m;
  }
}

// In how many parts islands in rigid steps move through the frame, so that in a part none of their blocks moves much farther than
// its box allows for what contacts add. Marks their blocks.
int chooseParts(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  std::vector<std::uint8_t>& inParts = engine.scratch.inParts;
  std::fill(inParts.begin(), inParts.end(), 0);
  double fastest = 0.0;
  for (std::size_t b = 0; b < inParts.size(); ++b) {
    if (simulation.asleep[b] != 0 || !engine.memo.islandHistory[b].rigid) continue;
    fastest = std::max(fastest, fastestCorner(simulation.state.velocity, b, Vec3::Zero()));
  }
  const double most_m = tuning::kMaxPartDisplacement * simulation.lengths.blockHeight_m;
  const double parts =
      std::clamp(std::ceil(fastest * simulation.scene.settings.frame_s / most_m), 1.0, static_cast<double>(tuning::kMaxParts));
  if (parts == 1.0) return 1;
  for (std::size_t b = 0; b < inParts.size(); ++b)
    inParts[b] = simulation.asleep[b] == 0 && engine.memo.islandHistory[b].rigid ? 1 : 0;
  return static_cast<int>(parts);
}

// Islands that are run now.
enum class Who : std::uint8_t {
  all,
  inParts,
  atFrameStart,  // those that are not in parts
  met            // of these, those with a near block that is in parts
};

// Marks them; returns whether there are any.
bool selectIslands(Simulation& simulation, Who who) {
  Engine& engine = *simulation.engine;
  const Islands& islands = engine.memo.islands;
  const std::vector<std::uint8_t>& inParts = engine.scratch.inParts;
  std::vector<std::uint8_t>& takesPart = engine.scratch.takesPart;
  takesPart.assign(islands.count(), who == Who::all ? 1 : 0);
  if (who == Who::met) {
    for (const BlockPair& pair : engine.memo.sweptPairs) {
      const std::int32_t a = islands.islandOf[static_cast<std::size_t>(pair.a)];
      const std::int32_t b = islands.islandOf[static_cast<std::size_t>(pair.b)];
      const bool first = inParts[static_cast<std::size_t>(pair.a)] != 0;
      if (a >= 0 && b >= 0 && first != (inParts[static_cast<std::size_t>(pair.b)] != 0))
        takesPart[static_cast<std::size_t>(first ? b : a)] = 1;
    }
  } else if (who != Who::all) {
    for (std::size_t i = 0; i < islands.count(); ++i) {
      const bool moves = inParts[static_cast<std::size_t>(islands.island(i).front())] != 0;
      takesPart[i] = moves == (who == Who::inParts) ? 1 : 0;
    }
  }
  return std::find(takesPart.begin(), takesPart.end(), 1) != takesPart.end();
}

void addCounters(Simulation& simulation) {
  int most = 0;
  Engine& engine = *simulation.engine;
  for (std::size_t i = 0; i < engine.memo.islands.count(); ++i) {
    if (engine.scratch.takesPart[i] == 0) continue;
    simulation.counters += engine.scratch.islandCounters[i];
    most = std::max(most, engine.scratch.islandOutcome[i]);
  }
  simulation.substeps += most;
}

// Near pairs of the part. An island that a block in parts comes near to is run up to here, and moves on in parts as well.
void sweepPart(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  findNearPairs(simulation);
  const FramePart part = engine.scratch.part;
  while (selectIslands(simulation, Who::met)) {
    engine.scratch.part = {0.0, part.begin_s};
    if (part.begin_s == 0.0 || overIslands(simulation, advanceIsland)) {
      if (part.begin_s > 0.0) addCounters(simulation);
      for (const std::int32_t block : engine.scratch.awakeBlocks) {
        const auto b = static_cast<std::size_t>(block);
        if (engine.scratch.takesPart[static_cast<std::size_t>(engine.memo.islands.islandOf[b])] != 0)
          engine.scratch.inParts[b] = 1;
      }
    } else {
      ++simulation.counters.replayedFrames;
      growSweepMargins(engine);
      restoreFrame(simulation);
    }
    engine.scratch.part = part;
    findNearPairs(simulation);
  }
}

// Runs these islands through the part: again with larger swept boxes for an island in which a block was hit and left its own, so
// that no contact is missed; and with sleeping blocks awake where their supports failed.
void runPart(Simulation& simulation, Who who) {
  const bool isReport = traitsOf(simulation.scene.settings.method).family == MethodFamily::report;
  const auto sweep = who == Who::inParts ? sweepPart : findNearPairs;
  while (true) {
    if (wakeOnImpact(simulation)) sweep(simulation);
    if (!selectIslands(simulation, who)) {
      wakeFailedSupports(simulation);  // lists anew what wakes after the frame
      return;
    }
    if (isReport) prepareReportFrame(simulation);
    const bool inside = overIslands(simulation, advanceIsland);
    const bool failed = inside && wakeFailedSupports(simulation);
    if (inside && !failed) break;
    ++simulation.counters.replayedFrames;
    if (!inside) growSweepMargins(*simulation.engine);
    restoreFrame(simulation);
    if (isReport) rewindReportFrame(simulation);
    sweep(simulation);
  }
  addCounters(simulation);
}

}  // namespace

void advanceThroughParts(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  const double frame_s = simulation.scene.settings.frame_s;
  const int parts = chooseParts(simulation);
  for (int i = 0; i < parts; ++i) {
    engine.scratch.part = {frame_s * i / parts, i + 1 == parts ? frame_s : frame_s * (i + 1) / parts};
    resetSweepMargins(simulation);
    sweepPart(simulation);
    runPart(simulation, parts > 1 ? Who::inParts : Who::all);
  }
  if (parts == 1) return;
  engine.scratch.part = {0.0, frame_s};
  resetSweepMargins(simulation);
  runPart(simulation, Who::atFrameStart);
}

}  // namespace springtower
