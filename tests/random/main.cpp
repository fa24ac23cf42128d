// Random scenes, judged by what must hold in every one of them (tests/random/judge.h). docs/random-scenes.md says more.
#include "apps/common/arguments.h"
#include "apps/common/interruption.h"
#include "apps/common/json_values.h"
#include "apps/common/options.h"
#include "apps/common/program.h"
#include "apps/common/progress.h"
#include "core/error.h"
#include "core/output_file.h"
#include "core/version.h"
#include "tests/random/bounds.h"
#include "tests/random/children.h"
#include "tests/random/scene_text.h"
#include "tests/random/shrink.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace springtower {
namespace {

constexpr int kBeyondBounds = 1;
constexpr Range kCountRange{1.0, 1e7, ""};
constexpr Range kMinutesRange{1e-3, 1e5, "minutes"};
constexpr Range kLimitRange{0.01, 3600.0, "s"};
constexpr Range kJobsRange{1.0, 1024.0, ""};
constexpr int kMostJudgedInShrinking = 300;

constexpr const char* kFooter =
    "examples:\n"
    "  random_scenes --from 1 --count 300 --limit 1          the seeds 1 to 300\n"
    "  random_scenes --from 1 --count 100000 --minutes 60 --json found.json\n"
    "  random_scenes --write 17 seed17.toml                  one of them as a scene for springtower run\n"
    "  random_scenes --file seed17.toml                      judges a scene file\n"
    "  random_scenes --from 1 --count 100 --shrink DIR --fault diverged\n"
    "exit codes: 0 within the bounds (--file: without faults), 1 beyond them, 2 bad input or arguments, 130 or 143 ended by a "
    "signal\n"
    "(the table is of what was judged by then)";

struct Options {
  std::optional<std::int64_t> from;
  std::optional<std::int64_t> count;
  std::optional<double> minutes;
  std::optional<std::int64_t> jobs;
  std::optional<double> limit_s;
  std::optional<std::string> json;
  std::vector<std::string> write;  // seed and file
  std::optional<std::string> file;
  std::optional<std::string> shrink;
  std::optional<std::string> fault;
  bool withProgram = false;
  bool ignoreTimes = false;
};

using Clock = std::chrono::steady_clock;

double minutesSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count() / 60.0;
}

void defineOptions(CLI::App& program, Options& options) {
  program.set_help_flag("-h,--help", "prints this help");
  addWholeNumber(program, "--from", options.from, kSeedRange, "first seed (default 1)");
  addWholeNumber(program, "--count", options.count, kCountRange, "how many seeds, one after the other (default 300)");
  addNumber(program, "--minutes", options.minutes, kMinutesRange, "M",
            "begins no other scene after that time; shrinking may take a fifth of it more");
  addWholeNumber(program, "--jobs", options.jobs, kJobsRange, "scenes at once (default: one a processor)");
  addNumber(program, "--limit", options.limit_s, kLimitRange, "S",
            "processor time of a scene's first run, s (default 1); it then ends with the frame");
  program.add_option("--json", options.json, "writes all records")->type_name("FILE");
  program.add_option("--write", options.write, "writes the scene of a seed")->type_name("SEED FILE.toml")->expected(2);
  program.add_option("--file", options.file, "judges a scene file instead of seeds")->type_name("FILE.toml");
  program.add_option("--shrink", options.shrink, "makes scenes with faults smaller, and writes them into this folder")
      ->type_name("DIR");
  program.add_option("--fault", options.fault, "the only fault that is shrunk")->type_name("NAME");
  program.add_flag("--with-program", options.withProgram,
                   "also runs springtower run on every scene as a file: exit code and end must be the same");
  program.add_flag("--ignore-times", options.ignoreTimes, "no bounds on processor time, for builds with sanitizers");
  program.footer(kFooter);
  wrapDescriptions(program);
}

ChildOptions childOptions(const Options& options) {
  ChildOptions child;
  child.judge.limit_s = options.limit_s.value_or(1.0);
  child.withProgram = options.withProgram;
  return child;
}

