#include "apps/commands/validate/frames.h"
#include "apps/commands/validate/validate.h"
#include "solver/hand/grip.h"
#include "solver/runner/run.h"
#include "solver/runner/trials.h"
#include "solver/statics/statics.h"

#include <algorithm>
#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace springtower {
namespace {

constexpr double kSlides_m = 1e-3;  // moved by this it slides
constexpr double kDrawSpeed_m_s = 0.04;
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

// What came of a block that was drawn out at 4 cm/s.
struct DrawnOut {
  bool slept = false;  // before
  bool freed = false;
  bool stands = false;
  std::vector<double> awake = {};  // blocks, in each frame while it slides
};

// A block to draw out of a tower that sleeps, and of the same tower with nothing asleep.
struct SleepPull {
  std::string name;
  Scene scene;
  int row;
  bool loose = false;
  bool stands = true;  // what is to come of it
  DrawnOut asleep = {};
  DrawnOut awake = {};
};

bool touchesAnything(const Simulation& simulation, BlockId block) {
  return !contactForcesOn(simulation, block).empty();
}

DrawnOut drawOut(Scene scene, int row, Sleep sleep) {
  DrawnOut drawn;
  scene.settings.sleep = sleep;
  Simulation simulation(scene);
  while (!(sleep == Sleep::off ? atRest(simulation) : awakeBlocks(simulation) == 0) && simulation.time_s < kLongestSettling_s) {
    stepFrameOrEnd(simulation);
  }
  drawn.slept = awakeBlocks(simulation) == 0;
  std::size_t block = 0;
  while (scene.blocks[block].row != row || scene.blocks[block].position != 2) ++block;
  const Vec3 direction = scene.blocks[block].orientation * Vec3::UnitX();
  Draw draw = drawingFrom(simulation, blockId(block), direction, kDrawSpeed_m_s);
  std::vector<std::uint8_t> leftOut(scene.blocks.size(), 0);
  leftOut[block] = 1;
  const std::vector<FittedBox> start = fittedBoxes(simulation.state.position);
  const Vec3 before = centre(simulation.state.position, block);
  const double begin_s = simulation.time_s;
  while (!drawn.freed && simulation.time_s < begin_s + kLongestPull_s) {
    advancePull(draw, contactForcesOn(simulation, blockId(block)), simulation);
    stepFrameOrEnd(simulation);
    const double moved = (centre(simulation.state.position, block) - before).dot(direction);
    if (moved < kSlides_m) continue;
    drawn.awake.push_back(static_cast<double>(awakeBlocks(simulation)));
    drawn.freed = moved > kBlockLength_m && !touchesAnything(simulation, blockId(block));
  }
  const double end_s = simulation.time_s + kHeld_s;
  draw.hand.velocity = Vec3::Zero();
  draw.hand.line = Vec3::Zero();
  while (drawn.freed && simulation.time_s < end_s) {
    hold(draw.hand, contactForcesOn(simulation, blockId(block)), draw.grip, simulation);
    stepFrameOrEnd(simulation);
  }
  drawn.stands = standing(simulation.model, start, simulation.state.position, leftOut).stands;
  return drawn;
}

// Counts frame by frame: "9, 3 x 110, 12".
std::string countsByFrame(const std::vector<double>& counts) {
  std::string text;
  for (std::size_t i = 0, same = 0; i < counts.size(); i += same) {
    same = 1;
    while (i + same < counts.size() && counts[i + same] == counts[i]) ++same;
    text += fmt::format("{}{:g}{}", text.empty() ? "" : ", ", counts[i], same > 1 ? fmt::format(" x {}", same) : "");
  }
  return text;
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
    results.push_back(runSceneOrEnd(simulation, options));
  }
  const auto words = [](const RunResult& result) {
    return result.fallTime_s ? fmt::format("falls at {:.3f} s", *result.fallTime_s) : std::string("stands for 20 s");
  };
  section.claims.push_back(
      {"centre of mass 0.02 mm beyond the edge, sleep on", "falls", words(results[0]), results[0].fallTime_s.has_value()});
  section.claims.push_back({"the same, sleep off", "falls", words(results[1]), results[1].fallTime_s.has_value()});
}

