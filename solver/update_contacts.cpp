#include "core/error.h"
#include "core/lanes.h"
#include "solver/contact_births.h"
#include "solver/frame_start.h"
#include "solver/island_step.h"
#include "solver/stage_clock.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace springtower {

namespace {

// How a block moved in a step.
struct BlockTravel {
  double path;      // m, of its fastest corner
  double deformed;  // m2, squares of the corners' moves against their mean, summed
};

SPRINGTOWER_INLINE BlockTravel blockTravel(const CornerArray& now, const CornerArray& before, std::size_t b) {
  Lanes squared[2] = {};
  Lanes deformed = {};
  for (std::size_t a = 0; a < 3; ++a) {
    Lanes moved[2];
    for (std::size_t half = 0; half < 2; ++half) {
      Lanes from;
      load(now.values(a, b) + 4 * half, moved[half]);
      load(before.values(a, b) + 4 * half, from);
      moved[half] -= from;
      squared[half] += moved[half] * moved[half];
    }
    const double mean = sum(moved[0] + moved[1]) / static_cast<double>(kCorners);
    for (const Lanes& corners : moved) deformed += (corners - mean) * (corners - mean);
  }
  const Lanes most = squared[0] > squared[1] ? squared[0] : squared[1];
  return {std::sqrt(std::max(std::max(most[0], most[1]), std::max(most[2], most[3]))), sum(deformed)};
}

// A path longer than its box reaches need not lead out of it.
bool isInSweptBox(const IslandStep& step, std::size_t block) {
  const SweptBoxes& boxes = step.engine.boxes;
  for (std::size_t a = 0; a < 3; ++a) {
    const double* x = step.simulation.state.position.values(a, block);
    const auto [least, most] = std::minmax_element(x, x + kCorners);
    if (*least < boxes.lower[a][block] || *most > boxes.upper[a][block]) return false;
  }
  return true;
}

// Adds up the path of each block's fastest corner; `inside` tells whether all are in their swept boxes. A block whose corners
// move apart by half its least side in one step has diverged: free flight is as fast as it likes, but nothing sound deforms like
// that. NaN fails every comparison, so what is sound is asked for. Returns the first block that has diverged, or -1.
SPRINGTOWER_KERNEL
std::int32_t addPaths(IslandStep& step, bool& inside) {
  inside = true;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    const auto [path, deformed] = blockTravel(step.simulation.state.position, step.engine.previous, b);
    const double most = kMostTravelPerStep * step.simulation.model.dimensions[b].minCoeff();
    if (!(deformed < static_cast<double>(kCorners) * most * most)) return block;
    BlockClock& clock = step.engine.clock[b];
    clock.travel += path;
    if (clock.travel - step.engine.travelAtSweep[b] > step.engine.reach[b]) inside = inside && isInSweptBox(step, b);
  }
  return -1;
}

}  // namespace

bool addTravel(IslandStep& step) {
  bool inside = true;
  const std::int32_t diverged = addPaths(step, inside);
  if (diverged < 0) return inside;
  const double deformed =
      blockTravel(step.simulation.state.position, step.engine.previous, static_cast<std::size_t>(diverged)).deformed;
  const double time = step.time_s + step.drift_s;
  throw DivergenceError(
      fmt::format("block {} diverged at {:.6f} s: {}", diverged, time,
                  std::isfinite(deformed) ? fmt::format("its corners moved apart by {:.3g} m in one step of {:.3g} s",
                                                        std::sqrt(deformed / static_cast<double>(kCorners)), step.drift_s)
                                          : std::string("its positions are no longer finite")),
      diverged, time);
}

namespace {

bool slides(const Manifold& manifold) {
  return std::any_of(manifold.sliding.begin(), manifold.sliding.begin() + manifold.count,
                     [](double share) { return share != 0.0; });
}

// Whether blocks touch at a corner or along a line only, where one rolls on the other.
bool rolls(const Manifold& manifold) {
  const auto live =
      std::count_if(manifold.live.begin(), manifold.live.begin() + manifold.count, [](double point) { return point != 0.0; });
  return live == 1 || live == 2;
}

// Path after which a pair's manifold is renewed, m.
double renewalTravel(const Manifold& manifold, const RenewalTravel& travel) {
  if (slides(manifold)) return travel.sliding_m;
  return rolls(manifold) ? travel.rolling_m : travel.resting_m;
}

void updatePair(IslandStep& step, std::int32_t at, const RenewalTravel& renewal, Counters& counters, StageTimes& times) {
  NearPair& pair = step.engine.pairs[static_cast<std::size_t>(at)];
  const double travel = travelOf(step.engine, pair);
  const double used = travel - pair.checkedTravel;
  if (pair.manifold.touch == Touch::apart) {
    if (used < pair.margin) return;
    ++counters.marginsSpent;
    keepPair(step.engine, static_cast<std::size_t>(at));
    pair.checkedTravel = travel;
    watchApart(step, pair, counters, times);
  } else if (used > renewalTravel(pair.manifold, renewal)) {
    keepPair(step.engine, static_cast<std::size_t>(at));
    pair.checkedTravel = travel;
    renewManifold(step, pair, counters);
  }
}

}  // namespace

void findTouching(IslandStep& step) {
  for (const std::int32_t at : step.pairs) {
    NearPair& pair = step.engine.pairs[static_cast<std::size_t>(at)];
    keepPair(step.engine, static_cast<std::size_t>(at));
    if (pair.manifold.touch == Touch::apart) watchApart(step, pair, step.counters, step.times);
  }
}

bool updateContacts(IslandStep& step, const RenewalTravel& renewal) {
  StageClock clock(step.times);
  double& candidates_s = step.times.seconds[static_cast<std::size_t>(Stage::candidates)];
  double& cubicTests_s = step.times.seconds[static_cast<std::size_t>(Stage::cubicTests)];
  const double cubicBefore_s = cubicTests_s;
  const bool inside = addTravel(step);
  if (step.blocks.size() < kParallelBlocks) {
    for (const std::int32_t at : step.pairs) updatePair(step, at, renewal, step.counters, step.times);
    clock.lap(Stage::candidates);
    candidates_s -= cubicTests_s - cubicBefore_s;  // they were timed inside
    return inside;
  }

  constexpr std::size_t kChunk = 256;
  const std::size_t chunks = (step.pairs.size() + kChunk - 1) / kChunk;
  std::vector<Counters>& counted = step.engine.chunkCounters;
  std::vector<StageTimes>& timed = step.engine.chunkTimes;
  if (counted.size() < chunks) counted.resize(chunks);
  if (timed.size() < chunks) timed.resize(chunks);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    counted[chunk] = Counters{};
    timed[chunk] = StageTimes{};
    StageClock all(timed[chunk]);
    const std::size_t last = std::min(step.pairs.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < last; ++i) {
      updatePair(step, step.pairs[i], renewal, counted[chunk], timed[chunk]);
    }
    all.lap(Stage::candidates);
  });
  StageTimes sum;
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
    step.counters += counted[chunk];
    sum += timed[chunk];
  }
  // On many threads the cubic tests take their share of the time that passed.
  const double before_s = candidates_s;
  clock.lap(Stage::candidates);
  const double all_s = sum.seconds[static_cast<std::size_t>(Stage::candidates)];
  const double share = all_s > 0.0 ? sum.seconds[static_cast<std::size_t>(Stage::cubicTests)] / all_s : 0.0;
  cubicTests_s += share * (candidates_s - before_s);
  candidates_s -= share * (candidates_s - before_s);
  return inside;
}

}  // namespace springtower
