#include "apps/commands/scenes/command.h"

#include "scenarios/registry.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <string>
#include <string_view>

namespace springtower {
namespace {

constexpr std::string_view kScenesExamples =
    R"help(A scene is named wherever a command or the viewer takes one, with its size or without. Beside these there are bit codes, rows
from the bottom with 1 for a block, 0 for none and L for one that is 0.3 mm lower, and .toml files.
examples:
  springtower scenes
  springtower run wall:20x12 --seconds 5
  springtower run thrown
  springtower statics tower:18)help";

}  // namespace

CLI::App* defineScenes(CLI::App& program) {
  CLI::App* scenes = program.add_subcommand("scenes", "lists the scenes that have a name, and their sizes");
  scenes->footer(std::string(kScenesExamples));
  return scenes;
}

int executeScenes() {
  std::size_t usageWidth = 0;
  std::size_t whatWidth = 0;
  for (const Scenario& scenario : scenarios()) {
    usageWidth = std::max(usageWidth, usageOf(scenario).size());
    whatWidth = std::max(whatWidth, scenario.what.size());
  }
  fmt::print("{:{}}  {:{}}  size if none is given; sizes allowed\n", "scene", usageWidth, "what it is", whatWidth);
  for (const Scenario& scenario : scenarios()) {
    const std::string usual = sizeText(scenario, usualSize(scenario));
    const std::string sizes = usual.empty() ? "has none" : fmt::format("{}; {}", usual, allowedSizes(scenario));
    fmt::print("{:{}}  {:{}}  {}\n", usageOf(scenario), usageWidth, scenario.what, whatWidth, sizes);
  }
  return 0;
}

}  // namespace springtower
