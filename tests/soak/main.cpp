// What runs for hours must not grow, creep, gain energy, or lose a bit: a tower awake, falls that are built and forgotten, and a
// viewer whose user does anything at random.
//   soak [--minutes M] [--seed N] [PART...]
#include "apps/common/arguments.h"
#include "apps/common/interruption.h"
#include "apps/common/options.h"
#include "apps/common/program.h"
#include "core/byte_stream.h"
#include "core/error.h"
#include "scenarios/towers.h"
#include "solver/frame/prepare.h"
#include "solver/metrics/measures.h"
#include "solver/metrics/penetration.h"
#include "solver/world/snapshot.h"
#include "tests/apps/viewer/app/random_user.h"
#include "tests/support/drawn_scenes.h"
#include "tests/support/uneven_tower.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

namespace springtower {
namespace {

constexpr Range kSoakMinutesRange{1e-3, 1e5, "minutes"};
constexpr std::uint64_t kCheckFrames = 600;  // 10 s simulated, between two looks at what is bounded

// A figure that is bounded: the largest that was found.
struct Figure {
  std::string name;
  std::string unit;
  double most;  // allowed
  double found = 0.0;
};

// What a part has found.
struct Soaked {
  double simulated_s = 0.0;
  std::vector<Figure> figures;
  std::vector<std::string> faults;  // that are no figures: a divergence, other bits

