#include "apps/commands/validate/frames.h"
#include "apps/commands/validate/validate.h"
#include "solver/metrics/penetration.h"
#include "solver/runner/trials.h"
#include "solver/statics/statics.h"
#include "solver/world/simulation.h"

#include <algorithm>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

constexpr double kLongestLooseSettling_s = 20.0;
constexpr double kGapInPenetrations = 3.0;
constexpr double kJudgedLoad = 0.2;  // in weights of the block
constexpr double kNoLoad = 1e-6;     // the same
constexpr double kHeightsSigma_m = 0.0002;

// One block of an uneven tower: what rigid statics says, and what the simulation puts on it from above.
struct Carried {
  double gap_m = 0.0;
  bool loose = false;
  double least = 0.0;  // in its weights, as the next
  double greatest = 0.0;
  double simulated = 0.0;
};

struct UnevenTower {
  std::uint64_t seed = 1;
  double tolerance_m = kBlockTolerance_m;
  bool rested = false;
  double penetration_m = 0.0;
  std::vector<Carried> blocks = {};
};

void solve(int rows, UnevenTower& tower) {
  TowerOptions options;
  options.heightsSigma_m = kHeightsSigma_m;
  options.seed = tower.seed;
  Scene scene = towerScene(rows, options);
  scene.settings.tolerance_m = tower.tolerance_m;
  const StaticScene statics = staticScene(scene);
  const std::vector<BlockLoad> loads =
      statics.rest == Rest::falls ? std::vector<BlockLoad>{} : blockLoads(statics, contactLoads(statics));
  Simulation simulation(scene);
  while (!atRest(simulation) && simulation.time_s < kLongestLooseSettling_s) stepFrameOrEnd(simulation);
  tower.rested = atRest(simulation);
  PenetrationWorkspace workspace;
  tower.penetration_m = maxPenetration(simulation.state.position, true, workspace).depth;
  const std::vector<ContactForce> forces = contactForces(simulation);
  for (std::size_t b = 0; b < loads.size(); ++b) {
    if (!loads[b].covered) continue;
    const double weight = loads[b].weight_n;
    tower.blocks.push_back({loads[b].gap_m, loads[b].loose, loads[b].leastAbove_n / weight,
                            loads[b].greatestAbove_n.value_or(1e9) / weight, normalForceOn(forces, blockId(b), true) / weight});
  }
}

// How many blocks of a tower are judged, and how many of these are right.
struct LooseCounts {
  std::size_t loose = 0;
  std::size_t looseRight = 0;
  std::size_t loaded = 0;
  std::size_t loadedRight = 0;
  std::size_t rest = 0;
  std::size_t restLoose = 0;  // loose in the simulation
};

LooseCounts countLoose(const std::vector<UnevenTower>& towers, std::vector<std::string>& notes) {
  LooseCounts counts;
  for (const UnevenTower& tower : towers) {
    for (const Carried& block : tower.blocks) {
      if (block.loose && block.gap_m > kGapInPenetrations * tower.penetration_m) {
        ++counts.loose;
        counts.looseRight += block.simulated <= kNoLoad ? 1 : 0;
        if (block.simulated > kNoLoad) {
          notes.push_back(
              fmt::format("seed {}: a block under a rigid gap of {:.4f} mm carries {:.3g} weights (penetration {:.4f} mm)",
                          tower.seed, 1e3 * block.gap_m, block.simulated, 1e3 * tower.penetration_m));
        }
      } else if (block.least > kJudgedLoad) {
        ++counts.loaded;
        counts.loadedRight += block.simulated > kNoLoad ? 1 : 0;
        if (block.simulated <= kNoLoad) {
          notes.push_back(fmt::format("seed {}: a block with a load of at least {:.3g} weights in statics has none", tower.seed,
                                      block.least));
        }
      } else {
        ++counts.rest;
        counts.restLoose += block.simulated <= kNoLoad ? 1 : 0;
      }
    }
  }
  return counts;
}

