#include "apps/validate.h"
#include "solver/grip.h"
#include "solver/run.h"
#include "solver/statics.h"
#include "solver/trials.h"

#include <algorithm>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

constexpr double kSlides_m = 1e-3;  // moved by this it slides
constexpr double kPullSpeed_m_s = 0.04;
constexpr double kLongestPull_s = 8.0;
constexpr double kHeld_s = 1.0;  // after that the tower has to stand
constexpr double kLongestSettling_s = 10.0;
constexpr double kOverhang_m = 2e-5;
constexpr std::size_t kLoadedAwake = 12;
constexpr std::size_t kLooseAwake = 6;
constexpr std::size_t kTallerMore = 2;

std::size_t awakeBlocks(const Simulation& simulation) {
  return static_cast<std::size_t>(std::count(simulation.asleep.begin(), simulation.asleep.end(), std::uint8_t{0}));
}

// A block drawn out of a sleeping tower at 4 cm/s.
struct SleepPull {
  std::string name;
  Scene scene;
  int row;
  bool loose;
  bool slept = false;
  bool freed = false;
  bool stands = false;
  std::vector<double> awake = {};  // of each frame while it slides
};

bool touchesAnything(const Simulation& simulation, BlockId block) {
  return !contactForcesOn(simulation, block).empty();
}

void drawOut(SleepPull& what) {
  Simulation simulation(what.scene);
  while (awakeBlocks(simulation) > 0 && simulation.time_s < kLongestSettling_s) stepFrame(simulation);
  what.slept = awakeBlocks(simulation) == 0;
  std::size_t block = 0;
  while (what.scene.blocks[block].row != what.row || what.scene.blocks[block].position != 2) ++block;
  const Vec3 direction = what.scene.blocks[block].orientation * Vec3::UnitX();
  Draw draw = drawingFrom(simulation, blockId(block), direction, kPullSpeed_m_s);
  std::vector<std::uint8_t> leftOut(what.scene.blocks.size(), 0);
  leftOut[block] = 1;
  const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
  const Vec3 before = centre(simulation.state.position, block);
  const double begin_s = simulation.time_s;
  while (!what.freed && simulation.time_s < begin_s + kLongestPull_s) {
    drawOn(draw, contactForcesOn(simulation, blockId(block)), simulation);
    stepFrame(simulation);
    const double moved = (centre(simulation.state.position, block) - before).dot(direction);
    if (moved < kSlides_m) continue;
    what.awake.push_back(static_cast<double>(awakeBlocks(simulation)));
    what.freed = moved > kBlockLength_m && !touchesAnything(simulation, blockId(block));
  }
  const double end_s = simulation.time_s + kHeld_s;
  draw.hand.velocity = Vec3::Zero();
  draw.hand.line = Vec3::Zero();
  while (what.freed && simulation.time_s < end_s) {
    hold(draw.hand, contactForcesOn(simulation, blockId(block)), draw.grip, simulation);
    stepFrame(simulation);
  }
  what.stands = standing(simulation.model, start, simulation.state.position, leftOut).stands;
}

// Two crossed blocks, the upper one's centre of mass beyond the lower one's edge by so much.
Scene overhanging(double over_m, Sleep sleep) {
  TowerOptions options;
  options.offsets.push_back({1, 2, 0.0, 0.5 * kBlockWidth_m + over_m});
  Scene scene = bitCodeScene("(010)-(010)", options);
  scene.settings.sleep = sleep;
  return scene;
}

void addOverhang(ValidationSection& section) {
  RunOptions options;
  options.seconds = 20.0;
  options.stopWhenFallen = true;
  options.measureEveryFrame = false;
  std::vector<RunResult> results;
  for (const Sleep sleep : {Sleep::on, Sleep::off}) {
    Simulation simulation(overhanging(kOverhang_m, sleep));
    results.push_back(runScene(simulation, options));
  }
  const auto words = [](const RunResult& result) {
    return result.fallTime_s ? fmt::format("falls at {:.3f} s", *result.fallTime_s) : std::string("stands for 20 s");
  };
  section.claims.push_back(
      {"centre of mass 0.02 mm beyond the edge, sleep on", "falls", words(results[0]), results[0].fallTime_s.has_value()});
  section.claims.push_back({"the same, sleep off", "falls", words(results[1]), results[1].fallTime_s.has_value()});
}

}  // namespace

