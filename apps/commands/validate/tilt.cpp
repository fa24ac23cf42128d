#include "apps/commands/validate/validate.h"
#include "apps/commands/verdict/verdict.h"
#include "apps/common/interruption.h"
#include "core/error.h"
#include "solver/runner/trials.h"
#include "solver/statics/statics.h"

#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

constexpr double kMaxMargin_deg = 20.0;
constexpr double kMinMargin_deg = 1.0;
constexpr int kMaxTiltedRows = 8;
constexpr double kTolerance_deg = 0.3;
constexpr double kEarlier_deg = 0.5;    // where friction is active
constexpr double kAhead_deg = 1.2;      // where the ramp begins
constexpr double kSoftAhead_deg = 2.5;  // with the default tolerance
constexpr double kFineTolerance_m = 1e-5;
constexpr double kBeyondMargin_deg = 1.5;  // where it ends
constexpr double kManyFriction = 10.0;     // no tower of the sets slides with it
constexpr double kSameMargin_deg = 0.02;

struct Tilted {
  std::string id;
  Scene scene;
  double margin_deg;
  double direction_deg;
  bool frictionActive;       // with much friction the margin would be larger
  TiltTrial trial = {};      // with kFineTolerance_m
  TiltTrial softTrial = {};  // with the default tolerance
};

Tilted tiltedScene(const std::string& id, Scene scene) {
  const std::optional<StabilityMargin> margin = tiltMargin(staticScene(scene));
  Scene rough = scene;
  rough.staticFriction = kManyFriction;
  const std::optional<StabilityMargin> roughMargin = tiltMargin(staticScene(rough));
  scene.settings.sleep = Sleep::off;
  const double tilt_deg = margin ? margin->tilt_deg : -1.0;
  const double rough_deg = roughMargin ? roughMargin->tilt_deg : -1.0;
  return {id, std::move(scene), tilt_deg, margin ? margin->direction_deg : 0.0, rough_deg > tilt_deg + kSameMargin_deg};
}

TiltTrial trialOf(const Tilted& tower, std::optional<double> tolerance_m) {
  Scene scene = tower.scene;
  scene.settings.tolerance_m = tolerance_m;
  const double start_deg = std::max(0.0, tower.margin_deg - (tolerance_m ? kAhead_deg : kSoftAhead_deg));
  return tiltUntilFall(scene, {tower.direction_deg, start_deg, 2.0, 1.0, 0.1, tower.margin_deg + kBeyondMargin_deg},
                       endIfInterrupted, {.goesOn = [](const PrepareProgress&) { return !interrupted(); }});
}

std::string wordsFor(const Tilted& tower, const TiltTrial& trial) {
  return fmt::format("{}{:+.3f}", trial.fell ? "" : "stands at ", trial.tilt_deg - tower.margin_deg);
}

int rowsOf(const Scene& scene) {
  int rows = 0;
  for (const BlockSpec& block : scene.blocks) rows = std::max(rows, block.row + 1);
  return rows;
}

// Towers of the set `shift` of up to eight rows that stand by a margin under 20 degrees, evenly drawn.
std::vector<Tilted> tiltedScenes(const ValidationPlan& plan, std::size_t count) {
  const std::string path = plan.oracle + "/shift.jsonl";
  std::ifstream file(path);
  if (!file) throw InputError(fmt::format("--oracle: expected the folder of the reference sets, got no file {}", path));
  std::vector<VerdictLine> fit;
  for (VerdictLine& line : readVerdictLines(file, path)) {
    if (rowsOf(line.scene) > kMaxTiltedRows || !isClear(line)) continue;
    if (!line.expect.contains("tilt_deg") || !line.expect.at("tilt_deg").is_number()) continue;
    const double tilt_deg = line.expect.at("tilt_deg").get<double>();
    if (tilt_deg > kMinMargin_deg && tilt_deg < kMaxMargin_deg) fit.push_back(std::move(line));
  }
  std::vector<Tilted> drawn;
  for (std::size_t i = 0; i < std::min(count, fit.size()); ++i) {
    const VerdictLine& line = fit[i * fit.size() / std::min(count, fit.size())];
    drawn.push_back(tiltedScene(line.id, line.scene));
  }
  return drawn;
}

Plot tiltPlot(const std::vector<Tilted>& towers) {
  Plot plot;
  plot.title = "Tilt of gravity at which the tower goes";
  plot.subtitle = "turned at 0.1 degree a second towards the worst side, tolerance 0.01 mm";
  plot.x.title = "tilt of rigid statics, degrees";
  plot.y.title = "simulated less computed, degrees";
  PlotLine stiff{"tips", {}};
  PlotLine sliding{"friction active", {}};
  for (const Tilted& tower : towers) {
    if (!tower.trial.fell) continue;
    (tower.frictionActive ? sliding : stiff).points.push_back({tower.margin_deg, tower.trial.tilt_deg - tower.margin_deg});
  }
  for (PlotLine* line : {&stiff, &sliding}) {
    line->joined = false;
    if (!line->points.empty()) plot.lines.push_back(*line);
  }
  plot.references = {{kTolerance_deg, "+0.3"}, {-kTolerance_deg, "-0.3"}, {-kEarlier_deg, "-0.5 with friction"}};
  return plot;
}

}  // namespace

ValidationSection validateTilts(const ValidationPlan& plan) {
  ValidationSection section{
      "Turning gravity",
      "Gravity turns by 0.1 degree a second towards the worst side that statics gives; the tower goes when "
      "a block has fallen (half its "
      "least side lower, half its middle side aside or turned by 5 degrees). Friction is active where the margin would "
      "be larger with more of it; "
      "statics is an upper bound there. Elastic blocks let a tower lean, so it goes earlier by an angle that shrinks "
      "with the tolerance: what is judged is 0.01 mm, beside it stands the default."};
  std::vector<Tilted> towers = tiltedScenes(plan, plan.longForm ? 20 : 8);
  towers.push_back(tiltedScene("18 rows", towerScene(18)));
  tbb::parallel_for(std::size_t{0}, 2 * towers.size(), [&](std::size_t i) {
    tbb::this_task_arena::isolate([&] {
      Tilted& tower = towers[i / 2];
      if (i % 2 == 0) tower.trial = trialOf(tower, kFineTolerance_m);
      if (i % 2 == 1) tower.softTrial = trialOf(tower, std::nullopt);
    });
  });
  for (std::size_t i = 0; i < towers.size(); ++i) {
    const Tilted& tower = towers[i];
    const double late_deg = tower.trial.tilt_deg - tower.margin_deg;
    const double earliest_deg = tower.frictionActive ? -kEarlier_deg : -kTolerance_deg;
    Claim claim{
        fmt::format("{}: statics {:.2f} degrees{}", tower.id, tower.margin_deg, tower.frictionActive ? ", friction active" : ""),
        fmt::format("{:+.1f} to +0.3 degrees", earliest_deg),
        fmt::format("{}; {} with the default tolerance", wordsFor(tower, tower.trial), wordsFor(tower, tower.softTrial))};
    if (i + 1 == towers.size()) {
      claim.tolerance = "reported";
    } else {
      claim.passed = tower.trial.fell && late_deg >= earliest_deg && late_deg <= kTolerance_deg;
    }
    section.claims.push_back(std::move(claim));
  }
  section.figures.push_back({"tilt", tiltPlot(towers)});
  return section;
}

}  // namespace springtower
