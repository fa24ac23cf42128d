#pragma once

#include "core/scene/scene.h"

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace springtower {

/// One number of a scene's size.
struct SizeNumber {
  std::string_view what = {};  ///< what it counts, in the plural; empty: there is no such number
  int usual = 0;               ///< default, without a size after the name
  int least = 0;
  int most = 0;
};

/// The numbers of a size, in the order of notation; those that a scene does not have are 0.
using ScenarioSize = std::array<int, 2>;

/// A kind of scene with a name, common to the command line, the viewer, charts and tests.
struct Scenario {
  std::string_view name;  ///< letters and hyphens
  std::string_view what;  ///< one sentence, without its full stop
  std::array<SizeNumber, 2> numbers;
  bool isTower;  ///< takes TowerOptions
  Scene (*make)(const ScenarioSize& size, const TowerOptions& options);
};

/// All scenarios, in the order of listing.
std::span<const Scenario> scenarios();

/// The scenario with a name, or null.
const Scenario* findScenario(std::string_view name);

/// The default size.
ScenarioSize usualSize(const Scenario& scenario);

/// A size in its notation: `18` of a tower, `20x12` of a wall; empty where there is none.
std::string sizeText(const Scenario& scenario, const ScenarioSize& size);

/// Notation, such as `wall:COLUMNSxCOURSES`; only the name where it has no size.
std::string usageOf(const Scenario& scenario);

/// The allowed sizes, such as `1 to 900 columns, 1 to 100 courses`; empty where it has none.
std::string allowedSizes(const Scenario& scenario);

/// Makes the scene; its name is the notation. Throws InputError for a size or options that are not allowed.
Scene makeScene(const Scenario& scenario, const ScenarioSize& size, const TowerOptions& options = {});

/// A scene from a user's argument: `NAME` or `NAME:SIZE` of the above, a bit code, or a TOML file. A scenario takes precedence
/// over a file of the same name, which can be given by its path (./wall). Throws InputError; for an unknown name it lists
/// everything that is allowed.
Scene sceneNamed(const std::string& name, const TowerOptions& options = {});

}  // namespace springtower
