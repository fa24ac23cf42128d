#include "apps/commands/verdict/verdict.h"

#include "apps/common/json_values.h"
#include "apps/common/progress.h"
#include "core/error.h"
#include "solver/runner/run.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <string_view>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kVerdictSeconds = 10.0;
// A scene at rest is watched a little longer, so that creep means something and a rest that was none is seen.
constexpr double kVerdictWatch_s = 0.5;

constexpr std::string_view kVerdictExamples = R"help(a line of the input:
  {"id": "a", "config": "(010)-(010)-(011)", "mu": 0.4, "gravity_tilt_deg": 5, "gravity_direction_deg": 90,
   "offsets_m": [{"row": 1, "position": 2, "dx": 0.002, "dy": 0}], "lower_m": [{"row": 0, "position": 2, "by": 0.0003}]}
  id and config are needed; rows count from 0, positions from 1; expect is carried along: {"stands": true, "clear": true}
a line of the output:
  {"id": "a", "stands": false, "time_s": 0.0333, "steps": 77, "max_penetration_mm": null, "creep_mm": null, "expect": ...}
  time_s                        when it had fallen or was at rest, null if neither came
  steps                         how many were taken
  max_penetration_mm, creep_mm  the largest since it was at rest, or since 5 s; null if it ended before
  diverged                      only where the simulation diverged, says how: stands is null, time_s is when that was,
                                steps are those of the whole frames until then
examples:
  springtower verdict towers.jsonl > verdicts.jsonl
  echo '{"id": "a", "config": "(010)-(100)"}' | springtower verdict -
  springtower verdict towers.jsonl --check > verdicts.jsonl   agreement with expect where it is clear, exit code 1 if any differs)help";

// What came of one line.
struct Verdict {
  RunResult result;
  std::optional<double> time_s;  // when it had fallen, was at rest or diverged
  std::string divergence;        // empty unless the scene diverged
};

Verdict judge(const VerdictLine& line, double seconds) {
  RunOptions options;
  options.seconds = seconds;
  options.stopWhenFallen = true;
  options.stopWhenAtRest = true;
  options.secondsAfterRest = kVerdictWatch_s;
  Verdict verdict;
  std::optional<Simulation> simulation;
  try {
    simulation.emplace(line.scene);
    verdict.result = runScene(*simulation, options);
    verdict.time_s = verdict.result.standing.stands ? verdict.result.restTime_s : verdict.result.fallTime_s;
  } catch (const DivergenceError& error) {
    if (simulation) verdict.result.counters = simulation->counters;
    verdict.time_s = error.time_s;
    verdict.divergence = error.what();
  } catch (const InputError& error) {
    throw InputError(fmt::format("line {}: {}", line.number, error.what()));
  }
  return verdict;
}

std::vector<Verdict> judgeAll(const std::vector<VerdictLine>& lines, double seconds) {
  std::vector<Verdict> verdicts(lines.size());
  Progress progress(static_cast<double>(lines.size()), "scenes");
  std::size_t done = 0;
  std::mutex progressMutex;
  tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t i) {
    // Isolated, so that a thread waiting inside one scene does not start another on top of it.
    tbb::this_task_arena::isolate([&] { verdicts[i] = judge(lines[i], seconds); });
    const std::lock_guard lock(progressMutex);
    progress.update(static_cast<double>(++done));
  });
  return verdicts;
}

Json verdictJson(const VerdictLine& line, const Verdict& verdict) {
  const RunResult& result = verdict.result;
  const bool diverged = !verdict.divergence.empty();
  const auto orNull = [](const std::optional<double>& number, double unit = 1.0) {
    return number ? Json(unit * *number) : Json(nullptr);
  };
  Json json;
  json["id"] = line.id;
  json["stands"] = diverged ? Json(nullptr) : Json(result.standing.stands);
  json["time_s"] = orNull(verdict.time_s);
  json["steps"] = result.counters.steps;
  json["max_penetration_mm"] = orNull(result.maxPenetration_m, kMillimetres);
  json["creep_mm"] = orNull(result.creep_m, kMillimetres);
  if (diverged) json["diverged"] = verdict.divergence;
  if (!line.expect.is_null()) json["expect"] = line.expect;
  return json;
}

