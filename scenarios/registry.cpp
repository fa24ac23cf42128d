#include "scenarios/registry.h"

#include "core/error.h"
#include "core/limits.h"
#include "scenarios/falling.h"
#include "scenarios/loose.h"
#include "scenarios/towers.h"
#include "scenarios/walls.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <filesystem>
#include <fmt/format.h>
#include <optional>

namespace springtower {
namespace {

constexpr double kSway_deg = 0.1;
constexpr double kSway_hz = 1.0;
constexpr double kHeavyFactor = 10.0;
constexpr double kRowsFall_m = 0.02;

constexpr SizeNumber kNone = {};

constexpr SizeNumber rows(int usual) {
  return {"rows", usual, 1, kMaxRows};
}

constexpr SizeNumber towers(int usual) {
  return {"towers", usual, 1, 1800};  // limited by the number of blocks of a scene
}

TowerOptions uneven(TowerOptions options) {
  if (!options.heightsSigma_m) options.heightsSigma_m = kUnevenHeightsSigma_m;
  return options;
}

Scene swayingTower(const ScenarioSize& size, const TowerOptions& options) {
  return swaying(towerScene(size[0], options), kSway_deg, kSway_hz);
}

Scene heavyTower(const ScenarioSize& size, const TowerOptions& options) {
  return withHeavyRows(towerScene(size[0], options), kHeavyFactor);
}

Scene collapsingTower(const ScenarioSize& size, const TowerOptions& options) {
  return leaning(towerScene(size[0], options), collapseTilt_deg(size[0]));
}

constexpr Scenario kScenarios[] = {
    {"tower",
     "a full tower, each row a quarter turn against the one below",
     {rows(18), kNone},
     true,
     [](const ScenarioSize& size, const TowerOptions& options) { return towerScene(size[0], options); }},
    {"uneven",
     "a full tower of blocks whose heights vary by 0.2 mm",
     {rows(18), kNone},
     true,
     [](const ScenarioSize& size, const TowerOptions& options) { return towerScene(size[0], uneven(options)); }},
    {"swaying", "a full tower while gravity swings by 0.1 degrees once a second", {rows(18), kNone}, true, swayingTower},
    {"heavy", "a full tower with every other row ten times as heavy", {rows(18), kNone}, true, heavyTower},
    {"holes",
     "a tower of twelve rows, half of them with blocks missing",
     {kNone, kNone},
     true,
     [](const ScenarioSize&, const TowerOptions& options) { return towerWithHolesScene(options); }},
    {"collapse", "a tower that leans beyond its stability margin and topples", {rows(18), kNone}, true, collapsingTower},
    {"falling-rows",
     "rows that fall together from 2 cm",
     {rows(3), kNone},
     true,
     [](const ScenarioSize& size, const TowerOptions& options) { return raised(towerScene(size[0], options), kRowsFall_m); }},
    {"towers",
     "full towers of 18 rows on a square, 0.3 m apart",
     {towers(64), kNone},
     true,
     [](const ScenarioSize& size, const TowerOptions& options) { return squareOf(towerScene(18, options), size[0]); }},
    {"touching",
     "full towers of 18 rows end against end",
     {towers(5), kNone},
     true,
     [](const ScenarioSize& size, const TowerOptions& options) { return touchingTowersScene(size[0], options); }},
    {"shot",
     "a block flies at a tower, lengthwise at 5 m/s",
     {rows(6), kNone},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return shotTowerScene(size[0]); }},
    {"sleeper",
     "a block falls from 21 m onto two rows that sleep by then",
     {kNone, kNone},
     false,
     [](const ScenarioSize&, const TowerOptions&) { return sleeperHitScene(); }},
    {"wall",
     "a wall of blocks in running bond, half blocks at the ends",
     {SizeNumber{"columns", 20, 1, 4000}, SizeNumber{"courses", 12, 1, 100}},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return wallScene(size[0], size[1]); }},
    {"pyramid",
     "a pyramid of blocks, each on two",
     {SizeNumber{"rows", 10, 1, 400}, kNone},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return pyramidScene(size[0]); }},
    {"bricks",
     "a pyramid of blocks laid across it, each on two",
     {SizeNumber{"rows", 10, 1, 400}, kNone},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return brickPyramidScene(size[0]); }},
    {"cubes",
     "a pyramid of cubes of 20 mm, each on two",
     {SizeNumber{"rows", 10, 1, 400}, kNone},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return cubePyramidScene(size[0]); }},
    {"pile",
     "square rows of 108 blocks, one island, landing after 10 cm",
     {SizeNumber{"rows", 3, 1, 900}, kNone},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return pileScene(size[0], {.fall_m = kPileFall_m}); }},
    {"heap",
     "blocks turned at random that fall from a lattice into a heap",
     {SizeNumber{"blocks", 200, 1, 20000}, kNone},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return heapScene(size[0]); }},
    {"rain",
     "blocks turned at random that land one after the other",
     {SizeNumber{"blocks", 200, 1, 20000}, kNone},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return rainScene(size[0]); }},
    {"askew",
     "blocks dropped on one another, each turned further",
     {SizeNumber{"blocks", 8, 1, kMaxAskewBlocks}, kNone},
     false,
     [](const ScenarioSize& size, const TowerOptions&) { return askewPileScene(size[0]); }},
    {"dropped-flat",
     "a block dropped flat from 4 cm",
     {kNone, kNone},
     false,
     [](const ScenarioSize&, const TowerOptions&) { return droppedBlockScene(0.05); }},
    {"dropped-on-corner",
     "a block that is dropped and meets the floor with a corner",
     {kNone, kNone},
     false,
     [](const ScenarioSize&, const TowerOptions&) { return droppedBlockScene(0.1, ontoACorner()); }},
    {"slope",
     "a block on a slope that is 1 % below the angle of friction",
     {kNone, kNone},
     false,
     [](const ScenarioSize&, const TowerOptions&) { return steepSlopeScene(); }},
    {"sliding",
     "a block that slides over the floor until friction stops it",
     {kNone, kNone},
     false,
     [](const ScenarioSize&, const TowerOptions&) { return slidingBlockScene(); }},
    {"spinning",
     "a block that tumbles without gravity and floor",
     {kNone, kNone},
     false,
     [](const ScenarioSize&, const TowerOptions&) { return spinningBlockScene(); }},
    {"thrown",
     "two blocks thrown at each other that meet in the air askew",
     {kNone, kNone},
     false,
     [](const ScenarioSize&, const TowerOptions&) { return thrownPairScene(); }},
    {"thin-wall",
     "a block thrown at a wall of thin blocks on edge",
     {kNone, kNone},
     false,
     [](const ScenarioSize&, const TowerOptions&) { return thinWallScene(); }},
};

