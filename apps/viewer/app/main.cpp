// The viewer: a window with the tower, a hand, and panels; or, with --headless, pictures of a scene. Exit codes are those of
// apps/common/program.h, and 1 where a replay differs; divergence counts without a window only.
#include "apps/common/arguments.h"
#include "apps/common/attempts.h"
#include "apps/common/interruption.h"
#include "apps/common/options.h"
#include "apps/common/output_file.h"
#include "apps/common/poses.h"
#include "apps/common/program.h"
#include "apps/viewer/app/window.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/tuning.h"
#include "core/version.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <exception>
#include <fmt/format.h>
#include <numbers>
#include <oneapi/tbb/global_control.h>

namespace springtower {
namespace {

constexpr int kReplayDiffers = 1;

constexpr std::string_view kFooter = R"help(examples:
  springtower-viewer                                 how high can you build? 18 rows, heights varying by 0.2 mm
  springtower-viewer --scene tower:12 --players 2    the game of two
  springtower-viewer --scene "(111)-(1L1)-(111)"     a tower with a loose block
  springtower-viewer --headless --frames 60 --png out --overlay load
mouse: a drag on a block pulls it out along its own axis, carries it once it is free, and lays it down where the outline is when
       it is let go; the wheel, Q and E turn it. A drag beside the blocks goes round. With shift held the block moves in all six
       axes: left drag in the plane of the screen, right drag along the view, wheel and Q E W S A D turn it.
keys:  space pause, n one frame, r reset, t slow motion, backspace undo, [ ] back and forth, o colour by, f contact forces,
       tab play or lab, p screenshot, v record video, i writes what is seen and all poses, escape ends
A signal (Ctrl-C) ends it as escape does, with exit code 130 or 143. A recording that a killed viewer leaves, FILE.partial, can be
replayed.)help";

struct Command {
  std::string scene = "tower:18";
  std::optional<double> heightsSigma_m;
  std::optional<double> massSigma_kg;
  std::optional<double> startGap_m;
  std::optional<std::int64_t> seed;
  std::optional<std::int64_t> players;
  std::optional<std::string> method;
  std::optional<double> tolerance_m;
  std::optional<double> friction;
  bool noSleep = false;
  std::optional<std::int64_t> threads;
  std::optional<double> grip_n;
  std::string overlay = "wood";
  bool arrows = false;
  bool paused = false;
  std::optional<std::string> mode;
  std::optional<double> scale;
  bool noPanels = false;
  std::string size = "1280x800";
  std::optional<std::string> camera;
  bool headless = false;
  std::optional<std::int64_t> frames;
  std::optional<std::int64_t> every;
  std::optional<std::string> png;
  std::optional<std::string> mouse;
  std::optional<std::string> replay;
  ViewerFiles files;
};

void define(CLI::App& app, Command& c) {
  app.add_option("--scene", c.scene,
                 "a .toml file, a bit code such as (111)-(1L1), or NAME:SIZE as springtower scenes lists them (default tower:18)")
      ->type_name("SCENE");
  addWholeNumber(app, "--players", c.players, {0, kMaxPlayers, ""},
                 "plays the game; 0 lets every block be taken (default: one where there is a full row above another)");
  addNumber(app, "--heights-sigma", c.heightsSigma_m, kHeightsSigmaRange, "METRES",
            "standard deviation of the blocks' heights (default 0.0002 for tower:ROWS, else none)");
  addNumber(app, "--mass-sigma", c.massSigma_kg, kMassSigmaRange, "KG", "standard deviation of the masses");
  addNumber(app, "--start-gap", c.startGap_m, kStartGapRange, "METRES", "rows start this far apart and drop");
  addWholeNumber(app, "--seed", c.seed, kSeedRange, "seed of the heights and masses");
  app.add_option("--method", c.method, "how a frame is stepped, as `springtower run --method`")->type_name("NAME");
  addNumber(app, "--tolerance", c.tolerance_m, {1e-7, 1e-2, "m"}, "METRES", "target penetration: no resting overlap exceeds it");
  addNumber(app, "--friction", c.friction, kFrictionRange, "MU", "coefficient of friction");
  app.add_flag("--no-sleep", c.noSleep, "simulate blocks at rest like all others");
  addWholeNumber(app, "--threads", c.threads, {1, 1024, ""}, "threads of the simulation");
  addNumber(app, "--grip", c.grip_n, {0.1, 100, "N"}, "N", "most force of the hand (default 5)");
  app.add_option("--overlay", c.overlay, "colours of the blocks: wood, load, strain, asleep, islands or hints")
      ->type_name("NAME");
  app.add_flag("--arrows", c.arrows, "shows contact forces");
  app.add_flag("--paused", c.paused, "starts paused");
  app.add_option("--mode", c.mode,
                 "what stands over the picture: play, lab, replay or bare (default play in a window, bare without one)")
      ->type_name("NAME");
  addNumber(app, "--scale", c.scale, {0.5, 4, ""}, "FACTOR", "size of words and buttons (default: the screen's, 1 without one)");
  app.add_flag("--no-panels", c.noPanels, "the same as --mode bare");
  app.add_option("--size", c.size, "of the picture in pixels (default 1280x800)")->type_name("WxH");
  app.add_option("--camera", c.camera, "where the camera stands: degrees from +x over +y, degrees up, metres off")
      ->type_name("AZ:UP:DIST");
  app.add_flag("--headless", c.headless, "opens no window: steps --frames and writes pictures");
  addWholeNumber(app, "--frames", c.frames, {1, 1e7, ""}, "frames to step without a window (default 60, or the whole replay)");
  addWholeNumber(app, "--png-every", c.every, {1, 1e7, ""}, "writes every Nth frame, and the last (default 1)");
  app.add_option("--png", c.png, "folder for pictures frame-00001.png ...")->type_name("DIR");
  app.add_option("--mouse", c.mouse, "a mouse for --headless: lines PICTURE X Y and press, release, hints, skip or nothing")
      ->type_name("FILE");
  app.add_option("--video", c.files.film, "records a video, a file .mp4 or .gif (needs ffmpeg)")->type_name("FILE");
  app.add_option("--record", c.files.record, "writes the input of all frames, as they pass")->type_name("FILE");
  app.add_option("--replay", c.replay, "plays a recording, and says in which frame its states differ")->type_name("FILE");
  app.add_option("--report", c.files.report, "writes at the end what happened, as JSON; measures penetration")->type_name("FILE");
  app.add_option("--poses", c.files.poses, "writes the poses at the end, as `springtower run --poses`")->type_name("FILE");
  app.add_option("--out", c.files.folder, "folder for what is written from the window (default out)")->type_name("DIR");
}

std::vector<double> numbersOf(std::string_view text, char between) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t end = text.find(between);
    const std::optional<double> number = parseNumber(text.substr(0, end));
    if (!number) return {};
    numbers.push_back(*number);
    if (end == std::string_view::npos) return numbers;
    text.remove_prefix(end + 1);
  }
}

