#include "apps/commands/statics/command.h"

#include "apps/commands/statics/list.h"
#include "apps/commands/statics/report.h"
#include "apps/common/interruption.h"
#include "apps/common/json_values.h"
#include "apps/common/options.h"
#include "apps/common/output_file.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/scene/remove_block.h"
#include "scenarios/registry.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>

namespace springtower {
namespace {

// The time of a linear program grows with the cube of this.
constexpr std::size_t kMaxStaticBlocks = 1000;

constexpr std::string_view kHelp =
    R"help(Blocks are taken as rigid, with Coulomb friction where faces touch: no motion is simulated. The scene stands if some
forces in the contacts balance every block. Its margin is the angle by which gravity may turn towards the worst side before
none do; a negative one is how far gravity has to turn for a scene that falls to stand. The statics of rigid blocks is an
upper bound where friction is at its limit. Where a block can lean a little until it touches another it is taken to do so.

columns of the table:
  load        normal force from what lies on the block; of all forces that balance, those with the least sum of squares
  min, max    least and greatest load of any forces that balance: three supports may share a load in many ways
  above       nothing: no block lies over it; loose: the one over it does not touch it, and the gap between them; loaded
  if removed  what the others do then, and their margin
--contacts prints for each contact the normal force, friction, where they act, and the share of the friction limit in use.
examples:
  springtower statics tower:18
  springtower statics "(111)-(1L1)-(010)" --contacts      loose blocks carry nothing
  springtower statics tower:18 --remove 3:1 --remove 3:2  without these; rows count from 0, positions from 1
  springtower statics tower:9 --pull 4:2,+x               how hard the block may be pulled before it has to slip
  springtower statics tower:18 --heights-sigma 0.0002 --seed 3 --report statics.json
  springtower statics towers.jsonl --check                a list, as for verdict; lines may hold remove and stands_after)help";

// A pair of a block and an axis with one comma between them; a space would make an axis that starts with - an option.
std::pair<std::string, std::string> splitPull(const std::string& text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) {
    throw InputError(fmt::format("--pull: expected BLOCK,AXIS, such as 4:2,+x, got {}", inQuotes(text)));
  }
  return {text.substr(0, comma), text.substr(comma + 1)};
}

Vec3 axisNamed(const std::string& text) {
  constexpr std::string_view kNames = "xyz";
  const bool isSigned = text.size() == 2 && (text[0] == '+' || text[0] == '-');
  const std::size_t axis = text.empty() || (text.size() > 1 && !isSigned) ? std::string_view::npos : kNames.find(text.back());
  if (axis == std::string_view::npos) {
    throw InputError(fmt::format("--pull: expected the axis +x, -x, +y, -y, +z or -z, got {}", inQuotes(text)));
  }
  Vec3 direction = Vec3::Zero();
  direction[static_cast<Eigen::Index>(axis)] = text[0] == '-' ? -1.0 : 1.0;
  return direction;
}

Scene sceneOf(const StaticsCommand& command) {
  TowerOptions options;
  options.heightsSigma_m = command.heightsSigma_m;
  options.massSigma_kg = command.massSigma_kg;
  if (command.seed) options.seed = static_cast<std::uint64_t>(*command.seed);
  Scene scene = sceneNamed(command.scene, options);
  if (command.friction) scene.staticFriction = scene.kineticFriction = *command.friction;
  if (command.tilt_deg) scene.gravity.tilt_deg = *command.tilt_deg;
  if (command.direction_deg) scene.gravity.direction_deg = *command.direction_deg;
  std::vector<std::size_t> gone;
  for (const std::string& name : command.remove) {
    const std::size_t block = index(blockNamed(scene, name, "--remove"));
    if (std::find(gone.begin(), gone.end(), block) != gone.end()) {
      throw InputError(fmt::format("--remove: expected each block once, got {} twice", inQuotes(name)));
    }
    gone.push_back(block);
  }
  std::sort(gone.rbegin(), gone.rend());
  for (const std::size_t block : gone) removeBlock(scene, block);
  if (scene.blocks.empty() || scene.blocks.size() > kMaxStaticBlocks) {
    throw InputError(fmt::format("{}: expected 1 to {} blocks for statics, got {}", onOneLine(command.scene), kMaxStaticBlocks,
                                 scene.blocks.size()));
  }
  return scene;
}