std::size_t numberCount(const Scenario& scenario) {
  std::size_t count = 0;
  while (count < scenario.numbers.size() && !scenario.numbers[count].what.empty()) ++count;
  return count;
}

std::string nameWithSize(const Scenario& scenario, const std::string& size) {
  return size.empty() ? std::string(scenario.name) : fmt::format("{}:{}", scenario.name, size);
}

// Empty unless the text has as many whole numbers as the scene, with an x between them.
std::optional<ScenarioSize> parsedSize(const Scenario& scenario, std::string_view text) {
  ScenarioSize size{};
  const std::size_t count = numberCount(scenario);
  for (std::size_t n = 0; n < count; ++n) {
    if (n > 0) {
      if (!text.starts_with('x')) return {};
      text.remove_prefix(1);
    }
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size[n]);
    if (error != std::errc{}) return {};
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  }
  return text.empty() && count > 0 ? std::optional(size) : std::nullopt;
}

InputError sizeError(const Scenario& scenario, std::string_view found) {
  if (numberCount(scenario) == 0) {
    return InputError(fmt::format("{}: expected the name alone, got the size {}", scenario.name, inQuotes(found)));
  }
  return InputError(fmt::format("{}: expected {}, got the size {}", usageOf(scenario), allowedSizes(scenario), inQuotes(found)));
}

InputError unknownName(std::string_view name) {
  std::string allowed;
  for (const Scenario& scenario : scenarios()) allowed += usageOf(scenario) + ", ";
  return InputError(
      fmt::format("{}: expected {}a bit code such as (010)-(111), or a .toml file, got none of them", inQuotes(name), allowed));
}

}  // namespace

std::span<const Scenario> scenarios() {
  return kScenarios;
}

const Scenario* findScenario(std::string_view name) {
  const auto all = scenarios();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Scenario& scenario) { return scenario.name == name; });
  return found == all.end() ? nullptr : &*found;
}

ScenarioSize usualSize(const Scenario& scenario) {
  return {scenario.numbers[0].usual, scenario.numbers[1].usual};
}

std::string sizeText(const Scenario& scenario, const ScenarioSize& size) {
  std::string text;
  for (std::size_t n = 0; n < numberCount(scenario); ++n) text += fmt::format("{}{}", n == 0 ? "" : "x", size[n]);
  return text;
}

std::string usageOf(const Scenario& scenario) {
  std::string text;
  for (std::size_t n = 0; n < numberCount(scenario); ++n) {
    if (n > 0) text += 'x';
    for (const char letter : scenario.numbers[n].what)
      text += static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  }
  return nameWithSize(scenario, text);
}

std::string allowedSizes(const Scenario& scenario) {
  std::string text;
  for (std::size_t n = 0; n < numberCount(scenario); ++n) {
    const SizeNumber& number = scenario.numbers[n];
    text += fmt::format("{}{} to {} {}", n == 0 ? "" : ", ", number.least, number.most, number.what);
  }
  return text;
}

Scene makeScene(const Scenario& scenario, const ScenarioSize& size, const TowerOptions& options) {
  for (std::size_t n = 0; n < numberCount(scenario); ++n) {
    if (size[n] < scenario.numbers[n].least || size[n] > scenario.numbers[n].most) {
      throw sizeError(scenario, sizeText(scenario, size));
    }
  }
  const std::string name = nameWithSize(scenario, sizeText(scenario, size));
  const std::string_view given = firstGiven(options);
  if (!scenario.isTower && !given.empty()) {
    throw InputError(fmt::format("{}: expected a tower for {}, got another scene", name, given));
  }
  Scene scene = scenario.make(size, options);
  scene.name = name;
  checkScene(scene, name);
  return scene;
}

Scene sceneNamed(const std::string& name, const TowerOptions& options) {
  const std::size_t colon = name.find(':');
  const std::string_view head = std::string_view(name).substr(0, colon);
  const Scenario* scenario = findScenario(head);
  if (scenario == nullptr) {
    // An argument without dot and slash that is no file is taken as a name.
    std::error_code error;
    const bool isName =
        !name.starts_with('(') && name.find_first_of("./") == std::string::npos && !std::filesystem::exists(name, error);
    if (isName) throw unknownName(name);
    return sceneFromName(name, options);
  }
  if (colon == std::string::npos) return makeScene(*scenario, usualSize(*scenario), options);
  if (scenario->name == "tower") return sceneFromName(name, options);  // its own message explains the error
  const std::string_view text = std::string_view(name).substr(colon + 1);
  const std::optional<ScenarioSize> size = parsedSize(*scenario, text);
  if (!size) throw sizeError(*scenario, text);
  return makeScene(*scenario, *size, options);
}

}  // namespace springtower
