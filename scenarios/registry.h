#pragma once

#include "core/scene/scene.h"

#include <array>
#include <span>
#include <string>
#include <string_view>

namespace springtower {

/// One number of a scene's size.
struct SizeNumber {
  std::string_view what = {};  ///< that it counts, in the plural; empty: there is no such number
  int usual = 0;               ///< without a size after the name
  int least = 0;
  int most = 0;
};

/// The numbers of a size, in the order in which they are written; those that a scene does not have are 0.
using ScenarioSize = std::array<int, 2>;

/// A kind of scene that has a name: the command line, the viewer, charts and tests draw on the same ones.
struct Scenario {
  std::string_view name;  ///< letters and hyphens
  std::string_view what;  ///< one sentence, without its full stop
  std::array<SizeNumber, 2> numbers;
  bool isTower;  ///< takes TowerOptions
  Scene (*make)(const ScenarioSize& size, const TowerOptions& options);
};

/// All of them, in the order in which they are listed.
std::span<const Scenario> scenarios();

/// The scenario of a name, or null.
const Scenario* findScenario(std::string_view name);

/// The size it has unless told otherwise.
ScenarioSize usualSize(const Scenario& scenario);

/// A size as it is written: `18` of a tower, `20x12` of a wall; empty where there is none.
std::string sizeText(const Scenario& scenario, const ScenarioSize& size);

/// How it is written, such as `wall:COLUMNSxCOURSES`; the name alone where it has no size.
std::string usageOf(const Scenario& scenario);

/// The sizes that are allowed, such as `1 to 900 columns, 1 to 100 courses`; empty where it has none.
std::string allowedSizes(const Scenario& scenario);

/// Makes the scene, named as it is written. Throws InputError for a size or options that are not allowed.
Scene makeScene(const Scenario& scenario, const ScenarioSize& size, const TowerOptions& options = {});

/// A scene from what a user names: `NAME` or `NAME:SIZE` of the above, a bit code, or a TOML file. A name goes before a file that
/// is called the same, which is found by its path (./wall). Throws InputError, for an unknown name with all that is allowed.
Scene sceneNamed(const std::string& name, const TowerOptions& options = {});

}  // namespace springtower
