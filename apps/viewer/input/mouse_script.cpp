#include "apps/viewer/input/mouse_script.h"

#include "core/error.h"
#include "core/limits.h"
#include "core/line_input.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <sstream>
#include <string_view>

namespace springtower {
namespace {

constexpr std::array<std::string_view, 5> kActNames = {"", "press", "release", "hints", "skip"};

}  // namespace

std::vector<MouseStep> readMouseScript(const std::string& path) {
  LineInput file(path, "--mouse");
  std::vector<MouseStep> script;
  for (std::string line; file.next(line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words(line);
    MouseStep step;
    std::string act;
    std::string rest;
    const bool good = static_cast<bool>(words >> step.picture >> step.x >> step.y);
    words >> act >> rest;
    const auto* name = std::find(kActNames.begin(), kActNames.end(), act);
    const bool ascends = script.empty() || script.back().picture <= step.picture;
    if (!good || name == kActNames.end() || !rest.empty() || !ascends) {
      throw InputError(
          fmt::format("{}: expected PICTURE X Y and press, release, hints, skip or nothing, the pictures "
                      "ascending, got {}",
                      file.where(), inQuotes(line)));
    }
    step.act = static_cast<MouseAct>(name - kActNames.begin());
    script.push_back(step);
  }
  if (script.empty()) throw InputError(fmt::format("{}: expected at least one step, got none", onOneLine(path)));
  return script;
}

Eigen::Vector2d mouseAt(const std::vector<MouseStep>& script, std::uint64_t picture) {
  const auto after = std::find_if(script.begin(), script.end(), [&](const MouseStep& step) { return step.picture >= picture; });
  if (after == script.end()) return {script.back().x, script.back().y};
  if (after == script.begin()) return {after->x, after->y};
  const MouseStep& before = *(after - 1);
  const double share = static_cast<double>(picture - before.picture) / static_cast<double>(after->picture - before.picture);
  return {before.x + share * (after->x - before.x), before.y + share * (after->y - before.y)};
}

std::vector<MouseAct> mouseActs(const std::vector<MouseStep>& script, std::uint64_t picture) {
  std::vector<MouseAct> acts;
  for (const MouseStep& step : script) {
    if (step.picture == picture && step.act != MouseAct::none) acts.push_back(step.act);
  }
  return acts;
}

}  // namespace springtower