  void see(std::string_view name, std::string_view unit, double most, double found) {
    for (Figure& figure : figures) {
      if (figure.name != name) continue;
      if (!(found <= figure.found)) figure.found = found;
      return;
    }
    figures.push_back({std::string(name), std::string(unit), most, found});
  }
};

struct Soak {
  std::chrono::steady_clock::time_point end;
  std::uint64_t seed = 1;
  [[nodiscard]] bool goesOn() const { return std::chrono::steady_clock::now() < end && !interrupted(); }
};

// Resident memory of the process, MB.
double residentMemory_mb() {
  long pages = 0;
  long resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

// The simulation's future, from its snapshot as bytes in a simulation that has never been stepped.
std::uint64_t hashOfTwin(const Scene& scene, const std::string& bytes, std::uint64_t frames) {
  Simulation twin(scene);
  ByteReader reader(bytes, "snapshot");
  restoreSnapshot(twin, *readSnapshot(reader));
  for (std::uint64_t frame = 0; frame < frames; ++frame) stepFrame(twin);
  return stateHash(twin);
}

std::string bytesOf(const Simulation& simulation) {
  ByteWriter writer;
  writeSnapshot(*takeSnapshot(simulation), writer);
  return writer.bytes();
}

// A tower of uneven blocks that never sleeps. It settles for a minute; from then on nothing may move or grow.
void soakTower(const Soak& soak, Soaked& found) {
  constexpr std::uint64_t kSettledFrames = 6 * kCheckFrames;
  constexpr std::uint64_t kTwinChecks = 8;  // looks from one twin to the next
  Scene scene = awake(towerScene(18, {.heightsSigma_m = kUnevenHeightsSigma_m, .seed = soak.seed}));
  Simulation simulation(scene);
  prepare(simulation);
  for (std::uint64_t frame = 0; frame < kSettledFrames; ++frame) stepFrame(simulation);
  const ParticleArray settled = simulation.state.position;
  const double energy_j = energy(simulation).total();
  std::optional<double> memory_mb;  // from the second twin on: what the first one takes is part of the start
  PenetrationWorkspace workspace;
  for (std::uint64_t check = 0; check == 0 || soak.goesOn(); ++check) {  // one look, however slow the machine is
    const std::string before = check % kTwinChecks == 0 ? bytesOf(simulation) : std::string();
    for (std::uint64_t frame = 0; frame < kCheckFrames; ++frame) stepFrame(simulation);
    if (!before.empty() && hashOfTwin(scene, before, kCheckFrames) != stateHash(simulation)) {
      found.faults.push_back(fmt::format("other bits from a snapshot, frame {}", simulation.frame));
    }
    found.simulated_s = simulation.time_s;
    if (check == kTwinChecks) memory_mb = residentMemory_mb();
    if (memory_mb) found.see("memory grown", "MB", 1.0, residentMemory_mb() - *memory_mb);
    found.see("creep", "mm", 1e-3, 1e3 * largestCornerMove(settled, simulation.state.position));
    found.see("penetration, tolerances", "", 2.0,
              maxPenetration(simulation.state.position, true, workspace).depth / simulation.tolerance_m);
    found.see("energy changed by", "of it", 1e-9, std::abs(energy(simulation).total() / energy_j - 1.0));
  }
  if (!memory_mb) fmt::print("  memory is not measured: the {}th look was not reached\n", kTwinChecks + 1);
}

// One fall, built and forgotten. Returns the hash of its end.
std::uint64_t soakFall(const Scene& scene, Soaked& found) {
  constexpr std::uint64_t kFallFrames = 150;
  Simulation simulation(scene);
  prepare(simulation);
  Energy before = energy(simulation);
  double potential_j = 0.0;
  for (const BlockSpec& block : scene.blocks) potential_j += block.mass * scene.gravity.magnitude * block.centre.z();
  double rise = 0.0;
  for (std::uint64_t frame = 0; frame < kFallFrames; ++frame) {
    stepFrame(simulation);
    Energy now = energy(simulation);
    rise = std::max(rise, energyRise(before, now));
    before = std::move(now);
  }
  found.simulated_s += simulation.time_s;
  found.see("largest rise of energy in a frame", "of what there was", 0.01, rise / potential_j);
  return stateHash(simulation);
}

// Falls of every kind, the same again and again: the same end, and no more memory than in the first two rounds.
void soakFalls(const Soak& soak, Soaked& found) {
  constexpr std::uint64_t kSeeds = 12;
  std::map<std::string, std::uint64_t> ends;
  std::optional<double> memory_mb;
  for (std::uint64_t round = 0; round == 0 || soak.goesOn(); ++round) {
    if (round == 2) memory_mb = residentMemory_mb();
    for (std::uint64_t seed = soak.seed; seed < soak.seed + kSeeds && (ends.empty() || soak.goesOn()); ++seed) {
      const std::vector<Scene> scenes = {droppedBlocks(seed), topplingTower(seed), shiftedTower(seed)};
      for (std::size_t kind = 0; kind < scenes.size(); ++kind) {
        const std::string name = fmt::format("seed {} of kind {}", seed, kind);
        const std::uint64_t hash = soakFall(scenes[kind], found);
        if (ends.try_emplace(name, hash).first->second != hash) found.faults.push_back("another end than before: " + name);
      }
      if (memory_mb) found.see("memory grown", "MB", 1.0, residentMemory_mb() - *memory_mb);
    }
  }
  if (!memory_mb) fmt::print("  memory is not measured: the third round was not reached\n");
}

// A viewer's user at random. From time to time the session goes back, and forth again to where it was, which has to lead to the
// bits that its log has.
void soakViewer(const Soak& soak, Soaked& found) {
  constexpr double kPlay_s = 10.0;
  // Blocks, pictures and what one frame of the log holds, beside the keyframes.
  constexpr double kOther_mb = 48.0;
  const double memory_mb = residentMemory_mb();
  Viewer viewer = randomViewer("tower:6", 0, Method::implicit);
  Dice dice(soak.seed);
  std::size_t longest = 0;
  do {
    playAtRandom(viewer, kPlay_s, dice);
    Session& session = viewer.session;
    longest = std::max(longest, session.log.size());
    const std::uint64_t last = lastLogged(session);
    goTo(session, session.forgotten + static_cast<std::uint64_t>(dice.below(static_cast<int>(session.log.size()) + 1)));
    goTo(session, last);
    if (last > 0 && stateHash(session.simulation) != session.log.back().hash) {
      found.faults.push_back(fmt::format("other bits after going back and forth, frame {}", last));
    }
    // A vector that grows has up to twice the room that it fills, and three times while it is copied.
    const double log_mb = 3.0 * static_cast<double>(longest * sizeof(LoggedFrame)) / 1048576.0;
    const double allowed_mb = static_cast<double>(kKeyframeBytes) / 1048576.0 + kOther_mb + log_mb;
    found.simulated_s = static_cast<double>(viewer.watch.frames) * session.scene.settings.frame_s;
    found.see("memory over what its history may have", "", 1.0, (residentMemory_mb() - memory_mb) / allowed_mb);
    found.see("penetration", "mm", 1.0, 1e3 * viewer.watch.deepest.depth);
    found.see("divergences", "", 0.0, viewer.watch.failures);
  } while (soak.goesOn());
}

struct Part {
  const char* name;
  void (*run)(const Soak& soak, Soaked& found);
};
constexpr std::array<Part, 3> kParts = {{{"tower", soakTower}, {"falls", soakFalls}, {"viewer", soakViewer}}};

// Runs a part and says what it found; whether all was within its bounds.
bool runPart(const Part& part, double seconds, std::uint64_t seed) {
  const auto start = std::chrono::steady_clock::now();
  const Soak soak{start + std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds)),
                  seed};
  Soaked found;
  try {
    part.run(soak, found);
  } catch (const DivergenceError& error) {
    found.faults.push_back(error.what());
  }
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print("{}: {:.3g} h simulated in {:.0f} s\n", part.name, found.simulated_s / 3600.0, wall_s);
  bool good = found.faults.empty();
  for (const Figure& figure : found.figures) {
    const bool within = figure.found <= figure.most;
    good = good && within;
    fmt::print("  {:<6} {}: {:.3g} {}, at most {:g}\n", within ? "" : "BEYOND", figure.name, figure.found, figure.unit,
               figure.most);
  }
  if (found.figures.empty()) {
    fmt::print("  BEYOND nothing was measured: too short\n");
    good = false;
  }
  for (const std::string& fault : found.faults) fmt::print("  FAULT  {}\n", fault);
  std::fflush(stdout);
  return good;
}

int runSoak(int argc, char** argv) {
  CLI::App program("Simulates for long, and looks whether anything grows, creeps, gains energy or loses a bit.", "soak");
  std::optional<double> minutes;
  std::optional<std::int64_t> seed;
  std::vector<std::string> names;
  program.set_help_flag("-h,--help", "prints this help");
  addNumber(program, "--minutes", minutes, kSoakMinutesRange, "M", "of all parts together (default 60)");
  addWholeNumber(program, "--seed", seed, kSeedRange, "of what is drawn at random (default 1)");
  program.add_option("PART", names, "tower, falls, viewer (default: all)");
  program.footer("exit codes: 0 all within bounds, 1 not so, 2 bad arguments, 130 or 143 ended by a signal");
  wrapDescriptions(program);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    throw InputError(complaintAbout(program, error) + " (try 'soak --help')");
  }
  std::vector<Part> parts;
  for (const Part& part : kParts) {
    if (names.empty() || std::find(names.begin(), names.end(), part.name) != names.end()) parts.push_back(part);
  }
  for (const std::string& name : names) {
    const bool known = std::any_of(kParts.begin(), kParts.end(), [&](const Part& part) { return part.name == name; });
    if (!known) throw InputError(fmt::format("expected the part tower, falls or viewer, got {}", inQuotes(name)));
  }
  bool good = true;
  const double seconds = 60.0 * minutes.value_or(60.0) / static_cast<double>(parts.size());
  for (const Part& part : parts) good = runPart(part, seconds, static_cast<std::uint64_t>(seed.value_or(1))) && good;
  endIfInterrupted();
  return good ? 0 : 1;
}

}  // namespace
}  // namespace springtower

int main(int argc, char** argv) {
  return springtower::exitCodeOf("soak", [&] { return springtower::runSoak(argc, argv); });
}
