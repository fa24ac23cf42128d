#include "apps/commands/chart/draw.h"

#include "apps/commands/chart/recorded_peers.h"
#include "apps/commands/chart/scene.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <ostream>

namespace springtower {
namespace {

constexpr double kFrame_ms = 1e3 / 60.0;
constexpr int kFrontStyle = 6;                                         // grey
constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();  // interrupts a line
constexpr std::array<double, 3> kTolerances_mm = {0.1, 0.01, 0.001};

// As a chart shows it: what is below the floor of its measure makes no difference.
double shown(const ChartResult& result, ChartMeasure measure) {
  return std::max(result.of(measure), kChartMeasureRows[static_cast<std::size_t>(measure)].floor);
}

bool drawn(const ChartResult& result, ChartMeasure measure) {
  return std::isfinite(result.of(measure)) && std::isfinite(result.frame_ms);
}

std::string describe(ChartScene scene, const ChartLimits& limits) {
  const int rows = limits.rows;
  switch (scene) {
    case ChartScene::uniform:
      return fmt::format("a tower of {} rows of equal blocks at rest", rows);
    case ChartScene::heights:
      return fmt::format("a tower of {} rows, heights varying by 0.2 mm, at rest", rows);
    case ChartScene::pull:
      return fmt::format("a block of the middle row of {} pulled out at 4 cm/s", rows);
    case ChartScene::drop:
      return "three rows dropped together from 2 cm";
    case ChartScene::collapse:
      return fmt::format("a tower of {} rows that leans more than it can stand", rows);
    case ChartScene::spin:
      return "one block tumbling without gravity";
    case ChartScene::heavyLight:
      return fmt::format("a tower of {} rows, every other row ten times as heavy, at rest", rows);
    case ChartScene::wall:
      return fmt::format("a wall of {} columns and {} courses in running bond at rest", limits.wallColumns, limits.wallCourses);
    case ChartScene::pyramid:
      return fmt::format("a pyramid of {} rows of cubes of 20 mm at rest", limits.pyramidRows);
    case ChartScene::shot:
      return fmt::format("a block that flies into a tower of {} rows at 5 m/s", rows);
    case ChartScene::heap200:
      return "200 blocks turned at random that fall into a heap";
    case ChartScene::rain200:
      return "200 blocks turned at random that land within a second";
    case ChartScene::pile3:
      return "three square rows of 108 blocks, shifted by half a block, that land after 10 cm";
    case ChartScene::holes:
      return "a tower of twelve rows, half of them with blocks missing";
    case ChartScene::lean:
      return "a tower of nine rows, gravity 9 degrees from straight down";
    case ChartScene::tall:
      return "a tower of 36 rows at rest";
    case ChartScene::slide:
      return "a block that slides over the floor until friction stops it";
    case ChartScene::heap:
      return "eight blocks dropped on one another askew";
    case ChartScene::thrown:
      return "two blocks that meet in the air askew and fall to the floor";
  }
  return "";
}

// Beside a point: only what went wrong, and where it counts that less time was looked at. That a fall falls went well.
std::string labelOf(const ChartResult& result, ChartMeasure measure) {
  if (isFall(result.what.scene) && result.outcome == ChartOutcome::timedOut) return std::string(nameOf(result.outcome));
  if (result.outcome == ChartOutcome::cutShort && measure != ChartMeasure::creep) return "";
  return result.outcome == ChartOutcome::right ? "" : result.note;
}

std::string titleOf(ChartScene scene, ChartMeasure measure, const ChartLimits& limits) {
  const double end_s = timesOf(scene, limits).end_s;
  if (measure == ChartMeasure::creep) return fmt::format("creep from {:g} to {:g} s, mm", 0.5 * end_s, end_s);
  return std::string(kChartMeasureRows[static_cast<std::size_t>(measure)].title);
}

// A case that was cut short has its figures but for creep, which takes time.
bool counts(const ChartResult& result, ChartMeasure measure) {
  return result.outcome == ChartOutcome::right || (result.outcome == ChartOutcome::cutShort && measure != ChartMeasure::creep);
}

// The methods' colours are in their order; those of other engines follow, and then those of engines measured elsewhere.
int styleOf(const ChartCase& what) {
  return static_cast<int>(what.peer == Peer::none ? what.method : Method::automatic) + static_cast<int>(what.peer);
}
constexpr int kElsewhereStyle = static_cast<int>(Method::automatic) + static_cast<int>(kPeerNames.size());
static_assert(kElsewhereStyle + 2 == kPlotStyles, "a colour for each, two engines elsewhere");

bool measuredHere(const Chart& chart, const PeerResult& peer) {
  return std::any_of(chart.results.begin(), chart.results.end(), [&](const ChartResult& result) {
    const std::string_view name = nameOf(result.what.peer);
    return std::equal(name.begin(), name.end(), peer.engine.begin(), peer.engine.end(),
                      [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
  });
}

std::string listed(const std::vector<const ChartResult*>& front) {
  std::string text;
  for (const ChartResult* result : front) text += fmt::format("{}{}", text.empty() ? "" : "; ", nameOf(result->what));
  return text.empty() ? "none" : text;
}

// Where those are drawn that have a cost and no figure: to the right of all that have one.
double railOf(const Chart& chart, ChartScene scene, ChartMeasure measure) {
  double most = 0.0;
  for (const ChartResult& result : chart.results) {
    if (result.what.scene == scene && drawn(result, measure)) most = std::max(most, shown(result, measure));
  }
  return 3.0 * most;
}

// More passes over the contacts are a second parameter, and points of their own.
std::string lineOf(const ChartCase& what) {
  const bool second = what.peer == Peer::none && what.iterations > 0;
  return std::string(methodOf(what)) + (second ? ", more passes" : "");
}

// Adds what was measured here, a line for each method, and what is missing or was cut short to the texts that say so.
void addResults(const Chart& chart, ChartScene scene, ChartMeasure measure, Plot& plot, std::string& missing, std::string& cut) {
  const double rail = railOf(chart, scene, measure);
  for (const ChartResult& result : chart.results) {
    if (result.what.scene != scene) continue;
    const bool failed = result.outcome == ChartOutcome::timedOut || result.outcome == ChartOutcome::diverged;
    const std::string name = lineOf(result.what);
    if (drawn(result, measure) || failed) {  // all that failed has its place in the legend
      if (plot.lines.empty() || plot.lines.back().name != name) {
        plot.lines.push_back({name, {}, Marker::filled});
        plot.lines.back().style = styleOf(result.what);
        plot.lines.back().joined = result.what.peer == Peer::none && result.what.iterations == 0;  // two parameters make no line
      }
      PlotLine& line = plot.lines.back();
      if (drawn(result, measure)) {
        line.points.push_back({shown(result, measure), result.frame_ms});
        line.labels.push_back(labelOf(result, measure));
      } else if (std::isfinite(result.frame_ms)) {  // else it has no place, and must not widen the axis
        line.points.insert(line.points.end(), {{kNowhere, kNowhere}, {rail, result.frame_ms}});
        line.labels.insert(line.labels.end(), {"", std::string(nameOf(result.outcome))});
      }
    }
    if (!drawn(result, measure))
      missing += fmt::format("{}{} ({})", missing.empty() ? "" : "; ", nameOf(result.what),
                             result.note.empty() ? "not measured" : result.note);
    if (result.outcome == ChartOutcome::cutShort)
      cut += fmt::format("{}{} ({:.3g} s)", cut.empty() ? "" : "; ", nameOf(result.what), result.simulated_s);
  }
}

// A record of a stack says in a sentence which block has moved where; of a fall, that it does.
std::string labelOf(const PeerResult& peer) {
  if (isFall(peer.scene)) return "";
  if (isStack(peer.scene)) return peer.verdict == "stands" ? "" : "fell";
  return peer.verdict.starts_with("yes") ? "" : peer.verdict;
}

// An engine has one colour in all charts of a scene, also in those in which another has no point. Those that were measured here
// have their own.
int elsewhereStyle(const Chart& chart, ChartScene scene, const std::string& engine) {
  std::vector<std::string> before;
  for (const PeerResult& peer : chart.peers) {
    if (peer.scene != scene || measuredHere(chart, peer)) continue;
    if (peer.engine == engine) break;
    if (std::find(before.begin(), before.end(), peer.engine) == before.end()) before.push_back(peer.engine);
  }
  return kElsewhereStyle + static_cast<int>(before.size());
}

// Adds other engines as they were measured elsewhere.
void addPeers(const Chart& chart, ChartScene scene, ChartMeasure measure, Plot& plot) {
  const ChartMeasureRow& row = kChartMeasureRows[static_cast<std::size_t>(measure)];
  for (const PeerResult& peer : chart.peers) {
    const double value = peer.measured[static_cast<std::size_t>(measure)];
    const double frame_ms = drawnTime_ms(chart, peer);
    if (peer.scene != scene || !std::isfinite(value) || !(frame_ms > 0.0) || measuredHere(chart, peer)) continue;
    const std::string name = peer.engine + " (elsewhere)";
    auto line = std::find_if(plot.lines.begin(), plot.lines.end(), [&](const PlotLine& one) { return one.name == name; });
    if (line == plot.lines.end()) {
      line = plot.lines.insert(line, {name, {}, Marker::hollow});
      line->style = elsewhereStyle(chart, scene, peer.engine);
      line->joined = !isDrawnAsRecorded(scene);  // these were measured more than once
    }
    line->points.push_back({std::max(value, row.floor), frame_ms});
    line->labels.push_back(labelOf(peer));
  }
}

void addFront(const std::vector<const ChartResult*>& front, ChartMeasure measure, Plot& plot) {
  if (front.empty()) return;
  PlotLine line{"Pareto front, measured here", {}, Marker::ring};
  line.dashed = true;
  line.style = kFrontStyle;
  for (const ChartResult* result : front) line.points.push_back({shown(*result, measure), result->frame_ms});
  plot.lines.push_back(std::move(line));
}

// What the times of a chart's frames are.
enum class ChartCost { mean, median, worst };
constexpr std::array<std::string_view, 3> kChartCostNames = {"mean", "median", "largest"};

ChartCost usualCost(ChartScene scene) {
  return isFall(scene) ? ChartCost::median : ChartCost::mean;
}

// The same chart with the cost of the worst frame in place of the usual one.
Chart withWorstFrames(Chart chart) {
  for (ChartResult& result : chart.results) result.frame_ms = result.worst_ms;
  for (PeerResult& peer : chart.peers) peer.frame_ms = peer.worst_ms;
  return chart;
}

std::string costTitle(ChartCost cost) {
  switch (cost) {
    case ChartCost::mean:
      break;
    case ChartCost::median:
      return "median processor time of a frame of 1/60 s, ms";
    case ChartCost::worst:
      return "processor time of the worst frame but the first, ms";
  }
  return "processor time of a frame of 1/60 s, ms";
}

// Where the hollow points come from, and which are missing.
std::string elsewhereText(const Chart& chart, ChartScene scene, ChartCost cost) {
  if (std::none_of(chart.peers.begin(), chart.peers.end(), [&](const PeerResult& peer) { return peer.scene == scene; }))
    return "";
  if (!isDrawnAsRecorded(scene)) return "Hollow: other engines, measured elsewhere and carried over by their ratio to Bullet. ";
  return fmt::format("Hollow: other engines, measured elsewhere on an AMD EPYC (Zen 4), as they were recorded{}. ",
                     cost == ChartCost::worst ? "; without those of which only the first frame, their longest, is known" : "");
}

Plot plotOf(const Chart& chart, ChartScene scene, ChartMeasure measure, ChartCost cost) {
  const ChartMeasureRow& row = kChartMeasureRows[static_cast<std::size_t>(measure)];
  Plot plot;
  const std::string title = titleOf(scene, measure, chart.limits);
  plot.title = "Speed against accuracy: " + title;
  plot.subtitle = describe(scene, chart.limits);
  plot.x = {title, true};
  plot.y = {costTitle(cost), true};
  plot.references = {{kFrame_ms, "16.7 ms: real time"}};
  std::string missing;
  std::string cut;
  addResults(chart, scene, measure, plot, missing, cut);
  addPeers(chart, scene, measure, plot);
  const std::vector<const ChartResult*> front = paretoFront(chart, scene, measure);
  addFront(front, measure, plot);
  plot.footnote = fmt::format("Pareto front: {}. Values below {:g} are drawn there. ", listed(front), row.floor);
  if (!missing.empty()) plot.footnote += "Without a figure, at the right edge where their cost is known: " + missing + ". ";
  if (!cut.empty()) {
    plot.footnote +=
        fmt::format("Looked at for less time{}: {}. ", measure == ChartMeasure::creep ? ", and left out of the front" : "", cut);
  }
  plot.footnote += elsewhereText(chart, scene, cost);
  plot.footnote +=
      fmt::format("One thread; {} {} up to {} frames, of each the least of up to {} samples, or more where they are short. {}",
                  kChartCostNames[static_cast<std::size_t>(cost)], cost == ChartCost::worst ? "of" : "over", chart.limits.frames,
                  chart.limits.samples, footnote(chart.provenance));
  return plot;
}

}  // namespace

std::vector<ChartScene> scenesIn(const Chart& chart) {
  std::vector<ChartScene> scenes;
  for (std::size_t i = 0; i < kChartSceneNames.size(); ++i) {
    const auto scene = static_cast<ChartScene>(i);
    if (std::any_of(chart.results.begin(), chart.results.end(), [&](const ChartResult& r) { return r.what.scene == scene; }))
      scenes.push_back(scene);
  }
  return scenes;
}

std::vector<const ChartResult*> paretoFront(const Chart& chart, ChartScene scene, ChartMeasure measure) {
  std::vector<const ChartResult*> candidates;
  for (const ChartResult& result : chart.results) {
    if (result.what.scene == scene && counts(result, measure) && drawn(result, measure)) candidates.push_back(&result);
  }
  std::vector<const ChartResult*> front;
  for (const ChartResult* result : candidates) {
    const bool beaten = std::any_of(candidates.begin(), candidates.end(), [&](const ChartResult* other) {
      const double here = shown(*result, measure);
      const double there = shown(*other, measure);
      return other->frame_ms <= result->frame_ms && there <= here && (other->frame_ms < result->frame_ms || there < here);
    });
    if (!beaten) front.push_back(result);
  }
  std::sort(front.begin(), front.end(), [](const ChartResult* a, const ChartResult* b) { return a->frame_ms > b->frame_ms; });
  return front;
}

bool meets(const ChartResult& result, double tolerance_mm) {
  if (result.outcome != ChartOutcome::right || !std::isfinite(result.frame_ms)) return false;
  const auto within = [&](ChartMeasure measure) { return !(result.of(measure) > tolerance_mm); };  // what was not measured does
  return within(ChartMeasure::penetration) && within(ChartMeasure::compression) && within(ChartMeasure::creep);
}

const ChartResult* fastestWithin(const Chart& chart, ChartScene scene, double tolerance_mm) {
  const ChartResult* fastest = nullptr;
  for (const ChartResult& result : chart.results) {
    if (result.what.scene != scene || result.what.method == Method::automatic || !meets(result, tolerance_mm)) continue;
    if (fastest == nullptr || result.frame_ms < fastest->frame_ms) fastest = &result;
  }
  return fastest;
}

AutoChoice choiceOf(const Chart& chart, ChartScene scene) {
  constexpr double kMaxRatio = 1.5;
  AutoChoice choice;
  for (const ChartResult& result : chart.results) {
    if (result.what.scene == scene && result.what.method == Method::automatic) choice.chosen = &result;
  }
  if (choice.chosen == nullptr) return choice;
  choice.best = fastestWithin(chart, scene, 1e3 * kAutoTolerance_m);
  choice.within = meets(*choice.chosen, 1e3 * kAutoTolerance_m);
  if (choice.best != nullptr) choice.ratio = choice.chosen->frame_ms / choice.best->frame_ms;
  choice.passes = choice.within && (choice.best == nullptr || choice.ratio <= kMaxRatio);
  return choice;
}

std::vector<std::pair<std::string, Plot>> chartPlots(const Chart& chart) {
  std::vector<std::pair<std::string, Plot>> plots;
  const Chart worst = withWorstFrames(chart);
  for (const ChartScene scene : scenesIn(chart)) {
    for (std::size_t i = 0; i < kChartMeasures; ++i) {
      const auto measure = static_cast<ChartMeasure>(i);
      const bool any = std::any_of(chart.results.begin(), chart.results.end(), [&](const ChartResult& result) {
        return result.what.scene == scene && drawn(result, measure);
      });
      if (!any) continue;
      std::string name = fmt::format("{}_{}", nameOf(scene), kChartMeasureRows[i].key);
      std::replace(name.begin(), name.end(), '-', '_');
      plots.emplace_back(name, plotOf(chart, scene, measure, usualCost(scene)));
      if (isFall(scene) && measure == ChartMeasure::penetration)
        plots.emplace_back(name + "_worst", plotOf(worst, scene, measure, ChartCost::worst));
    }
  }
  return plots;
}

void writeChartIndex(std::ostream& stream, const Chart& chart, const std::vector<std::string>& names) {
  stream << "# Speed against accuracy\n\nEvery method on the same scenes, each with its own parameter. All figures are in "
            "[chart.csv](chart.csv).\n\n"
         << footnote(chart.provenance) << "\n\n## The fastest method within a tolerance\n\n"
         << "No penetration, no compression of a row and no creep above it, and the right verdict; ms of CPU time a frame.\n\n"
         << "| scene |";
  for (const double tolerance : kTolerances_mm) stream << fmt::format(" {:g} mm |", tolerance);
  stream << "\n|---|---|---|---|\n";
  for (const ChartScene scene : scenesIn(chart)) {
    if (!comesToRest(scene)) continue;
    stream << fmt::format("| {} |", nameOf(scene));
    for (const double tolerance : kTolerances_mm) {
      const ChartResult* best = fastestWithin(chart, scene, tolerance);
      stream << (best == nullptr ? std::string(" none |") : fmt::format(" {}, {:.3g} ms |", nameOf(best->what), best->frame_ms));
    }
    stream << '\n';
  }
  const std::vector<ChartScene> scenes = scenesIn(chart);
  if (std::any_of(scenes.begin(), scenes.end(), [&](ChartScene scene) { return choiceOf(chart, scene).chosen != nullptr; })) {
    stream << fmt::format(
        "\n## What method auto takes\n\nAt {:g} mm, and what it costs beside the best that meets it; 1.5 is allowed.\n\n"
        "| scene | auto | ms | meets it | best | ms | ratio | |\n|---|---|---|---|---|---|---|---|\n",
        1e3 * kAutoTolerance_m);
    for (const ChartScene scene : scenes) {
      const AutoChoice choice = choiceOf(chart, scene);
      if (choice.chosen == nullptr) continue;
      const bool other = choice.best != nullptr;
      stream << fmt::format("| {} | {} | {:.3g} | {} | {} | {} | {} | {} |\n", nameOf(scene), choice.chosen->note,
                            choice.chosen->frame_ms, choice.within ? "yes" : "no",
                            other ? nameOf(choice.best->what) : "none does",
                            other ? fmt::format("{:.3g}", choice.best->frame_ms) : "",
                            other ? fmt::format("{:.2f}", choice.ratio) : "", choice.passes ? "pass" : "**fail**");
    }
  }
  stream << "\n## Charts\n";
  for (const std::string& name : names) stream << fmt::format("\n![{0}]({0}.png) ([SVG]({0}.svg), [PDF]({0}.pdf))\n", name);
  stream << "\n## Where methods fail\n\n| scene | method | outcome | what happened |\n|---|---|---|---|\n";
  for (const ChartResult& result : chart.results) {
    if (result.outcome == ChartOutcome::right) continue;
    stream << fmt::format("| {} | {} | {} | {} |\n", nameOf(result.what.scene), nameOf(result.what), nameOf(result.outcome),
                          result.note);
  }
}

}  // namespace springtower
