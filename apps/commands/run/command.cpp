#include "apps/commands/run/command.h"

#include "apps/commands/run/forces_report.h"
#include "apps/commands/run/report.h"
#include "apps/common/attempts.h"
#include "apps/common/interruption.h"
#include "apps/common/json_values.h"
#include "apps/common/output_file.h"
#include "apps/common/poses.h"
#include "apps/common/program.h"
#include "apps/common/progress.h"
#include "apps/picture/picture.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/version.h"
#include "scenarios/registry.h"
#include "solver/runner/run.h"
#include "solver/runner/run_state.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <initializer_list>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/global_control.h>

namespace springtower {
namespace {

constexpr Range kPosesEveryRange{1e-6, 1e7, "s"};

constexpr std::string_view kRunExamples = R"help(examples:
  springtower run tower:18                               the full tower for 10 s
  springtower run wall:20x12                             another of the scenes that springtower scenes lists
  springtower run tower:18 --seconds 60 --no-sleep       all blocks simulated to the end
  springtower run "(010)-(010)-(011)" --picture a.png    a bit code: rows from the bottom, 1 present, 0 absent, L loose
  springtower run tower:18 --gravity-tilt 14.5 --report collapse.json --poses collapse.csv --poses-every 0.05
  springtower run tower:18 --heights-sigma 0.0002 --seed 3
  springtower run scenes/moves.toml --save half.run      keeps the end, or where Ctrl-C ended it, in a file
  springtower run --resume half.run --seconds 5          goes on from there for 5 s, bit for bit as if it had not stopped
  springtower run tower:18 --method semi-implicit-euler --substeps 50
                                                         prints the tolerance that 50 steps a frame allow)help";

Gravity withOptions(Gravity gravity, const RunCommand& command) {
  if (command.tilt_deg) gravity.tilt_deg = *command.tilt_deg;
  if (command.direction_deg) gravity.direction_deg = *command.direction_deg;
  if (!command.sway) return gravity;
  const std::string_view sway = *command.sway;
  const std::size_t colon = sway.find(':');
  const std::optional<double> degrees = parseNumber(sway.substr(0, colon));
  const std::optional<double> hertz = colon == std::string::npos ? std::nullopt : parseNumber(sway.substr(colon + 1));
  if (!degrees || !hertz || !isInside(*degrees, kTiltRange) || !isInside(*hertz, kFrequencyRange)) {
    throw InputError(fmt::format("--gravity-sway: expected DEG:HZ, {} and {}, such as 0.1:1, got {}", describe(kTiltRange),
                                 describe(kFrequencyRange), inQuotes(sway)));
  }
  gravity.sway_deg = *degrees;
  gravity.sway_hz = *hertz;
  return gravity;
}

Scene withSeconds(Scene scene, const RunCommand& command) {
  if (command.seconds) scene.seconds = *command.seconds;
  return scene;
}

std::unique_ptr<OutputFile> open(const std::optional<std::string>& path, const std::string& option) {
  return path ? std::make_unique<OutputFile>(*path, option) : nullptr;
}

void writeReport(OutputFile& file, const Simulation& simulation, const RunResult& result, int threads, bool withForces) {
  nlohmann::ordered_json json = reportJson(simulation, result, threads);
  if (withForces) json["forces"] = forcesJson(simulation);
  file.stream() << jsonText(json, 2) << '\n';
  file.commit();
}

// Scene and settings are in the file: whatever would change them is refused beside it. (CLI11's own exclusion would list all of
// these options in the help.)
void addResume(CLI::App& run, std::optional<std::string>& file) {
  static constexpr std::array<std::string_view, 9> kFitting = {"--help",  "--seconds",     "--threads", "--report", "--forces",
                                                               "--poses", "--poses-every", "--picture", "--save"};
  const std::vector<CLI::Option*> others = run.get_options();
  CLI::Option* const resume =
      run.add_option("--resume", file,
                     "goes on with a run that --save has written, in place of SCENE, with its scene and settings, on any number "
                     "of threads")
          ->type_name("FILE");
  run.parse_complete_callback([resume, others] {
    if (resume->count() == 0) return;
    for (const CLI::Option* const other : others) {
      const auto fits = [&](std::string_view name) { return other->check_name(std::string(name)); };
      if (other->count() > 0 && std::none_of(kFitting.begin(), kFitting.end(), fits))
        throw CLI::ExcludesError(resume->get_name(), other->get_name());
    }
  });
}

// A run to go on with, if one is named. Throws InputError for a command line without any scene.
std::optional<SavedRun> savedRunOf(const RunCommand& command) {
  if (!command.resume) {
    if (command.scene.empty()) throw InputError("run: expected SCENE or --resume, got neither");
    return std::nullopt;
  }
  LoadedRun loaded = readRun(*command.resume, fmt::format("--resume {}", inQuotes(*command.resume)));
  if (loaded.commit != kGitCommit) {
    complain("springtower", fmt::format("--resume {}: was saved by commit {}, this is {}: it may go on otherwise than there",
                                        inQuotes(*command.resume), loaded.commit, kGitCommit));
  }
  return std::move(loaded.run);
}

// The files that a run writes; null where no option names one.
struct RunFiles {
  std::unique_ptr<OutputFile> report;
  std::unique_ptr<OutputFile> poses;
  std::unique_ptr<OutputFile> picture;
  std::unique_ptr<OutputFile> save;
};

// Not where the search for the equilibrium was ended: the blocks are as placed, and what goes on from there starts otherwise.
void saveRun(OutputFile& file, const Scene& scene, const Simulation& simulation, const RunResult& result) {
  if (result.prepared.end == PrepareEnd::cancelled)
    return complain("springtower", "--save: nothing is saved of a run that was ended before its first frame");
  writeRun({scene, takeSnapshot(simulation), result.progress}, file.stream());
  file.commit();
}

RunFiles filesOf(const RunCommand& command) {
  return {open(command.report, "--report"), open(command.poses, "--poses"), open(command.picture, "--picture"),
          open(command.save, "--save")};
}

// Of a run that has diverged: what is thrown then is that.
void keepPoses(const RunFiles& files) {
  if (!files.poses) return;
  try {
    files.poses->commit();
  } catch (const InputError& error) {
    complain("springtower", error.what());
  }
}

// All that can be written.
void writeFiles(const RunFiles& files, const RunCommand& command, const Scene& scene, const Simulation& simulation,
                const RunResult& result, int threads, Attempts& outputs) {
  if (files.poses && outputs.failed()) {
    files.poses->keep();
  } else if (files.poses) {
    outputs.attempt([&] { files.poses->commit(); });
  }
  if (files.report) outputs.attempt([&] { writeReport(*files.report, simulation, result, threads, command.forces); });
  if (files.save) outputs.attempt([&] { saveRun(*files.save, scene, simulation, result); });
  if (files.picture) {
    outputs.attempt([&] {
      writePicture(files.picture->stream(), simulation.state.position, simulation.scene.floor);
      files.picture->commit();
    });
  }
}

}  // namespace