Viewport sizeOf(const Command& command) {
  const std::vector<double> numbers = numbersOf(command.size, 'x');
  const auto good = [](double n) { return n >= 16 && n <= 8192 && n == std::floor(n); };
  if (numbers.size() != 2 || !good(numbers[0]) || !good(numbers[1])) {
    throw InputError(fmt::format("--size: expected WIDTHxHEIGHT, 16 to 8192 each, got {}", inQuotes(command.size)));
  }
  return {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
}

void placeCamera(const Command& command, Camera& camera) {
  if (!command.camera) return;
  const std::vector<double> numbers = numbersOf(*command.camera, ':');
  if (numbers.size() != 3 || numbers[2] < 0.05 || numbers[2] > 20.0) {
    throw InputError(
        fmt::format("--camera: expected AZIMUTH:ELEVATION:DISTANCE, 0.05 to 20 m, got {}", inQuotes(*command.camera)));
  }
  constexpr double kRadians = std::numbers::pi / 180.0;
  camera.azimuth = camera.elevation = 0.0;
  orbit(camera, kRadians * numbers[0], kRadians * numbers[1]);
  camera.distance = numbers[2];
}

SceneChoice choiceOf(const Command& command) {
  SceneChoice choice;
  choice.name = command.scene;
  choice.players = static_cast<int>(command.players.value_or(0));
  choice.options.heightsSigma_m = command.heightsSigma_m;
  if (!command.heightsSigma_m && command.scene.starts_with("tower:")) choice.options.heightsSigma_m = kUsualSigma_m;
  choice.options.massSigma_kg = command.massSigma_kg;
  choice.options.startGap_m = command.startGap_m;
  if (command.seed) choice.options.seed = static_cast<std::uint64_t>(*command.seed);
  return choice;
}

Tuning tuningOf(const Command& command, const SceneChoice& choice) {
  Tuning tuning = tuningOf(sceneOf(choice));
  if (command.method) tuning.method = methodFromName(*command.method, "--method");
  if (command.noSleep) tuning.sleep = Sleep::off;
  if (command.tolerance_m) tuning.tolerance_m = *command.tolerance_m;
  if (command.friction) tuning.friction = *command.friction;
  return tuning;
}

Mode modeOf(const Command& command) {
  if (!command.mode) return command.noPanels || command.headless ? Mode::bare : command.replay ? Mode::replay : Mode::play;
  const auto* found = std::find(kModeNames.begin(), kModeNames.end(), *command.mode);
  if (found == kModeNames.end())
    throw InputError(fmt::format("--mode: expected play, lab, replay or bare, got {}", inQuotes(*command.mode)));
  return static_cast<Mode>(found - kModeNames.begin());
}

// A player who chose nothing builds alone, where the scene has something to take.
void offerGame(const Command& command, Viewer& viewer) {
  if (command.players || command.replay || viewer.mode != Mode::play) return;
  SceneChoice choice = viewer.choice;
  choice.players = newGame(viewer.session.simulation, 1, 0).topRow > 0 ? 1 : 0;
  if (choice.players > 0) restart(viewer, choice);
}

// In the state that a replay begins in; a tuning that does not fit the scene is refused as its first frame.
Viewer viewerOf(const Replay& replay) {
  const SceneChoice& choice = replay.recording.choice;
  try {
    return Viewer(choice, replay.tuning());
  } catch (const InputError&) {
    return Viewer(choice, tuningOf(sceneOf(choice)));
  }
}

Viewer viewerOf(const Command& command) {
  std::optional<Replay> replay;
  if (command.replay) replay = Replay{readRecording(*command.replay), {}};
  Viewer viewer = replay ? viewerOf(*replay) : Viewer(choiceOf(command), tuningOf(command, choiceOf(command)));
  if (replay && !replay->recording.missing.empty()) {
    viewer.message = replay->recording.missing;
    complain("springtower-viewer", viewer.message);
  }
  viewer.replay = std::move(replay);
  viewer.overlay = overlayFromName(command.overlay);
  viewer.arrows = command.arrows;
  viewer.paused = command.paused;
  viewer.mode = modeOf(command);
  if (command.scale) viewer.scale = static_cast<float>(*command.scale);
  viewer.limit_n = command.grip_n.value_or(tuning::kGripForce_n);
  viewer.watch.measures = command.files.report.has_value();
  placeCamera(command, viewer.controls.camera);
  offerGame(command, viewer);
  return viewer;
}

std::unique_ptr<OutputFile> opened(const std::optional<std::string>& path, const std::string& option) {
  return path ? std::make_unique<OutputFile>(*path, option) : nullptr;
}

// The exit code, said in words where it is none of done.
int outcomeOf(const Viewer& viewer, bool headless) {
  if (viewer.watch.interrupted) return interruptionExitCode();
  if (viewer.replay && !viewer.replay->refused.empty()) {
    complain("springtower-viewer", viewer.replay->refused);
    return kBadInput;
  }
  if (viewer.replay && viewer.replay->differs) {
    fmt::print("the replay differs first in frame {}\n", *viewer.replay->differs);
    return kReplayDiffers;
  }
  if (headless && !viewer.session.failure.empty()) {
    complain("springtower-viewer", viewer.session.failure);
    return kDiverged;
  }
  return 0;
}

void play(const Command& command, Viewer& viewer, const ViewerFiles& files, const Viewport& size,
          std::chrono::steady_clock::time_point started) {
  if (!command.headless) return runWindow(viewer, files, size, started);
  const std::size_t recorded = viewer.replay ? viewer.replay->recording.frames.size() : 60;
  runHeadless(viewer, files, size,
              {static_cast<int>(command.frames.value_or(static_cast<std::int64_t>(recorded))),
               static_cast<int>(command.every.value_or(1)), command.png,
               command.mouse ? readMouseScript(*command.mouse) : std::vector<MouseStep>{}},
              started);
}

int runViewer(const Command& command, std::chrono::steady_clock::time_point started) {
  const Viewport size = sizeOf(command);
  if (!command.headless && (command.frames || command.png || command.every || command.mouse)) {
    throw InputError("--frames, --png, --png-every and --mouse: expected only with --headless, got one without");
  }
  const auto threads = static_cast<std::size_t>(command.threads.value_or(threadCount({})));
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  checkOutputNames({{"--report", &command.files.report},
                    {"--poses", &command.files.poses},
                    {"--record", &command.files.record},
                    {"--video", &command.files.film}});
  Viewer viewer = viewerOf(command);
  const auto report = opened(command.files.report, "--report");
  const auto poses = opened(command.files.poses, "--poses");
  const auto record = opened(command.files.record, "--record");
  std::optional<RecordingWriter> recorder;
  if (record) recorder.emplace(*record);
  ViewerFiles files = command.files;
  files.recorder = recorder ? &*recorder : nullptr;
  Attempts attempts;
  attempts.attempt([&] { play(command, viewer, files, size, started); });
  // A picture or video that cannot be written does not cost the others. Where it failed before the first frame, older files stay.
  if (viewer.session.log.empty()) attempts.finish();
  if (report) {
    attempts.attempt([&] {
      writeViewerReport(report->stream(), viewer);
      report->commit();
    });
  }
  const double frame_s = viewer.session.scene.settings.frame_s;
  if (poses) {
    attempts.attempt([&] {
      PoseWriter(poses->stream(), frame_s, frame_s).frame(viewer.session.simulation);
      poses->commit();
    });
  }
  // Where the search before the first frame was ended, an older recording stays.
  const bool ended = viewer.watch.interrupted || (!command.headless && viewer.watch.pictures == 0);
  if (recorder && !(ended && viewer.session.log.empty()))
    attempts.attempt([&] { recorder->finish(viewer.choice, viewer.session); });
  attempts.finish();
  return outcomeOf(viewer, command.headless);
}

int run(int argc, char** argv, std::chrono::steady_clock::time_point started) {
  CLI::App app("Shows stacks of wooden blocks, and the game: pull a block out, lay it on top.", "springtower-viewer");
  app.set_help_flag("-h,--help", "prints this help");
  app.set_version_flag("--version", fmt::format("springtower-viewer {} ({}, {})", kVersion, kGitCommit, kBuildType),
                       "prints the version");
  app.footer(std::string(kFooter));
  app.get_formatter()->column_width(34);
  Command command;
  define(app, command);
  wrapDescriptions(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    complain("springtower-viewer", complaintAbout(app, error));
    fmt::print(stderr, "Try 'springtower-viewer --help'.\n");
    return kBadInput;
  }
  return runViewer(command, started);
}

}  // namespace
}  // namespace springtower

int main(int argc, char** argv) {
  const auto started = std::chrono::steady_clock::now();
  return springtower::exitCodeOf("springtower-viewer", [&] { return springtower::run(argc, argv, started); });
}
