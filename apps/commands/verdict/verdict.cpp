#include "apps/commands/verdict/verdict.h"

#include "apps/commands/verdict/json.h"
#include "apps/common/interruption.h"
#include "apps/common/json_values.h"
#include "apps/common/line_jobs.h"
#include "apps/common/line_reader.h"
#include "apps/common/program.h"
#include "core/error.h"
#include "solver/runner/run.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/global_control.h>
#include <set>
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
  A line is printed as soon as it and all before it are done. A bad line ends the program when those before it are printed.
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

// What is known of a line in the end, when its scene is gone.
struct JudgedLine {
  std::size_t number = 0;
  std::string id;
  std::optional<bool> expected;  // where that is clear
  bool done = false;
  bool stands = false;
  std::string divergence;
};

Verdict judge(const VerdictLine& line, double seconds, const std::string& where) {
  RunOptions options;
  options.seconds = seconds;
  options.stopWhenFallen = true;
  options.stopWhenAtRest = true;
  options.secondsAfterRest = kVerdictWatch_s;
  options.shouldStop = interrupted;
  Verdict verdict;
  std::optional<Simulation> simulation;
  try {
    simulation.emplace(line.scene);
    verdict.result = runScene(*simulation, options);
    endIfInterrupted();
    verdict.time_s = verdict.result.standing.stands ? verdict.result.restTime_s : verdict.result.fallTime_s;
  } catch (const DivergenceError& error) {
    if (simulation) verdict.result.counters = simulation->counters;
    verdict.time_s = error.time_s;
    verdict.divergence = error.what();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", where, error.what()));
  }
  return verdict;
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
bool printVerdictAgreement(const std::deque<JudgedLine>& lines) {
  struct Agreement {
    std::size_t clear = 0;
    std::size_t agree = 0;
  };
  Agreement stands;
  Agreement falls;
  std::string differing;
  for (const JudgedLine& line : lines) {
    if (!line.done || !line.expected) continue;
    const bool expected = *line.expected;
    Agreement& count = expected ? stands : falls;
    ++count.clear;
    const bool diverged = !line.divergence.empty();
    if (!diverged && line.stands == expected) {
      ++count.agree;
      continue;
    }
    differing += fmt::format("  line {}: {} {}, expected that it {}\n", line.number, onOneLine(line.id),
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
  verdict->add_flag("--keep-going", command.keepGoing,
                    "reports a bad line on standard error, leaves it out and goes on; exit code 2 at the end");
  wrapDescriptions(*verdict);
  verdict->footer(std::string(kVerdictExamples));
  return verdict;
}

int executeVerdict(const VerdictCommand& command) {
  LineReader input(command.file);
  const int threads = threadCount(command.physics);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const double seconds = command.seconds.value_or(kVerdictSeconds);
  std::set<std::string> ids;
  std::deque<JudgedLine> judged;  // places in it stay
  const LineCounts counts =
      workOffLines(input, threads, command.keepGoing, [&](const std::string& text, std::size_t number, const std::string& where) {
        if (isBlankLine(text)) return LineJob{};
        VerdictLine line = readVerdictLine(text, number, where, ids);
        applyPhysicsOptions(command.physics, line.scene.settings);
        JudgedLine& known = judged.emplace_back();
        known.number = number;
        known.id = line.id;
        if (isClear(line)) known.expected = line.expect.at("stands").get<bool>();
        return LineJob([line = std::move(line), where, seconds, &known] {
          const Verdict verdict = judge(line, seconds, where);
          known.stands = verdict.result.standing.stands;
          known.divergence = verdict.divergence;
          known.done = true;
          return verdictJson(line, verdict).dump() + '\n';
        });
      });
  int exitCode = 0;
  if (counts.lines == 0 && !counts.interrupted && !command.check)  // what should have written the list may have failed
    complain("springtower", fmt::format("{}: expected at least one line, got none", input.source()));
  const bool anyClear =
      std::any_of(judged.begin(), judged.end(), [](const JudgedLine& line) { return line.expected.has_value(); });
  if (command.check && !anyClear && !counts.interrupted) {
    throw InputError("--check: expected at least one line with a clear expectation, got none");
  }
  if (command.check && !printVerdictAgreement(judged)) exitCode = 1;
  for (const JudgedLine& line : judged) {
    if (line.divergence.empty()) continue;
    complain("springtower", fmt::format("line {}, {}: {}", line.number, line.id, line.divergence));
    exitCode = kDiverged;
  }
  return exitCodeOf(counts, exitCode);
}

}  // namespace springtower
