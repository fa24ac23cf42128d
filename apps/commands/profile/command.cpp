#include "apps/commands/profile/command.h"

#include "apps/commands/profile/cases.h"
#include "apps/commands/profile/charts.h"
#include "apps/commands/profile/falls.h"
#include "apps/commands/profile/files.h"
#include "apps/commands/profile/measure.h"
#include "apps/commands/profile/report_figures.h"
#include "apps/commands/profile/scene.h"
#include "apps/commands/profile/stacks.h"
#include "apps/common/interruption.h"
#include "apps/common/options.h"
#include "apps/common/output_file.h"
#include "apps/common/program.h"
#include "apps/common/progress.h"
#include "core/error.h"
#include "core/limits.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <memory>
#include <system_error>

namespace springtower {
namespace {

constexpr Range kProfileSamplesRange{1, 1000, ""};
constexpr Range kFramesRange{2, 100000, ""};
constexpr Range kLimitRange{0.0, 1e6, "s"};
constexpr const char* kUnfinishedProfile = "profile.unfinished.json";

constexpr std::string_view kProfileExamples =
    R"help(what is timed: the state is kept once the scene has settled; each sample restores it, runs one frame untimed, restores it again
and times all frames from there; samples of all cases of a scene are interleaved. The frames of every sample are the same, so
each frame counts with its minimum over the samples, then their median, 99th percentile and largest. On one thread that is CPU
time, else wall time.

An interrupted run with --out resumes where it was.

scenes: rest (settled, awake), sway (gravity sways by 0.1 degree), heights (varying by 0.2 mm), pull (a block at 4 cm/s, all
awake), pull-sleep (the same with sleep), game (a recorded game on 18 rows, whole, as the viewer plays it, with sleep: a hand
that hesitates draws out two blocks, lifts them and lays them on top; with a third the tower falls), collapse (gravity tilted by
14.5 degrees; fewer than 18 rows by a little more than they stand at, 30 at most), asleep, towers (many of 18 rows,
awake), pile (a connected stack of 108 blocks a row, dropped from 10 cm: its first frames on the floor), walls (running bond,
half blocks at the ends), pyramids (cubes of 20 mm; bricks laid across), starts (towers: equal, uneven, under gravity tilted by
half of what tips them over, many); of these three: the search for the equilibrium, depth, creep, what is required of some,
Bullet with the steps that come nearest in depth, and the growth of cost with blocks; on one thread and two; some 2 minutes
falls, each timed whole, awake, on one thread and two, with depth, energy, memory, what is required, and Bullet beside: topple
(towers under gravity tilted by 14.5 degrees), hit (a block at 5 m/s), heaps, piles, rain; some 20 minutes

examples:
  springtower profile --quick                                     a look at rest and collapse in a few seconds
  springtower profile --out figures                               all default cases, with charts, CSV and JSON
  springtower profile --rows 18 --scenes rest --tolerances 1e-5 --threads 1,2
  springtower profile --rows 46 --scenes pile --tolerances 2e-4 --threads 1,2 --samples 1    some 5000 blocks; minutes
  springtower profile --scenes walls,pyramids --quick             a look at their table in seconds
  springtower profile --scenes starts --peer-limit 0              how long towers take until their first frame
  springtower profile --stacks wall:20x12,cubes:60 --peer-limit 0 these alone, without Bullet
  springtower profile --scenes topple,hit,heaps,piles,rain        the table of what moves in large numbers
  springtower profile --falls heap:100,shot:18 --threads 1        these alone, on one thread
  springtower profile --scenes game --trace game.json             its median, 99th percentile and worst frame, and each frame
  springtower profile --rows 18 --scenes pull --frames 60 --trace pull.json   then open pull.json at ui.perfetto.dev
  springtower profile --from figures/profile.json --out figures   draws the charts again without timing anything)help";

std::string sizeOf(const ProfileCase& what) {
  if (isNamed(what.scene)) return what.named.substr(what.named.find(':') + 1);
  return what.scene == ProfileScene::towers ? fmt::format("{}x{}", what.towers, what.rows) : fmt::format("{}", what.rows);
}

// What the blocks do, or the family of what has a name and a size.
std::string_view kindOf(const ProfileCase& what) {
  if (isFall(what.scene)) return fallFamilyOf(what.named).name;
  return isStack(what.scene) ? familyOf(what.named).name : nameOf(what.scene);
}

// A frame shows 1/60 s: whether it takes less.
std::string remarkOn(const ProfileResult& result) {
  const std::string pace = result.framesPerSecond() * Settings{}.frame_s >= 1.0 ? "real time" : "slower";
  return result.stands || isFall(result.what.scene) ? pace : pace + ", fallen";
}

void printTable(const Profile& profile) {
  fmt::print("{}\n\n", footnote(profile.provenance));
  fmt::print("{:<11}{:>7}{:>7} {:<22}{:>9}{:>8}{:>9}{:>10}{:>10}{:>10}{:>11}{:>10}{:>9}{:>11}  {}\n", "scene", "rows", "blocks",
             "method", "tol. mm", "threads", "steps", "ms median", "p99", "max", "frames/s", "us/block", "kN/m", "depth mm", "");
  for (const ProfileResult& result : profile.results) {
    fmt::print("{:<11}{:>7}{:>7} {:<22}{:>9.3g}{:>8}", kindOf(result.what), sizeOf(result.what), result.blocks, result.methodName,
               1e3 * result.what.tolerance_m, result.what.threads);
    if (!result.failure.empty()) {
      fmt::print("  {}\n", result.failure);
      continue;
    }
    const FrameCost& cost = result.cost();
    fmt::print("{:>9.4g}{:>10.4g}{:>10.4g}{:>10.4g}{:>11.4g}{:>10.3g}{:>9.4g}{:>11.3g}  {}\n", result.substeps, cost.median,
               cost.p99, cost.max, result.framesPerSecond(), 1e3 * cost.median / static_cast<double>(result.blocks),
               1e-3 * result.stiffness_n_m, result.penetration_mm, remarkOn(result));
  }
  fmt::print("\nms a frame in each stage, mean, summed over threads\n{:<11}{:>7} {:<22}{:>9}{:>8}", "scene", "rows", "method",
             "tol. mm", "threads");
  for (const std::string_view name : kStageNames) fmt::print("{:>18}", name);
  fmt::print("\n");
  for (const ProfileResult& result : profile.results) {
    if (!result.failure.empty()) continue;
    fmt::print("{:<11}{:>7} {:<22}{:>9.3g}{:>8}", kindOf(result.what), sizeOf(result.what), result.methodName,
               1e3 * result.what.tolerance_m, result.what.threads);
    for (const double value : result.stage_ms) fmt::print("{:>18.4g}", value);
    fmt::print("\n");
  }
  fmt::print(
      "\nbytes a block: state, contacts, all with springs and working space; a near pair; what a touching pair adds, and\n"
      "adds for steps and rollbacks\n");
  for (const ProfileResult& result : profile.results) {
    if (!result.failure.empty() || result.what.threads != profile.results.front().what.threads) continue;
    fmt::print("{:<11}{:>7} {:<22}{:>9.3g}{:>9.0f}{:>9.0f}{:>9.0f}{:>9.0f}{:>9.0f}{:>9.0f}\n", kindOf(result.what),
               sizeOf(result.what), result.methodName, 1e3 * result.what.tolerance_m, result.stateBytes, result.contactBytes,
               result.allBytes, result.pairBytes, result.touchingBytes, result.touchingStepBytes);
  }
}

void writeFolder(const std::string& folder, const Profile& profile, bool measured) {
  if (measured) writeOutputFile(folder, "profile.json", [&](std::ostream& stream) { writeProfileJson(stream, profile); });
  writeOutputFile(folder, "profile.csv", [&](std::ostream& stream) { writeProfileCsv(stream, profile); });
  writeOutputFile(folder, "culling.csv", [&](std::ostream& stream) { writeCulling(stream, profile); });
  const auto any = [&](bool (*isOne)(ProfileScene)) {
    return std::any_of(profile.results.begin(), profile.results.end(),
                       [&](const ProfileResult& result) { return isOne(result.what.scene); });
  };
  const bool stacks = any(isStack);
  const bool falls = any(isFall);
  if (falls) writeOutputFile(folder, "falls.csv", [&](std::ostream& stream) { writeFallsCsv(stream, profile); });
  if (stacks) writeOutputFile(folder, "stacks.csv", [&](std::ostream& stream) { writeStacksCsv(stream, profile); });
  const std::vector<NamedPlot> charts = profileCharts(profile);
  for (const NamedPlot& chart : charts) writePlot(folder, chart.first, chart.second);
  fmt::print("\n{} charts (SVG, PNG and PDF), profile.csv, culling.csv{}{}{} in {}\n", charts.size(),
             stacks ? ", stacks.csv" : "", falls ? ", falls.csv" : "", measured ? ", profile.json" : "", onOneLine(folder));
}

// The results that a run that was broken off has left in the folder.
std::vector<ProfileResult> keptResults(const ProfileCommand& command, const Profile& now) {
  if (!command.out || command.noResume) return {};
  const std::filesystem::path path = std::filesystem::path(*command.out) / kUnfinishedProfile;
  if (!std::filesystem::exists(path)) return {};
  Profile then = readProfileJson(path.string());
  checkCommitted(then.provenance, now.provenance, onOneLine(path.string()));
  if (!sameOrigin(then.provenance, now.provenance) || !(then.limits == now.limits)) {
    throw InputError(
        fmt::format("{}: expected figures of this run, or --no-resume, got those of another build, machine or limits",
                    onOneLine(path.string())));
  }
  return std::move(then.results);
}

// Measures scene by scene, and puts into the profile what is known of the cases after each. A scene is taken over from a run that
// was broken off only as a whole, as its cases were timed by turns, and not into a trace, which is of one run. Returns whether
// such a run has left cases that are none of these.
bool measureAll(const ProfileCommand& command, const std::vector<ProfileCase>& cases, Profile& profile,
                std::vector<TracedCase>* traced) {
  const auto begun = std::chrono::steady_clock::now();
  Profile kept{profile.provenance, profile.limits, keptResults(command, profile)};
  const auto known = [&](const ProfileCase& what) {
    return std::find_if(kept.results.begin(), kept.results.end(), [&](const ProfileResult& old) { return old.what == what; });
  };
  const int stepsOfCase = 2 + profile.limits.samples;
  Progress progress(static_cast<double>(cases.size()) * stepsOfCase, "steps");
  for (auto first = cases.begin(); first != cases.end();) {
    const auto last = std::find_if(first, cases.end(), [&](const ProfileCase& what) { return what.scene != first->scene; });
    const std::vector<ProfileCase> group(first, last);
    if (traced != nullptr ||
        !std::all_of(first, last, [&](const ProfileCase& what) { return known(what) != kept.results.end(); })) {
      const auto before = static_cast<int>(first - cases.begin()) * stepsOfCase;
      const std::vector<ProfileResult> results =
          measureProfile(group, profile.limits, begun, traced, [&](int done, int, const ProfileCase& next) {
            endIfInterrupted();
            progress.update(before + done, fmt::format("{}, {}{}, {}", kindOf(next), sizeOf(next),
                                                       isNamed(next.scene) ? "" : " rows", nameOf(next.method)));
          });
      std::erase_if(kept.results, [&](const ProfileResult& old) { return std::find(first, last, old.what) != last; });
      kept.results.insert(kept.results.end(), results.begin(), results.end());
      if (command.out)
        writeOutputFile(*command.out, kUnfinishedProfile, [&](std::ostream& stream) { writeProfileJson(stream, kept); });
    }
    for (const ProfileCase& what : group) profile.results.push_back(*known(what));
    first = last;
  }
  return std::any_of(kept.results.begin(), kept.results.end(),
                     [&](const ProfileResult& old) { return std::find(cases.begin(), cases.end(), old.what) == cases.end(); });
}

}  // namespace