// Of every block; nothing for those left when a signal comes.
std::vector<std::optional<Removal>> removalsUntilInterrupted(const Scene& scene) {
  std::vector<std::optional<Removal>> known(scene.blocks.size());
  tbb::parallel_for(std::size_t{0}, known.size(), [&](std::size_t b) {
    if (!interrupted()) known[b] = removalOf(scene, blockId(b));
  });
  return known;
}

StaticsAnswer answerOf(const Scene& scene, const StaticsCommand& command) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<Vec3> directions;
  StaticsAnswer answer;
  for (const std::string& pull : command.pull) {
    const auto [block, axis] = splitPull(pull);
    answer.pulls.push_back({blockNamed(scene, block, "--pull"), axis, {}});
    directions.push_back(axisNamed(axis));
  }
  answer.statics = staticScene(scene);
  answer.margin = tiltMargin(answer.statics);
  if (answer.statics.rest != Rest::falls && !interrupted()) {
    answer.loads = contactLoads(answer.statics);
    answer.blocks = blockLoads(answer.statics, answer.loads);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      answer.pulls[i].limit_n = pullLimit(answer.statics, answer.pulls[i].block, directions[i]);
    }
  }
  if (!command.noRemovals) answer.removals = removalsUntilInterrupted(scene);
  answer.interrupted = (answer.statics.rest != Rest::falls && answer.blocks.empty()) ||
                       std::any_of(answer.removals.begin(), answer.removals.end(), [](const auto& known) { return !known; });
  answer.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return answer;
}

bool isList(const std::string& name) {
  return name == "-" || name.ends_with(".jsonl");
}

// A list takes few of the options; one that would be passed over in silence is refused.
void checkListOptions(const StaticsCommand& command) {
  const std::pair<bool, std::string_view> given[] = {{command.friction.has_value(), "--mu"},
                                                     {command.heightsSigma_m.has_value(), "--heights-sigma"},
                                                     {command.massSigma_kg.has_value(), "--mass-sigma"},
                                                     {command.seed.has_value(), "--seed"},
                                                     {command.tilt_deg.has_value(), "--gravity-tilt"},
                                                     {command.direction_deg.has_value(), "--gravity-direction"},
                                                     {!command.remove.empty(), "--remove"},
                                                     {!command.pull.empty(), "--pull"},
                                                     {command.noRemovals, "--no-removals"},
                                                     {command.contacts, "--contacts"},
                                                     {command.report.has_value(), "--report"}};
  for (const auto& [isGiven, name] : given) {
    if (isGiven) throw InputError(fmt::format("{}: expected with one scene only, got it with a list of towers", name));
  }
}

}  // namespace