// Largest gap of a rigid block that is loaded all the same: what the tolerance does not resolve.
double largestClosedGap_m(const std::vector<UnevenTower>& towers) {
  double gap = 0.0;
  for (const UnevenTower& tower : towers) {
    for (const Carried& block : tower.blocks) {
      if (block.loose && block.simulated > kNoLoad) gap = std::max(gap, block.gap_m);
    }
  }
  return gap;
}

}  // namespace

ValidationSection validateLoose(const ValidationPlan& plan) {
  const int rows = plan.longForm ? 18 : 9;
  ValidationSection section{
      "Loose and tight blocks",
      fmt::format(
          "Towers of {} rows whose heights vary by 0.2 mm. A block is judged loose where the rigid gap over it is above three "
          "times the largest penetration, and loaded where every distribution of rigid forces puts more than 0.2 of its "
          "weight on it.",
          rows)};
  std::vector<std::vector<UnevenTower>> series(2);
  const std::uint64_t seeds = plan.longForm ? 10 : 3;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    series[0].push_back({seed, 5e-5});
    series[1].push_back({seed, 1e-5});
  }
  tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(2 * seeds),
                    [&](std::size_t i) { tbb::this_task_arena::isolate([&] { solve(rows, series[i / seeds][i % seeds]); }); });
  PlotLine points{"tolerance 0.05 mm", {}};
  PlotLine fine{"tolerance 0.01 mm", {}};
  for (std::size_t s = 0; s < series.size(); ++s) {
    const std::vector<UnevenTower>& towers = series[s];
    const std::string name = fmt::format("tolerance {:g} mm: ", 1e3 * towers.front().tolerance_m);
    const LooseCounts counts = countLoose(towers, section.notes);
    const auto rested = std::count_if(towers.begin(), towers.end(), [](const UnevenTower& tower) { return tower.rested; });
    section.claims.push_back({name + "towers at rest within 20 s", fmt::format("all {}", towers.size()),
                              fmt::format("{}", rested), rested == std::ssize(towers)});
    section.claims.push_back({name + "blocks under a clear gap have no load", "all",
                              fmt::format("{} of {}", counts.looseRight, counts.loose), counts.looseRight == counts.loose});
    section.claims.push_back({name + "blocks that must have a load do", "all",
                              fmt::format("{} of {}", counts.loadedRight, counts.loaded), counts.loadedRight == counts.loaded});
    section.claims.push_back({name + "the rest, not judged", "reported",
                              fmt::format("{} blocks, {} of them without load", counts.rest, counts.restLoose)});
    section.claims.push_back(
        {name + "largest rigid gap that closes", "reported", fmt::format("{:.4f} mm", 1e3 * largestClosedGap_m(towers))});
    for (const UnevenTower& tower : towers) {
      for (const Carried& block : tower.blocks) {
        if (block.loose) (s == 0 ? points : fine).points.push_back({1e3 * block.gap_m, block.simulated});
      }
    }
  }
  section.claims.push_back(
      {"a smaller tolerance resolves more", "largest gap that closes is smaller",
       fmt::format("{:.4f} mm, {:.4f} mm", 1e3 * largestClosedGap_m(series[0]), 1e3 * largestClosedGap_m(series[1])),
       largestClosedGap_m(series[1]) < largestClosedGap_m(series[0])});
  Plot plot;
  plot.title = "Load of blocks that are loose in rigid statics";
  plot.subtitle = fmt::format("{} rows, heights varying by 0.2 mm, {} seeds", rows, seeds);
  plot.x.title = "rigid gap over the block, mm";
  plot.y.title = "simulated load from above, weights of the block";
  points.joined = fine.joined = false;
  plot.lines = {points, fine};
  section.figures.push_back({"loose", plot});
  return section;
}

}  // namespace springtower