// Judges the seeds; records by seed.
std::vector<Record> judgeSeeds(const Options& options) {
  const std::int64_t from = options.from.value_or(1);
  const std::int64_t count = options.count.value_or(300);
  const auto jobs = options.jobs ? static_cast<std::size_t>(*options.jobs) : static_cast<std::size_t>(threadCount({}));
  const Clock::time_point start = Clock::now();
  std::vector<Record> records;
  Progress progress(static_cast<double>(count), "scenes");
  std::int64_t given = 0;
  const auto next = [&]() -> std::optional<ChildTask> {
    if (given == count || interrupted() || (options.minutes && minutesSince(start) > *options.minutes)) return std::nullopt;
    const auto seed = static_cast<std::uint64_t>(from + given++);
    return ChildTask{randomScene(seed), seed};
  };
  judgeInChildren(childOptions(options), jobs, next, [&](const ChildTask&, const Record& record) {
    records.push_back(record);
    progress.update(static_cast<double>(records.size()));
  });
  progress.clear();
  std::sort(records.begin(), records.end(), [](const Record& a, const Record& b) { return a.seed < b.seed; });
  return records;
}

// Shrinks one scene by its fault, judged for nothing that the fault does not need, and writes it.
void shrinkInto(const std::string& folder, const RandomScene& random, const Record& record, Fault fault, const Options& options) {
  ChildOptions child = childOptions(options);
  child.judge.compareThreads = fault == Fault::threads || fault == Fault::crash;
  child.judge.compareSleep = fault == Fault::verdict || fault == Fault::crash;
  child.withProgram = fault == Fault::program;
  const auto judge = [&](const RandomScene& smaller) { return judgeInChild(smaller, child); };
  const Shrunk shrunk = shrinkScene(random, record, fault, judge, kMostJudgedInShrinking);
  const std::string path = (std::filesystem::path(folder) / fmt::format("{}-{}.toml", record.scene, nameOf(fault))).string();
  OutputFile file(path, "--shrink");
  const std::string from = record.seed ? fmt::format("seed {}", *record.seed) : record.scene;
  file.stream() << sceneText(shrunk.random, fmt::format("{}, {}", from, describe(shrunk.record, fault)));
  file.commit();
  fmt::print("{}: {} blocks instead of {}, {} scenes judged\n", path, shrunk.random.scene.blocks.size(),
             random.scene.blocks.size(), shrunk.judged);
}

std::optional<Fault> faultToShrink(const Record& record, const Options& options) {
  if (options.fault) {
    const Fault fault = faultFromName(*options.fault, "--fault");
    return has(record, fault) ? std::optional(fault) : std::nullopt;
  }
  const std::vector<Fault> faults = faultsOf(record);
  return faults.empty() ? std::nullopt : std::optional(faults.front());
}

void writeRecords(OutputFile& file, const std::vector<Record>& records, const Options& options) {
  nlohmann::ordered_json json;
  json["version"] = kVersion;
  json["commit"] = kGitCommit;
  json["limit_s"] = options.limit_s.value_or(1.0);
  json["records"] = nlohmann::ordered_json::array();
  for (const Record& record : records) json["records"].push_back(recordJson(record));
  file.stream() << jsonText(json, 1) << '\n';
  file.commit();
}

int executeWrite(const Options& options) {
  const std::optional<double> seed = parseNumber(options.write[0]);
  if (!seed || !isInside(*seed, kSeedRange) || *seed != static_cast<double>(static_cast<std::uint64_t>(*seed))) {
    throw InputError(fmt::format("--write: expected a seed, a whole number from {}, got {}", describe(kSeedRange),
                                 inQuotes(options.write[0])));
  }
  const RandomScene random = randomScene(static_cast<std::uint64_t>(*seed));
  OutputFile file(options.write[1], "--write");
  file.stream() << sceneText(random, fmt::format("seed {}", static_cast<std::uint64_t>(*seed)));
  file.commit();
  return 0;
}