CLI::App* defineStatics(CLI::App& program, StaticsCommand& command) {
  CLI::App* statics =
      program.add_subcommand("statics", "says by equilibrium alone whether a scene can stand, and by what margin");
  statics
      ->add_option("SCENE", command.scene,
                   "NAME:SIZE such as tower:18, a bit code or a .toml file, as for run; or a list of towers, FILE.jsonl or - for "
                   "standard input")
      ->type_name("")
      ->required();
  addNumber(*statics, "--mu", command.friction, kFrictionRange, "MU", "coefficient of friction (default 0.4)");
  addNumber(*statics, "--heights-sigma", command.heightsSigma_m, kHeightsSigmaRange, "METRES",
            "standard deviation of the heights of a tower's blocks");
  addNumber(*statics, "--mass-sigma", command.massSigma_kg, kMassSigmaRange, "KG",
            "standard deviation of the masses of a tower's blocks");
  addWholeNumber(*statics, "--seed", command.seed, kSeedRange, "seed of --heights-sigma and --mass-sigma (default 1)");
  addNumber(*statics, "--gravity-tilt", command.tilt_deg, kTiltRange, "DEG", "gravity leans this far from straight down");
  addNumber(*statics, "--gravity-direction", command.direction_deg, kDirectionRange, "DEG",
            "side towards which gravity leans, from +x over +y (default 0)");
  statics->add_option("--remove", command.remove, "takes a block out first, ROW:POSITION or its number; may be repeated")
      ->type_name("BLOCK")
      ->allow_extra_args(false);
  statics
      ->add_option("--pull", command.pull, "finds the greatest force along an axis (+x, -y, ...) that statics allows on a block")
      ->type_name("BLOCK,AXIS")
      ->allow_extra_args(false);
  statics->add_flag("--contacts", command.contacts, "prints a table of the contacts, too");
  statics->add_flag("--no-removals", command.noRemovals, "leaves out what taking each block out would do, the longest part");
  statics->add_option("--report", command.report, "writes all figures as JSON")->type_name("FILE.json");
  statics->add_flag("--check", command.check,
                    "for a list: prints how many answers agree with what is expected; exit code 1 if one differs");
  statics->add_flag("--keep-going", command.keepGoing,
                    "for a list: reports a bad line on standard error, leaves it out and goes on; exit code 2 at the end");
  addWholeNumber(*statics, "--threads", command.threads, kThreadsRange, "threads to use (default: one for each processor)");
  wrapDescriptions(*statics);
  statics->footer(std::string(kHelp));
  return statics;
}

BlockId blockNamed(const Scene& scene, const std::string& text, const std::string& option) {
  const auto number = [](std::string_view digits) -> std::optional<int> {
    int value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size()) return {};
    return value;
  };
  const std::size_t colon = text.find(':');
  const std::optional<int> first = number(std::string_view(text).substr(0, colon));
  if (colon == std::string::npos) {
    if (first && *first >= 0 && static_cast<std::size_t>(*first) < scene.blocks.size()) {
      return blockId(static_cast<std::size_t>(*first));
    }
  } else {
    const std::optional<int> second = number(std::string_view(text).substr(colon + 1));
    for (std::size_t b = 0; b < scene.blocks.size() && first && second && *first >= 0; ++b) {
      if (scene.blocks[b].row == *first && scene.blocks[b].position == *second) return blockId(b);
    }
  }
  throw InputError(
      fmt::format("{}: expected ROW:POSITION of a block that is there (rows from 0, positions from 1), or a block's "
                  "number, 0 to {}, got {}",
                  option, scene.blocks.size() - 1, inQuotes(text)));
}

int executeStatics(const StaticsCommand& command) {
  const int threads = command.threads ? static_cast<int>(*command.threads) : tbb::info::default_concurrency();
  if (isList(command.scene)) {
    checkListOptions(command);
    return executeStaticsList(command.scene, command.check, command.keepGoing, threads);
  }
  if (command.check) {
    throw InputError(fmt::format("--check: expected a list, FILE.jsonl or -, got the scene {}", inQuotes(command.scene)));
  }
  if (command.keepGoing) {
    throw InputError(fmt::format("--keep-going: expected a list, FILE.jsonl or -, got the scene {}", inQuotes(command.scene)));
  }
  const Scene scene = sceneOf(command);
  const auto report = command.report ? std::make_unique<OutputFile>(*command.report, "--report") : nullptr;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  const StaticsAnswer answer = answerOf(scene, command);
  if (report) {
    report->stream() << jsonText(staticsJson(scene, answer), 2) << '\n';
    report->commit();
  }
  printStatics(scene, answer, command.contacts);
  return answer.interrupted ? interruptionExitCode() : 0;
}

}  // namespace springtower