CLI::App* defineRun(CLI::App& program, RunCommand& command) {
  CLI::App* run = program.add_subcommand("run", "simulates a scene, measures it and prints a table");
  run->add_option("SCENE", command.scene,
                  "NAME or NAME:SIZE as springtower scenes lists them, such as tower:18 or wall:20x12; a bit code such as "
                  "(010)-(010)-(011); or a .toml file")
      ->type_name("");
  addNumber(*run, "--seconds", command.seconds, kSecondsRange, "S",
            "simulated time (default 10, or what the scene file says); with --resume beyond what was saved");
  addPhysicsOptions(*run, command.physics);
  addNumber(
      *run, "--prepare-budget", command.prepareBudget_s, kPrepareBudgetRange, "S",
      "wall time of the search for the equilibrium before the first frame; what has none by then starts as placed (default: "
      "no limit)");
  addNumber(*run, "--heights-sigma", command.heightsSigma_m, kHeightsSigmaRange, "METRES",
            "standard deviation of the heights of a tower's blocks");
  addNumber(*run, "--mass-sigma", command.massSigma_kg, kMassSigmaRange, "KG",
            "standard deviation of the masses of a tower's blocks");
  addWholeNumber(*run, "--seed", command.seed, kSeedRange,
                 "seed of --heights-sigma and --mass-sigma (default 1); the same towers on every machine");
  addNumber(*run, "--start-gap", command.startGap_m, kStartGapRange, "METRES", "rows start this far apart and drop");
  addNumber(*run, "--gravity-tilt", command.tilt_deg, kTiltRange, "DEG", "gravity leans this far from straight down");
  addNumber(*run, "--gravity-direction", command.direction_deg, kDirectionRange, "DEG",
            "side towards which gravity leans, from +x over +y (default 0)");
  run->add_option("--gravity-sway", command.sway, "gravity swings by DEG about its tilt, HZ times a second")->type_name("DEG:HZ");
  run->add_option("--report", command.report, "writes all figures as JSON")->type_name("FILE.json");
  run->add_flag("--forces", command.forces, "adds every contact point's force at the end to the report")->needs("--report");
  run->add_option("--poses", command.poses, "writes the corners of all blocks as CSV: time_s,block,x0,y0,z0,...,x7,y7,z7, metres")
      ->type_name("FILE.csv");
  addNumber(*run, "--poses-every", command.posesEvery_s, kPosesEveryRange, "S", "time between poses (default: every frame)")
      ->needs("--poses");
  run->add_option("--picture", command.picture, "draws the last frame")->type_name("FILE.png");
  run->add_option("--save", command.save,
                  "writes the state at the end, or where a signal ends the run (not during the search for the equilibrium); "
                  "--resume goes on with it")
      ->type_name("FILE");
  addResume(*run, command.resume);
  wrapDescriptions(*run);
  run->footer(std::string(kRunExamples));
  return run;
}