// A scene of a file, to be shrunk as single blocks. Throws InputError for a tower with moves, which needs its rows.
RandomScene fromFile(const std::string& path, bool shrink) {
  RandomScene random;
  random.scene = sceneFromToml(path);
  if (!shrink) return random;
  for (BlockSpec& block : random.scene.blocks) {
    if (block.row >= 0 && !random.scene.moves.empty()) {
      throw InputError(fmt::format("--shrink: {}: expected a scene without moves of a tower, got one with", onOneLine(path)));
    }
    block.row = -1;
    block.position = 0;
  }
  return random;
}

int executeFile(const Options& options) {
  const RandomScene random = fromFile(*options.file, options.shrink.has_value() || options.withProgram);
  const Record record = judgeInChild(random, childOptions(options));
  fmt::print("{}\n", jsonText(recordJson(record), 2));
  for (const Fault fault : faultsOf(record)) fmt::print("{}\n", describe(record, fault));
  const std::optional<Fault> fault = options.shrink ? faultToShrink(record, options) : std::nullopt;
  if (fault) shrinkInto(*options.shrink, random, record, *fault, options);
  return faultsOf(record).empty() ? 0 : kBeyondBounds;
}

// What must never be first; for a fifth of the minutes that were given.
void shrinkAll(std::vector<Record> records, const Options& options) {
  constexpr double kShareOfMinutes = 0.2;
  const auto rank = [&](const Record& record) {
    const std::optional<Fault> fault = faultToShrink(record, options);
    return fault ? static_cast<std::size_t>(*fault) : kFaults.size();
  };
  std::stable_sort(records.begin(), records.end(), [&](const Record& a, const Record& b) { return rank(a) < rank(b); });
  const Clock::time_point start = Clock::now();
  Progress progress(static_cast<double>(records.size()), "scenes looked at for shrinking");
  for (std::size_t i = 0; i < records.size(); ++i) {
    endIfInterrupted();
    if (options.minutes && minutesSince(start) > kShareOfMinutes * *options.minutes) break;
    progress.update(static_cast<double>(i));
    const std::optional<Fault> fault = faultToShrink(records[i], options);
    if (!fault) break;
    shrinkInto(*options.shrink, randomScene(*records[i].seed), records[i], *fault, options);
  }
}

int executeSeeds(const Options& options) {
  const auto file = options.json ? std::make_unique<OutputFile>(*options.json, "--json") : nullptr;
  const Clock::time_point start = Clock::now();
  const std::vector<Record> records = judgeSeeds(options);
  if (file) writeRecords(*file, records, options);
  double processor_s = 0.0;
  double simulated_s = 0.0;
  for (const Record& record : records) {
    processor_s += record.processor_s;
    simulated_s += record.simulated_s;
  }
  fmt::print("{}\n{}", tableOf(records), faultLines(records));
  fmt::print("{} scenes from seed {}, {:.0f} s simulated in {:.0f} s of processor time (first runs), {:.1f} minutes\n",
             records.size(), options.from.value_or(1), simulated_s, processor_s, minutesSince(start));
  const std::vector<Fault> exceeded = exceededBounds(records, !options.ignoreTimes);
  for (const Fault fault : exceeded) fmt::print("beyond its bound: {}\n", nameOf(fault));
  std::fflush(stdout);
  endIfInterrupted();
  if (options.shrink) shrinkAll(records, options);
  return exceeded.empty() ? 0 : kBeyondBounds;
}

int runProgram(int argc, char** argv) {
  CLI::App program("Simulates random scenes and judges them by what must hold in every scene.", "random_scenes");
  Options options;
  defineOptions(program, options);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    throw InputError(complaintAbout(program, error) + " (try 'random_scenes --help')");
  }
  if (options.fault) faultFromName(*options.fault, "--fault");
  if (options.shrink && !std::filesystem::is_directory(*options.shrink)) {
    throw InputError(fmt::format("--shrink: expected a folder that is there, got {}", inQuotes(*options.shrink)));
  }
  if (!options.write.empty()) return executeWrite(options);
  return options.file ? executeFile(options) : executeSeeds(options);
}

}  // namespace
}  // namespace springtower

int main(int argc, char** argv) {
  return springtower::exitCodeOf("random_scenes", [&] { return springtower::runProgram(argc, argv); });
}