CLI::App* defineProfile(CLI::App& program, ProfileCommand& command) {
  CLI::App* profile =
      program.add_subcommand("profile", "times frames of towers, walls, pyramids and falls of many sizes and draws charts");
  const auto list = [&](const std::string& name, std::vector<std::string>& target, const std::string& type,
                        const std::string& description) {
    profile->add_option(name, target, description)->delimiter(',')->type_name(type);
  };
  list("--rows", command.rows, "N,N,...", "rows of the tower (default 3,6,9,12,18,24,36,54,72)");
  list("--scenes", command.scenes, "NAME,...", "what the blocks do (default rest,pull,game,collapse,asleep,towers; see below)");
  list("--methods", command.methods, "NAME,...", "as in `run` (default: its default; at rest also report, for comparison)");
  list("--tolerances", command.tolerances_m, "METRES,...", "as in `run` (default 5e-05; of `game` as it was played)");
  list("--threads", command.threads, "N,N,...", "threads to use (default 1; for --stacks and --falls 1,2)");
  list("--towers", command.towers, "N,N,...", "how many towers scene `towers` has (default 1,4,16,64)");
  list("--stacks", command.stacks, "NAME:SIZE,...",
       "what to time in scenes `walls`, `pyramids` and `starts`, which it implies: wall:COLUMNSxCOURSES, cubes:ROWS, "
       "bricks:ROWS, tower:ROWS, uneven:ROWS, tilted:ROWS, uneven-tilted:ROWS, tilted-towers:TOWERS (default those with a "
       "requirement, 54 to 5050 blocks)");
  list("--falls", command.falls, "NAME:SIZE,...",
       "what to time in scenes `topple`, `hit`, `heaps`, `piles` and `rain`, which it implies: topple:ROWS, towers:TOWERS, "
       "shot:ROWS, heap:BLOCKS, pile:ROWS, rain:BLOCKS (default those with a requirement, 54 to 3456 blocks)");
  profile->add_option("--inertia", command.inertia, "cuboid (default) or lumped")->type_name("NAME");
  addWholeNumber(*profile, "--samples", command.samples, kProfileSamplesRange,
                 "of each case, interleaved with the others (default 5)");
  addWholeNumber(*profile, "--frames", command.frames, kFramesRange, "timed in a sample (default 120)");
  addNumber(*profile, "--settle", command.settle_s, kLimitRange, "S", "simulated before timing (default 5)");
  addNumber(*profile, "--prepare-limit", command.prepare_s, kLimitRange, "S",
            "wall time after which a scene has settled enough, and as much again for a pull to begin (default 10)");
  addNumber(*profile, "--sample-limit", command.sample_s, kLimitRange, "S",
            "wall time after which a sample ends, with fewer frames (default 1)");
  addNumber(*profile, "--peer-limit", command.peer_s, kLimitRange, "S",
            "CPU time that Bullet may take for a wall, a pyramid or a fall, where its program is (default 4; 0: it is left out)");
  CLI::Option* full = profile->add_flag(
      "--full", command.full, "with the largest walls, pyramids and piles (100,012 blocks), and more time for Bullet; minutes");
  profile->add_flag("--quick", command.quick, "fewer cases, shorter samples: seconds instead of minutes")->excludes(full);
  CLI::Option* noResume = profile->add_flag("--no-resume", command.noResume,
                                            "times everything again, also what a run that was broken off has left in the folder");
  addFormerFlag(*profile, "--fresh", noResume, command.noResume);
  profile->add_option("--out", command.out, "writes CSV, JSON and the charts into this folder")->type_name("DIR");
  profile->add_option("--trace", command.trace, "writes the frames of the last samples for Perfetto or chrome://tracing")
      ->type_name("FILE.json");
  profile->add_option("--from", command.from, "draws the charts of an earlier profile.json; nothing is timed")
      ->type_name("FILE.json")
      ->needs("--out")
      ->excludes("--trace");
  wrapDescriptions(*profile);
  profile->footer(std::string(kProfileExamples));
  return profile;
}