Scene sceneOf(const RunCommand& command) {
  TowerOptions options;
  options.heightsSigma_m = command.heightsSigma_m;
  options.massSigma_kg = command.massSigma_kg;
  if (command.seed) options.seed = static_cast<std::uint64_t>(*command.seed);
  options.startGap_m = command.startGap_m;
  Scene scene = withSeconds(sceneNamed(command.scene, options), command);
  scene.gravity = withOptions(scene.gravity, command);
  applyPhysicsOptions(command.physics, scene.settings);
  return scene;
}

int executeRun(const RunCommand& command) {
  if (command.picture && !command.picture->ends_with(".png")) {
    throw InputError(fmt::format("--picture: expected a name that ends with .png, got {}", inQuotes(*command.picture)));
  }
  checkOutputNames(
      {{"--report", &command.report}, {"--poses", &command.poses}, {"--picture", &command.picture}, {"--save", &command.save}});
  const std::optional<SavedRun> resumed = savedRunOf(command);
  const Scene scene = resumed ? withSeconds(resumed->scene, command) : sceneOf(command);
  const RunFiles files = filesOf(command);
  const int threads = threadCount(command.physics);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));

  Simulation simulation(scene);
  RunOptions options;
  options.seconds = scene.seconds;
  Attempts outputs;  // a run whose poses cannot be written ends there, and keeps the rest
  options.shouldStop = [&] { return interrupted() || outputs.failed(); };
  if (resumed) options.resumed = &*resumed;
  std::optional<PoseWriter> writer;
  if (files.poses)
    writer.emplace(files.poses->stream(), command.posesEvery_s.value_or(scene.settings.frame_s), scene.settings.frame_s);
  Progress preparing(static_cast<double>(scene.blocks.size()), "blocks in equilibrium or left as placed");
  if (command.prepareBudget_s) options.prepare.budget_s = *command.prepareBudget_s;
  options.prepare.goesOn = [&](const PrepareProgress& now) {
    preparing.update(static_cast<double>(now.blocksDone), fmt::format("{} iterations", now.iterations));
    return true;
  };
  Progress progress(scene.seconds + (resumed ? resumed->snapshot->time_s : 0.0), "s simulated");
  RunResult result;
  try {
    result = runScene(simulation, options, [&](const Simulation& now) {
      if (writer && !outputs.failed()) {
        outputs.attempt([&] {
          writer->frame(now);
          if (isPrepared(now)) files.poses->flushEverySecond();
        });
      }
      if (now.frame > 0) preparing.clear();
      progress.update(now.time_s);
    });
  } catch (const DivergenceError&) {
    keepPoses(files);
    throw;
  } catch (const std::bad_alloc&) {
    const std::string kept = files.poses ? files.poses->keep() : std::string();
    if (!kept.empty()) complain("springtower", fmt::format("--poses: what was written until then is in {}", inQuotes(kept)));
    throw;
  }
  preparing.clear();
  progress.clear();
  writeFiles(files, command, scene, simulation, result, threads, outputs);
  printResult(simulation, result, threads);
  outputs.finish();
  return result.interrupted ? interruptionExitCode() : 0;
}

}  // namespace springtower
