#include "apps/commands/validate/frames.h"
#include "apps/commands/validate/validate.h"
#include "core/error.h"
#include "scenarios/towers.h"
#include "solver/runner/run.h"
#include "solver/runner/trials.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

constexpr double kSameRelative = 0.05;
constexpr double kHeavy = 100.0;
constexpr double kHeavyPenetration_m = 1e-4;

struct Variant {
  std::string name;
  double size;
  double density;
};

// Results of a variant: verdicts of some towers, and by how much the tower yields, over block heights.
struct Outcome {
  std::vector<std::string> verdicts;
  double penetration = 0.0;
  double compression = 0.0;
};

RunResult runOf(const Scene& scene, double seconds) {
  RunOptions options;
  options.seconds = seconds;
  options.stopWhenFallen = true;
  Simulation simulation(scene);
  return runSceneOrEnd(simulation, options);
}

Outcome outcomeOf(const Variant& variant, const std::vector<Scene>& judged) {
  const auto make = [&](const Scene& scene) { return scaled(scene, variant.size, variant.density); };
  const double time = std::sqrt(variant.size);
  Outcome outcome;
  for (const Scene& scene : judged) {
    try {
      outcome.verdicts.emplace_back(runOf(make(scene), 5.0 * time).standing.stands ? "stands" : "falls");
    } catch (const DivergenceError&) {
      outcome.verdicts.emplace_back("diverges");
    }
  }
  Simulation simulation(make(towerScene(9)));
  RunOptions options;
  options.seconds = 5.0 * time;
  options.measureEveryFrame = false;
  const RunResult result = runSceneOrEnd(simulation, options);
  PenetrationWorkspace workspace;
  const double height = simulation.lengths.blockHeight_m;
  outcome.penetration = maxPenetration(simulation.state.position, true, workspace).depth / height;
  outcome.compression = result.bottomRowCompression_m / height;
  return outcome;
}

std::vector<Scene> judgedScenes() {
  TowerOptions held;
  held.offsets.push_back({1, 2, 0.0, 0.0123});
  TowerOptions tipping;
  tipping.offsets.push_back({1, 2, 0.0, 0.0144});
  return {bitCodeScene("(010)-(010)-(011)"), bitCodeScene("(010)-(100)"),       bitCodeScene("(101)-(101)-(010)-(111)"),
          bitCodeScene("(111)-(001)-(111)"), bitCodeScene("(010)-(010)", held), bitCodeScene("(010)-(010)", tipping)};
}

Claim relativeClaim(const std::string& what, double measured, double reference) {
  const double differs = measured / reference - 1.0;
  return {what, "within 5 % of the game's blocks",
          fmt::format("{:+.2f} % ({:.3g} of {:.3g} heights)", 100.0 * differs, measured, reference),
          std::abs(differs) <= kSameRelative};
}

void addHeavy(bool longForm, ValidationSection& section) {
  const Scene scene = withHeavyRows(towerScene(18), kHeavy);
  Claim stands{"18 rows alternating light and 100 times heavier, light at the bottom", "stands", ""};
  try {
    const RunResult result = runOf(scene, longForm ? 20.0 : 6.0);
    stands.measured = result.standing.stands ? "stands" : fmt::format("falls at {:.2f} s", result.fallTime_s.value_or(0.0));
    stands.passed = result.standing.stands;
    section.claims.push_back(stands);
    const double penetration_m = result.maxPenetration_m.value_or(result.deepest.depth);
    section.claims.push_back({"the same: penetration once settled", "0.1 mm", fmt::format("{:.4f} mm", 1e3 * penetration_m),
                              result.standing.stands && penetration_m <= kHeavyPenetration_m});
    section.claims.push_back({"the same: at rest after", "reported",
                              result.restTime_s
                                  ? fmt::format("{:.2f} s, {:.2g} ms a frame", *result.restTime_s, result.frameTimes.cpuMedian)
                                  : "not at rest"});
  } catch (const DivergenceError& error) {
    stands.measured = error.what();
    stands.passed = false;
    section.claims.push_back(stands);
  }
}

}  // namespace

ValidationSection validateScale(const ValidationPlan& plan) {
  ValidationSection section{"Scale",
                            "The same towers at a tenth and at ten times the size, with the frame time scaled by the square "
                            "root, and of blocks ten times "
                            "as dense or as light, with no setting changed: verdicts of six towers, and how far 9 rows give "
                            "way."};
  const std::vector<Variant> variants = {{"the game's size", 1.0, 1.0},
                                         {"1/10 of the size", 0.1, 1.0},
                                         {"10 times the size", 10.0, 1.0},
                                         {"10 times denser", 1.0, 10.0},
                                         {"10 times lighter", 1.0, 0.1}};
  const std::vector<Scene> judged = judgedScenes();
  std::vector<Outcome> outcomes(variants.size());
  tbb::parallel_for(std::size_t{0}, variants.size(),
                    [&](std::size_t i) { tbb::this_task_arena::isolate([&] { outcomes[i] = outcomeOf(variants[i], judged); }); });
  for (std::size_t i = 1; i < variants.size(); ++i) {
    std::size_t same = 0;
    for (std::size_t t = 0; t < judged.size(); ++t) same += outcomes[i].verdicts[t] == outcomes[0].verdicts[t] ? 1 : 0;
    section.claims.push_back(
        {variants[i].name + ": same verdicts", "all", fmt::format("{} of {}", same, judged.size()), same == judged.size()});
    section.claims.push_back(
        relativeClaim(variants[i].name + ": penetration over height", outcomes[i].penetration, outcomes[0].penetration));
    section.claims.push_back(
        relativeClaim(variants[i].name + ": compression over height", outcomes[i].compression, outcomes[0].compression));
  }
  addHeavy(plan.longForm, section);
  return section;
}

}  // namespace springtower
