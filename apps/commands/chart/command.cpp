#include "apps/commands/chart/command.h"

#include "apps/commands/chart/draw.h"
#include "apps/commands/chart/files.h"
#include "apps/commands/chart/maps.h"
#include "apps/commands/chart/maps_kept.h"
#include "apps/commands/chart/measure.h"
#include "apps/commands/chart/recorded_peers.h"
#include "apps/commands/chart/scene.h"
#include "apps/common/interruption.h"
#include "apps/common/options.h"
#include "apps/common/output_file.h"
#include "apps/common/peer_process.h"
#include "apps/common/progress.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/scene/scene.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>

namespace springtower {
namespace {

constexpr Range kChartRowsRange{2, 200, ""};
constexpr Range kSimulatedRange{0.2, 1000.0, "s"};
constexpr Range kCaseRange{0.01, 1e5, "s"};
constexpr Range kChartSamplesRange{1, 1000, ""};
constexpr double kUnlimited_s = 1e9;

constexpr std::string_view kChartExamples =
    R"help(scenes: uniform (equal blocks), heights (varying by 0.2 mm), pull (a block at 4 cm/s), drop (three rows from 2 cm), collapse
(it leans more than it can stand), spin (one block in flight), heavy-light (every other row ten times as heavy), shot (a block
flies into the tower at 5 m/s); by implicit steps, rigid-pgs, xpbd and other engines alone, for 2 s, with four times --case-limit:
wall (40 x 25 in running bond), pyramid (40 rows of cubes), heap-200 (200 blocks fall into a heap), rain-200 (they land within a
second), pile-3 (three rows of 108 land after 10 cm); not charted: holes (blocks missing), lean (9 degrees), tall (36 rows), slide
(over the floor), heap (eight fall askew), thrown (two meet)

Falls (collapse, shot, heap-200, rain-200, pile-3) are drawn with their largest depth from the first frame to the last, once with
the median of their frames and once with the worst but the first; else the mean of all frames counts. --quick leaves the last
three out unless they are named.

Each method is swept over its own parameter: a tolerance, or substeps of a frame. Accuracy is measured first, cases side by side;
then the speed, each case alone and by turns. A method that falls, diverges or times out is a result and is named on the chart.
A run that was broken off resumes where it was.

examples:
  springtower chart --quick --out quick              a look in less than a minute
  springtower chart --out figures --peers bench/data/peers/records.csv,bench/data/peers/stacks.csv,bench/data/peers/falls.csv
                                                     everything, in minutes
  springtower chart --maps --out maps                where each method is stable
  springtower chart --scenes uniform --methods implicit,rigid-pgs --seconds 60 --case-limit 600)help";

std::vector<ChartScene> scenesOf(const ChartCommand& command) {
  std::vector<ChartScene> scenes;
  if (command.scenes.empty()) {
    for (std::size_t i = 0; i < kChartSceneNames.size(); ++i) {
      const auto scene = static_cast<ChartScene>(i);
      const bool tooLong = command.quick && isFall(scene) && hasHundreds(scene);  // these have one size only
      if (isCharted(scene) != command.automatic && !tooLong) scenes.push_back(scene);
    }
    return scenes;
  }
  for (const std::string& name : command.scenes) {
    const auto* const found = std::find(kChartSceneNames.begin(), kChartSceneNames.end(), name);
    if (found == kChartSceneNames.end()) {
      throw InputError(fmt::format("--scenes: expected {}, got {}", fmt::join(kChartSceneNames, ", "), inQuotes(name)));
    }
    const auto scene = static_cast<ChartScene>(found - kChartSceneNames.begin());
    if (std::find(scenes.begin(), scenes.end(), scene) == scenes.end()) scenes.push_back(scene);
  }
  return scenes;
}

std::vector<Method> methodsOf(const ChartCommand& command) {
  std::vector<Method> methods;
  for (const std::string& name : command.methods) {
    if (name == nameOf(Peer::bullet) || name == nameOf(Peer::ode)) continue;
    const Method method = methodFromName(name, "--methods");
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
  }
  if (!command.methods.empty()) return methods;
  if (command.automatic) {
    return {Method::automatic,         Method::implicit, Method::implicitEuler,
            Method::semiImplicitEuler, Method::midpoint, Method::rungeKutta4,
            Method::rigidPgs,          Method::rigidLcp, Method::xpbd};
  }
  return {Method::implicit,    Method::implicitEuler, Method::implicitEigen, Method::semiImplicitEuler, Method::midpoint,
          Method::rungeKutta4, Method::report,        Method::rigidPgs,      Method::rigidLcp,          Method::xpbd};
}

// Those that are named must be there; without names, those that are not there are left out.
std::vector<Peer> peersOf(const ChartCommand& command) {
  std::vector<Peer> peers;
  for (const Peer peer : {Peer::bullet, Peer::ode}) {
    const std::vector<Peer> here = peersHere();
    const bool isHere = std::find(here.begin(), here.end(), peer) != here.end();
    const bool named = std::find(command.methods.begin(), command.methods.end(), nameOf(peer)) != command.methods.end();
    if (named && !isHere)
      throw InputError(fmt::format("--methods: expected the program peers_{0} beside this one for {0}, got none", nameOf(peer)));
    if (isHere && (named || (command.methods.empty() && !command.automatic))) peers.push_back(peer);
  }
  return peers;
}

ChartLimits limitsOf(const ChartCommand& command) {
  ChartLimits limits;
  if (command.quick) limits = {6, 1.0, 0.25, 2, 20, 0.02, 10, 6, 10};
  if (command.rows) limits.rows = static_cast<int>(*command.rows);
  if (command.seconds) limits.seconds = *command.seconds;
  if (command.case_s) limits.case_s = *command.case_s;
  if (command.samples) limits.samples = static_cast<int>(*command.samples);
  if (command.unlimited) {
    limits.case_s = kUnlimited_s;
    limits.sample_s = kUnlimited_s;
  }
  return limits;
}

void printChoice(const Chart& chart, ChartScene scene) {
  const AutoChoice choice = choiceOf(chart, scene);
  if (choice.chosen == nullptr) return;
  fmt::print("  auto {}, {:.3g} ms: {} {:g} mm", choice.chosen->note, choice.chosen->frame_ms,
             choice.within ? "meets" : "does not meet", 1e3 * kAutoTolerance_m);
  if (choice.best == nullptr) {
    fmt::print("; no other does\n");
    return;
  }
  fmt::print("; best {}, {:.3g} ms; ratio {:.2f}, {}\n", nameOf(choice.best->what), choice.best->frame_ms, choice.ratio,
             choice.passes ? "pass" : "fail");
}

// The plots of a folder, as SVG, PNG and PDF. Returns their names.
std::vector<std::string> writePlots(const std::string& folder, const std::vector<std::pair<std::string, Plot>>& plots) {
  std::vector<std::string> names;
  for (const auto& [name, plot] : plots) {
    writePlot(folder, name, plot);
    names.push_back(name);
  }
  return names;
}

// The table and the index, of what there is so far, and the charts of the scene that has been measured: those of the others are
// there. Returns the number of charts.
std::size_t writeAll(const std::string& folder, const Chart& chart, ChartScene measured) {
  writeOutputFile(folder, "chart.csv", [&](std::ostream& stream) { writeChartCsv(stream, chart); });
  std::string prefix = fmt::format("{}_", nameOf(measured));
  std::replace(prefix.begin(), prefix.end(), '-', '_');
  const std::vector<std::pair<std::string, Plot>> plots = chartPlots(chart);
  std::vector<std::string> names;
  names.reserve(plots.size());
  for (const auto& [name, plot] : plots) {
    if (name.starts_with(prefix)) writePlot(folder, name, plot);
    names.push_back(name);
  }
  writeOutputFile(folder, "index.md", [&](std::ostream& stream) { writeChartIndex(stream, chart, names); });
  return names.size();
}

void printScene(const Chart& chart, ChartScene scene) {
  fmt::print("{}\n  {:<30}{:>10}{:>10}{:>13}{:>13}{:>13}{:>13}{:>13}{:>13}{:>13}{:>13}  {}\n", nameOf(scene), "method",
             "ms/frame", "worst ms", "depth mm", "lower mm/row", "strain", "creep mm", "jitter mm/s", "imbalance", "energy",
             "error mm", "outcome");
  for (const ChartResult& result : chart.results) {
    if (result.what.scene != scene) continue;
    fmt::print("  {:<30}{:>10.3g}{:>10.3g}", nameOf(result.what), result.frame_ms, result.worst_ms);
    for (const double value : result.measured) fmt::print("{:>13.3g}", value);
    fmt::print("  {}{}{}\n", nameOf(result.outcome), result.note.empty() ? "" : ": ", result.note);
  }
}

Method mappedMethod(const std::string& name) {
  const std::vector<Method> mapped = mappedMethods();
  const auto found = std::find_if(mapped.begin(), mapped.end(), [&](Method method) { return isNameOf(name, method); });
  if (found != mapped.end()) return *found;
  std::vector<std::string_view> names;
  names.reserve(mapped.size());
  for (const Method method : mapped) names.push_back(nameOf(method));
  throw InputError(fmt::format("--methods: expected {} with --maps, got {}", fmt::join(names, ", "), inQuotes(name)));
}

// Rows of maps that are done, while others are not.
constexpr const char* kUnfinishedMaps = "maps.unfinished.json";

int executeMaps(const ChartCommand& command) {
  MapLimits limits;
  if (command.quick) limits = {{2, 8, 32, 128}, {5e-4, 1e-4}, {1, 3}, 0.25, 0.5};
  if (command.seconds) limits.seconds = *command.seconds;
  if (command.case_s) limits.case_s = *command.case_s;
  for (const std::string& name : command.methods) {
    const Method method = mappedMethod(name);
    if (std::find(limits.methods.begin(), limits.methods.end(), method) == limits.methods.end()) limits.methods.push_back(method);
  }
  makeOutputFolder(command.out);
  const Provenance provenance = provenanceNow();
  const std::string unfinished = (std::filesystem::path(command.out) / kUnfinishedMaps).string();
  std::vector<MapRow> kept;
  if (!command.fresh) kept = readKeptRows(unfinished, limits, provenance);
  std::vector<MapRow> done = kept;
  std::size_t count = 0;
  Progress progress(mapRows(limits), "rows of the maps");
  const std::vector<StabilityMap> maps = measureMaps(limits, kept, [&](const MapRow& row) {
    progress.update(static_cast<double>(++count), nameOf(row.method));
    if (std::any_of(done.begin(), done.end(), [&](const MapRow& other) { return isSame(other, row); })) return;
    done.push_back(row);
    writeOutputFile(command.out, kUnfinishedMaps, [&](std::ostream& stream) { writeKeptRows(stream, done, limits, provenance); });
  });
  progress.clear();
  writeOutputFile(command.out, "maps.csv", [&](std::ostream& stream) { writeMapsCsv(stream, maps, provenance); });
  const std::vector<std::string> names = writePlots(command.out, mapPlots(maps, provenance));
  writeOutputFile(command.out, "maps.md", [&](std::ostream& stream) { writeMapsIndex(stream, maps, names, provenance); });
  if (done.size() == count) std::filesystem::remove(unfinished);  // rows of a run of other methods stay for that
  fmt::print("{} maps (SVG, PNG and PDF), maps.csv and maps.md in {}\n", names.size(), onOneLine(command.out));
  return 0;
}

// Figures of other engines, from every file that is given. A file without any for these sizes is named.
void readAllPeers(const ChartCommand& command, const std::vector<Peer>& here, Chart& chart) {
  const bool bullet = std::find(here.begin(), here.end(), Peer::bullet) != here.end();
  for (const std::string& path : command.peers) {
    const std::vector<PeerResult> found = readPeers(path, chart.limits);
    chart.peers.insert(chart.peers.end(), found.begin(), found.end());
    if (found.empty()) {
      fmt::print("{}: no figures for {} rows, a wall of {}, a pyramid of {} or the falls of a chart, none are drawn\n",
                 onOneLine(path), chart.limits.rows, sizeText(ChartScene::wall, chart.limits),
                 sizeText(ChartScene::pyramid, chart.limits));
    } else if (!isDrawnAsRecorded(found.front().scene) && !bullet) {
      fmt::print("{}: not drawn, as they are carried over by their ratio to Bullet, which is not in this run\n", onOneLine(path));
    }
  }
}

// The cases of a scene. Throws Interrupted; chart.json says so then, where this run has written it (`isWritten`).
std::vector<ChartResult> measureScene(const ChartCommand& command, const std::vector<ChartCase>& cases, bool isWritten,
                                      Chart& chart, const std::function<void(const ChartCase&)>& progress) {
  try {
    return measureChart(cases, chart.limits, progress);
  } catch (const Interrupted&) {
    chart.interrupted = true;
    if (isWritten) writeOutputFile(command.out, "chart.json", [&](std::ostream& stream) { writeChartJson(stream, chart); });
    throw;
  }
}

}  // namespace

