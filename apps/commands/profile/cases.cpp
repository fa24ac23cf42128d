#include "apps/commands/profile/cases.h"

#include "apps/commands/profile/falls.h"
#include "apps/commands/profile/stacks.h"
#include "apps/common/options.h"
#include "core/error.h"
#include "core/limits.h"
#include "scenarios/recorded/recorded_game.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <optional>
#include <string>
#include <string_view>

namespace springtower {
namespace {

constexpr Range kProfileRowsRange{1, kMaxRows, ""};
constexpr Range kTowersRange{1, 2000, ""};
constexpr Range kToleranceRange{1e-7, 1e-2, "m"};
constexpr double kFullPeer_s = 60.0;
constexpr int kTowersRows = 18;
constexpr int kGameRows = 18;  // the recorded game's

std::string offered(const auto& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

double numberFrom(const std::string& text, const Range& range, std::string_view option, bool whole) {
  const std::optional<double> value = parseNumber(text);
  if (value && isInside(*value, range) && (!whole || *value == std::floor(*value))) return *value;
  throw InputError(fmt::format("{}: expected {}numbers with commas between, {}, got {}", option, whole ? "whole " : "",
                               describe(range), inQuotes(text)));
}

// A list as given, or its default; no value twice.
std::vector<double> numbers(const std::vector<std::string>& texts, const Range& range, std::string_view option, bool whole,
                            std::vector<double> otherwise) {
  if (texts.empty()) return otherwise;
  std::vector<double> values;
  for (const std::string& text : texts) {
    const double value = numberFrom(text, range, option, whole);
    if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
  }
  return values;
}

ProfileExtent extentOf(const ProfileCommand& command) {
  return command.quick ? ProfileExtent::quick : command.full ? ProfileExtent::full : ProfileExtent::usual;
}

// The named cases of a scene: as given, or the usual ones.
std::vector<std::string> namedOf(const ProfileCommand& command, ProfileScene scene) {
  const bool falls = isFall(scene);
  const std::vector<std::string>& given = falls ? command.falls : command.stacks;
  if (given.empty()) return falls ? fallsOf(scene, extentOf(command)) : stacksOf(scene, extentOf(command));
  std::vector<std::string> names;
  for (const std::string& text : given) {
    const std::string name = falls ? fallFrom(text) : stackFrom(text);
    const ProfileScene its = falls ? fallFamilyOf(name).scene : familyOf(name).scene;
    if (its == scene && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::vector<ProfileScene> scenesOf(const ProfileCommand& command) {
  if (command.scenes.empty() && !(command.stacks.empty() && command.falls.empty())) {
    std::vector<ProfileScene> scenes;
    for (std::size_t i = 0; i < kProfileSceneNames.size(); ++i) {
      const auto scene = static_cast<ProfileScene>(i);
      const bool given = (isStack(scene) && !command.stacks.empty()) || (isFall(scene) && !command.falls.empty());
      if (given && !namedOf(command, scene).empty()) scenes.push_back(scene);
    }
    return scenes;
  }
  if (command.scenes.empty()) {
    if (command.quick) return {ProfileScene::rest, ProfileScene::collapse};
    return {ProfileScene::rest,     ProfileScene::pull,   ProfileScene::game,
            ProfileScene::collapse, ProfileScene::asleep, ProfileScene::towers};
  }
  std::vector<ProfileScene> scenes;
  for (const std::string& name : command.scenes) {
    const auto* const found = std::find(kProfileSceneNames.begin(), kProfileSceneNames.end(), name);
    if (found == kProfileSceneNames.end()) {
      throw InputError(fmt::format("--scenes: expected {}, got {}", offered(kProfileSceneNames), inQuotes(name)));
    }
    const auto scene = static_cast<ProfileScene>(found - kProfileSceneNames.begin());
    if (std::find(scenes.begin(), scenes.end(), scene) == scenes.end()) scenes.push_back(scene);
  }
  return scenes;
}

// As given, or the default one; of the recorded game that with which it was played.
std::vector<double> tolerancesOf(const ProfileCommand& command, ProfileScene scene) {
  const double usual_m = scene == ProfileScene::game ? toleranceOf(recordedTower()) : kBlockTolerance_m;
  return numbers(command.tolerances_m, kToleranceRange, "--tolerances", false, {usual_m});
}

// As given, or the usual method, beside which a tower at rest also shows the report's for comparison.
std::vector<Method> methodsOf(const ProfileCommand& command, ProfileScene scene) {
  if (command.methods.empty()) {
    std::vector<Method> methods = {Settings{}.method};
    if (scene == ProfileScene::rest) methods.push_back(Method::report);
    return methods;
  }
  std::vector<Method> methods;
  for (const std::string& name : command.methods) {
    const Method method = methodFromName(name, "--methods");
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
  }
  return methods;
}

}  // namespace

ProfileLimits limitsOf(const ProfileCommand& command) {
  ProfileLimits limits;
  if (command.quick) limits = {2, 20, 1.0, 2.0, 0.3, 0.5};
  if (command.full) limits.peer_s = kFullPeer_s;
  if (command.samples) limits.samples = static_cast<int>(*command.samples);
  if (command.frames) limits.frames = static_cast<int>(*command.frames);
  if (command.settle_s) limits.settle_s = *command.settle_s;
  if (command.prepare_s) limits.prepare_s = *command.prepare_s;
  if (command.sample_s) limits.sample_s = *command.sample_s;
  if (command.peer_s) limits.peer_s = *command.peer_s;
  return limits;
}

std::vector<ProfileCase> casesOf(const ProfileCommand& command) {
  const std::vector<double> usualRows =
      command.quick ? std::vector<double>{3, 6, 9, 18} : std::vector<double>{3, 6, 9, 12, 18, 24, 36, 54, 72};
  const std::vector<double> rows = numbers(command.rows, kProfileRowsRange, "--rows", true, usualRows);
  const std::vector<double> towers = numbers(command.towers, kTowersRange, "--towers", true, {1, 4, 16, 64});
  const std::vector<double> threads = numbers(command.threads, kThreadsRange, "--threads", true, {1});
  const Inertia inertia = command.inertia ? inertiaFromName(*command.inertia, "--inertia") : Settings{}.inertia;
  std::vector<ProfileCase> cases;
  for (const ProfileScene scene : scenesOf(command)) {
    const bool many = scene == ProfileScene::towers;
    const std::vector<Method> methods = methodsOf(command, scene);
    const std::vector<double> tolerances = tolerancesOf(command, scene);
    const auto addAll = [&](ProfileCase what, const std::vector<double>& counts) {
      for (const Method method : methods) {
        for (const double tolerance : tolerances) {
          for (const double count : counts) {
            what.method = method;
            what.inertia = inertia;
            what.tolerance_m = tolerance;
            what.threads = static_cast<int>(count);
            cases.push_back(what);
          }
        }
      }
    };
    if (isNamed(scene)) {
      for (const std::string& name : namedOf(command, scene))
        addAll({.scene = scene, .rows = 1, .named = name}, command.threads.empty() ? std::vector<double>{1, 2} : threads);
      continue;
    }
    if (scene == ProfileScene::game) {
      addAll({.scene = scene, .rows = kGameRows}, threads);
      continue;
    }
    for (const double size : many ? towers : rows) {
      const int whole = static_cast<int>(size);
      addAll({.scene = scene, .rows = many ? kTowersRows : whole, .towers = many ? whole : 1}, threads);
    }
  }
  return cases;
}

}  // namespace springtower