int executeProfile(const ProfileCommand& command) {
  if (command.from) {
    const Profile profile = readProfileJson(*command.from);
    makeOutputFolder(*command.out);
    printTable(profile);
    printStacks(profile);
    printFalls(profile);
    writeFolder(*command.out, profile, false);
    return 0;
  }
  const std::vector<ProfileCase> cases = casesOf(command);
  for (const ProfileCase& what : cases) checkScene(sceneOf(what), "profile");
  if (command.out) makeOutputFolder(*command.out);
  const auto traceFile = command.trace ? std::make_unique<OutputFile>(*command.trace, "--trace") : nullptr;

  Profile profile;
  profile.provenance = provenanceNow();
  profile.limits = limitsOf(command);
  std::vector<TracedCase> traced;
  bool othersKept = false;
  try {
    othersKept = measureAll(command, cases, profile, traceFile ? &traced : nullptr);
  } catch (const Interrupted&) {
    if (!profile.results.empty()) printTable(profile);
    complain("springtower", fmt::format("interrupted; {} of {} cases are timed{}", profile.results.size(), cases.size(),
                                        command.out ? fmt::format(" and kept in {}/{}", *command.out, kUnfinishedProfile) : ""));
    throw;
  }
  printTable(profile);
  printCulling(profile);
  printStacks(profile);
  printFalls(profile);
  if (command.out) {
    writeFolder(*command.out, profile, true);
    std::error_code ignored;
    // Cases of a run of others stay for that.
    if (!othersKept) std::filesystem::remove(std::filesystem::path(*command.out) / kUnfinishedProfile, ignored);
  }
  if (traceFile) {
    writeTrace(traceFile->stream(), profile.provenance, traced);
    traceFile->commit();
  }
  return 0;
}

}  // namespace springtower