CLI::App* defineChart(CLI::App& program, ChartCommand& command) {
  CLI::App* chart = program.add_subcommand("chart", "draws speed against accuracy for every method");
  chart->add_option("--scenes", command.scenes, "what the blocks do (default all; see below)")
      ->delimiter(',')
      ->type_name("NAME,...");
  chart->add_option("--methods", command.methods, "as in `run`, or bullet and ode where their programs are (default all)")
      ->delimiter(',')
      ->type_name("NAME,...");
  addWholeNumber(*chart, "--rows", command.rows, kChartRowsRange, "rows of the towers (default 18)");
  addNumber(*chart, "--seconds", command.seconds, kSimulatedRange, "S",
            "simulated; the second half counts for rest (default 10)");
  addNumber(*chart, "--case-limit", command.case_s, kCaseRange, "S",
            "CPU time after which a case has timed out, twice that where blocks move, four times that for hundreds of "
            "blocks (default 3)");
  addWholeNumber(*chart, "--samples", command.samples, kChartSamplesRange,
                 "of each case's speed, interleaved with the others (default 5)");
  chart
      ->add_option("--peers", command.peers,
                   "figures of other engines, drawn with open symbols beside ours; see bench/data/peers")
      ->delimiter(',')
      ->type_name("FILE.csv,...");
  chart->add_option("--out", command.out, "writes into this folder (default chart)")->type_name("DIR");
  chart->add_flag("--quick", command.quick, "small towers, few cases and short samples: less than a minute");
  CLI::Option* unlimited =
      chart->add_flag("--no-time-limit", command.unlimited, "no case is broken off and every sample has all its frames: hours")
          ->excludes("--quick", "--case-limit");
  chart->add_flag("--auto", command.automatic,
                  "instead: what method auto takes in six scenes that are not charted, and its cost beside the best's");
  CLI::Option* noResume =
      chart->add_flag("--no-resume", command.fresh, "measures everything again, also what an earlier run has left in the folder");
  chart
      ->add_flag("--maps", command.maps,
                 "instead: where each method is stable, over step and stiffness and over step and rows; every method but "
                 "implicit-eigen, or --methods; --seconds (default 1) and --case-limit (default 5) as above")
      ->excludes("--auto", "--no-time-limit", "--scenes", "--rows", "--samples", "--peers");
  addFormerFlag(*chart, "--long", unlimited, command.unlimited);
  addFormerFlag(*chart, "--fresh", noResume, command.fresh);
  wrapDescriptions(*chart);
  chart->footer(std::string(kChartExamples));
  return chart;
}