// Prints how many clear lines agree; returns whether all do.
bool printVerdictAgreement(const std::vector<VerdictLine>& lines, const std::vector<Verdict>& verdicts) {
  struct Count {
    std::size_t clear = 0;
    std::size_t agree = 0;
  };
  Count stands;
  Count falls;
  std::string differing;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!isClear(lines[i])) continue;
    const bool expected = lines[i].expect.at("stands").get<bool>();
    Count& count = expected ? stands : falls;
    ++count.clear;
    const bool diverged = !verdicts[i].divergence.empty();
    if (!diverged && verdicts[i].result.standing.stands == expected) {
      ++count.agree;
      continue;
    }
    differing += fmt::format("  line {}: {} {}, expected that it {}\n", lines[i].number, onOneLine(lines[i].id),
                             diverged   ? "diverged"
                             : expected ? "falls"
                                        : "stands",
                             expected ? "stands" : "falls");
  }
  fmt::print(stderr, "  expected    clear    agree   differ\n");
  for (const auto& [name, count] : {std::pair{"stands", stands}, std::pair{"falls", falls}}) {
    fmt::print(stderr, "  {:<8}{:>9}{:>9}{:>9}\n", name, count.clear, count.agree, count.clear - count.agree);
  }
  fmt::print(stderr, "{}", differing);
  return differing.empty();
}

std::vector<VerdictLine> readVerdictFile(const std::string& file) {
  if (file == "-") return readVerdictLines(std::cin, "standard input");
  std::ifstream stream(file);
  if (!stream) throw InputError(fmt::format("{}: cannot be read", onOneLine(file)));
  return readVerdictLines(stream, onOneLine(file));
}

}  // namespace

CLI::App* defineVerdict(CLI::App& program, VerdictCommand& command) {
  CLI::App* verdict = program.add_subcommand("verdict", "says for each tower of a list whether it stands");
  verdict->add_option("FILE", command.file, "a JSON object a line; - for standard input")->type_name("")->required();
  addNumber(*verdict, "--seconds", command.seconds, kSecondsRange, "S",
            "longest simulated time (default 10); a scene ends when it has fallen or is at rest");
  addPhysicsOptions(*verdict, command.physics);
  verdict->add_flag(
      "--check", command.check,
      "prints on standard error how many verdicts agree with expect where that is clear; exit code 1 if one differs");
  wrapDescriptions(*verdict);
  verdict->footer(std::string(kVerdictExamples));
  return verdict;
}

int executeVerdict(const VerdictCommand& command) {
  std::vector<VerdictLine> lines = readVerdictFile(command.file);
  for (VerdictLine& line : lines) applyPhysicsOptions(command.physics, line.scene.settings);
  if (command.check && std::none_of(lines.begin(), lines.end(), isClear)) {
    throw InputError("--check: found no line with a clear expectation, allowed is at least one");
  }
  const auto threads = static_cast<std::size_t>(threadCount(command.physics));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  const std::vector<Verdict> verdicts = judgeAll(lines, command.seconds.value_or(kVerdictSeconds));

  std::string output;
  for (std::size_t i = 0; i < lines.size(); ++i) output += verdictJson(lines[i], verdicts[i]).dump() + '\n';
  std::cout << output << std::flush;
  int exitCode = 0;
  if (command.check && !printVerdictAgreement(lines, verdicts)) exitCode = 1;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (verdicts[i].divergence.empty()) continue;
    fmt::print(stderr, "springtower: line {}, {}: {}\n", lines[i].number, onOneLine(lines[i].id), verdicts[i].divergence);
    exitCode = 3;
  }
  return exitCode;
}

}  // namespace springtower