// The pulls that are judged: out of towers of 18 and 54 rows.
std::vector<SleepPull> sleepPulls(bool longForm) {
  std::vector<SleepPull> pulls;
  const Scene tower = towerScene(18);
  const Scene tall = towerScene(3 * 18);
  const auto add = [&](const Scene& scene, int rows, int row, bool stands = true) {
    pulls.push_back({fmt::format("{} rows, row {}, middle", rows, row), scene, row - 1, false, stands});
  };
  for (const int row : {2, 9, 16}) add(tower, 18, row);
  TowerOptions loose;
  loose.loose.push_back({8, 2, 0.0003});
  pulls.push_back({"18 rows, row 9, loose", towerScene(18, loose), 8, true});
  add(tall, 54, 52);
  if (longForm) {
    for (const int row : {15, 14}) add(tower, 18, row);
    for (const int row : {51, 50}) add(tall, 54, row);
    for (const int row : {45, 38}) add(tall, 54, row, false);
  }
  return pulls;
}

// Claims that the block comes out and that the tower stands or falls, asleep as awake.
void claimDrawnOut(const SleepPull& what, ValidationSection& section) {
  const DrawnOut& drawn = what.asleep;
  section.claims.push_back({what.name + ": asleep before", "all blocks", drawn.slept ? "yes" : "no", drawn.slept});
  const auto words = [](const DrawnOut& of) {
    return fmt::format("{}, {}", of.freed ? "free" : "not free", of.stands ? "stands" : "falls");
  };
  const auto expected = [&](const DrawnOut& of) { return what.stands ? of.freed && of.stands : !of.stands; };
  section.claims.push_back(
      {what.name + ": pulled out", what.stands ? "free within 8 s, the tower stands, both ways" : "falls, both ways",
       fmt::format("{}; with nothing asleep {}", words(drawn), words(what.awake)), expected(drawn) && expected(what.awake)});
}

}  // namespace

ValidationSection validateSleep(const ValidationPlan& plan) {
  ValidationSection section{
      "Sleep",
      "A block is pulled out of a sleeping tower at 4 cm/s; awake blocks are counted in every frame from "
      "the first millimetre until nothing touches it any more. Then out of the same tower with nothing "
      "asleep. Where the friction force is about the tipping force of the tower or above (`statics --pull`: 1.46 and "
      "1.54 N in row 45 of 54, 2.54 and 1.82 N in row 38) a slow pull tips it over, and it has to tip over asleep "
      "as well. Rows count from 1 at the bottom."};
  std::vector<SleepPull> pulls = sleepPulls(plan.longForm);
  tbb::parallel_for(std::size_t{0}, 2 * pulls.size(), [&](std::size_t i) {
    tbb::this_task_arena::isolate([&] {
      SleepPull& what = pulls[i / 2];
      (i % 2 == 0 ? what.asleep : what.awake) = drawOut(what.scene, what.row, i % 2 == 0 ? Sleep::on : Sleep::off);
    });
  });
  Plot plot;
  plot.title = "Awake blocks while one is pulled out of a sleeping tower";
  plot.subtitle = "4 cm/s, from the first millimetre until nothing touches it";
  plot.x.title = "frame";
  plot.y.title = "awake blocks";
  for (const SleepPull& what : pulls) {
    claimDrawnOut(what, section);
    const DrawnOut& drawn = what.asleep;
    if (!what.stands) continue;  // all of it moves
    double most = static_cast<double>(what.loose ? kLooseAwake : kLoadedAwake);
    std::string tolerance = fmt::format("median at most {}", most);
    if (what.scene.blocks.size() > pulls.front().scene.blocks.size()) {  // as many rows above as in the tower of 18
      const auto same = std::find_if(pulls.begin(), pulls.end(),
                                     [&](const SleepPull& other) { return !other.loose && other.row + 36 == what.row; });
      most = quantile(same->asleep.awake, 0.5) + static_cast<double>(kTallerMore);
      tolerance = fmt::format("median at most 2 above that of row {} of 18", same->row + 1);
    }
    const double median = quantile(drawn.awake, 0.5);
    section.claims.push_back({what.name + ": awake blocks", tolerance,
                              fmt::format("median {:g}, most {:g} of {} over {} frames", median, quantile(drawn.awake, 1.0),
                                          what.scene.blocks.size(), drawn.awake.size()),
                              drawn.freed && drawn.stands && median <= most});
    section.notes.push_back(fmt::format("{}, awake blocks frame by frame: {}", what.name, countsByFrame(drawn.awake)));
    PlotLine line{what.name, {}, Marker::none};
    for (std::size_t i = 0; i < drawn.awake.size(); ++i) line.points.push_back({static_cast<double>(i), drawn.awake[i]});
    plot.lines.push_back(line);
  }
  section.figures.push_back({"awake", plot});
  addOverhang(section);
  return section;
}

}  // namespace springtower