int executeChart(const ChartCommand& command) {
  if (command.maps) return executeMaps(command);
  const std::vector<ChartScene> scenes = scenesOf(command);
  const std::vector<Method> methods = methodsOf(command);
  const std::vector<Peer> peers = peersOf(command);
  Chart chart;
  chart.provenance = provenanceNow();
  chart.limits = limitsOf(command);
  readAllPeers(command, peers, chart);
  makeOutputFolder(command.out);
  const std::string resume = (std::filesystem::path(command.out) / "chart.json").string();
  // What an earlier run has measured stays, and so do scenes that this one does not measure.
  if (!command.fresh) chart.results = readChartJson(resume, chart);

  // A scene is taken over from an earlier run only as a whole, as its cases were timed by turns.
  const auto known = [&](const ChartCase& what) {
    return std::any_of(chart.results.begin(), chart.results.end(),
                       [&](const ChartResult& result) { return result.what == what; });
  };
  std::vector<std::vector<ChartCase>> work;
  int steps = 0;
  for (const ChartScene scene : scenes) {
    work.push_back(casesOf(scene, methods, peers, command.quick));
    steps += static_cast<int>(work.back().size()) * (1 + chart.limits.samples);
  }
  int done = 0;
  std::size_t charts = 0;
  bool isWritten = false;
  Progress progress(steps, "steps");
  for (const std::vector<ChartCase>& cases : work) {
    if (std::all_of(cases.begin(), cases.end(), known)) {
      done += static_cast<int>(cases.size()) * (1 + chart.limits.samples);
    } else {
      const std::vector<ChartResult> results = measureScene(command, cases, isWritten, chart, [&](const ChartCase& now) {
        progress.update(++done, fmt::format("{}, {}", nameOf(now.scene), nameOf(now)));
      });
      std::erase_if(chart.results,
                    [&](const ChartResult& old) { return std::find(cases.begin(), cases.end(), old.what) != cases.end(); });
      chart.results.insert(chart.results.end(), results.begin(), results.end());
      writeOutputFile(command.out, "chart.json", [&](std::ostream& stream) { writeChartJson(stream, chart); });
      isWritten = true;
    }
    progress.clear();
    if (cases.empty()) continue;
    printScene(chart, cases.front().scene);
    printChoice(chart, cases.front().scene);
    std::fflush(stdout);
    charts = writeAll(command.out, chart, cases.front().scene);
  }
  fmt::print("{} cases, {} charts (SVG, PNG and PDF), chart.csv, chart.json and index.md in {}\n", chart.results.size(), charts,
             onOneLine(command.out));
  return 0;
}

}  // namespace springtower