ValidationSection validateSleep(const ValidationPlan& plan) {
  ValidationSection section{"Sleep",
                            "A block is drawn out of a sleeping tower at 4 cm/s; awake blocks are counted in every frame from "
                            "the first millimetre until "
                            "nothing touches it any more. Rows count from 1 at the bottom."};
  std::vector<SleepPull> pulls;
  const Scene tower = towerScene(18);
  for (const int row : {2, 9, 16}) pulls.push_back({fmt::format("18 rows, row {}, middle", row), tower, row - 1, false});
  TowerOptions loose;
  loose.loose.push_back({8, 2, 0.0003});
  pulls.push_back({"18 rows, row 9, loose", towerScene(18, loose), 8, true});
  pulls.push_back({"54 rows, row 52, as many above as over row 16 of 18", towerScene(54), 51, false});
  if (plan.longForm) {
    pulls.push_back({"54 rows, row 45, as many above as over row 9 of 18", towerScene(54), 44, false});
    pulls.push_back({"54 rows, row 38, as many above as over row 2 of 18", towerScene(54), 37, false});
  }
  tbb::parallel_for(std::size_t{0}, pulls.size(),
                    [&](std::size_t i) { tbb::this_task_arena::isolate([&] { drawOut(pulls[i]); }); });
  Plot plot;
  plot.title = "Awake blocks while one is drawn out of a sleeping tower";
  plot.subtitle = "4 cm/s, from the first millimetre until nothing touches it";
  plot.x.title = "frame";
  plot.y.title = "awake blocks";
  const auto medianOf = [&](const SleepPull& what) { return quantile(what.awake, 0.5); };
  const auto addPull = [&](const SleepPull& what, double most, const std::string& tolerance) {
    const std::string counted = fmt::format("median {:g}, most {:g} of {} over {} frames", medianOf(what),
                                            quantile(what.awake, 1.0), what.scene.blocks.size(), what.awake.size());
    section.claims.push_back({what.name + ": asleep before", "all blocks", what.slept ? "yes" : "no", what.slept});
    section.claims.push_back({what.name + ": awake blocks", tolerance, what.awake.empty() ? "it does not slide" : counted,
                              !what.awake.empty() && medianOf(what) <= most});
    section.claims.push_back({what.name + ": drawn out", "free within 8 s, the tower stands",
                              fmt::format("{}, {}", what.freed ? "free" : "not free", what.stands ? "stands" : "falls"),
                              what.freed && what.stands});
    PlotLine line{what.name, {}, Marker::none};
    for (std::size_t i = 0; i < what.awake.size(); ++i) line.points.push_back({static_cast<double>(i), what.awake[i]});
    if (!line.points.empty()) plot.lines.push_back(line);
  };
  for (const SleepPull& what : pulls) {
    if (what.scene.blocks.size() <= 54) {
      const std::size_t most = what.loose ? kLooseAwake : kLoadedAwake;
      addPull(what, static_cast<double>(most), fmt::format("median at most {}", most));
      continue;
    }
    // As many rows above as in the tower of 18.
    const auto same = std::find_if(pulls.begin(), pulls.end(),
                                   [&](const SleepPull& other) { return !other.loose && other.row + 36 == what.row; });
    const double most = medianOf(*same) + static_cast<double>(kTallerMore);
    addPull(what, most, fmt::format("median at most 2 above {:g}", medianOf(*same)));
  }
  section.figures.push_back({"awake", plot});
  addOverhang(section);
  return section;
}

}  // namespace springtower
