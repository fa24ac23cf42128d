#include "apps/commands/verdict/json.h"
#include "apps/commands/verdict/json_object.h"
#include "apps/commands/verdict/verdict.h"
#include "core/error.h"
#include "core/line_input.h"

#include <cmath>
#include <fmt/format.h>
#include <istream>
#include <nlohmann/json.hpp>
#include <set>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

// The tower of a line, built key by key, so that a complaint names the key that is to blame.
Scene readTower(const std::string& code, const TowerOptions& options, const std::string& where) {
  const char* key = "config";
  try {
    Scene scene = bitCodeScene(code);
    if (!options.offsets.empty()) {
      key = "offsets_m";
      TowerOptions shifts;
      shifts.offsets = options.offsets;
      scene = bitCodeScene(code, shifts);
    }
    if (!options.loose.empty()) {
      key = "lower_m";
      scene = bitCodeScene(code, options);
    }
    return scene;
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}: {}", where, key, error.what()));
  }
}

VerdictLine readLine(const Json& json, const std::string& where) {
  const JsonObject object(json, where,
                          {"id", "config", "mu", "offsets_m", "lower_m", "gravity_tilt_deg", "gravity_direction_deg", "expect"});
  TowerOptions options;
  for (const JsonObject& offset : object.list("offsets_m", {"row", "position", "dx", "dy"})) {
    options.offsets.push_back({offset.wholeNumber("row", 0, kMaxRows - 1), offset.wholeNumber("position", 1, 3),
                               offset.number("dx", kOffsetRange, 0.0), offset.number("dy", kOffsetRange, 0.0)});
  }
  for (const JsonObject& loose : object.list("lower_m", {"row", "position", "by"})) {
    options.loose.push_back({loose.wholeNumber("row", 0, kMaxRows - 1), loose.wholeNumber("position", 1, 3),
                             loose.number("by", kLooseRange, LooseBlock{}.by)});
  }
  VerdictLine line;
  line.id = object.text("id");
  line.scene = readTower(object.text("config"), options, where);
  line.scene.staticFriction = object.number("mu", kFrictionRange, line.scene.staticFriction);
  line.scene.kineticFriction = line.scene.staticFriction;
  line.scene.gravity.tilt_deg = object.number("gravity_tilt_deg", kTiltRange, 0.0);
  line.scene.gravity.direction_deg = object.number("gravity_direction_deg", kDirectionRange, 0.0);
  if (object.has("expect")) line.expect = json.at("expect");
  return line;
}

}  // namespace

VerdictLine readVerdictLine(const std::string& text, std::size_t number, const std::string& where, std::set<std::string>& ids) {
  VerdictLine line = readLine(parseVerdictLine(text, where), where);
  line.number = number;
  if (!ids.insert(line.id).second) {
    throw InputError(fmt::format("{}: id: expected each one once, got {} for the second time", where, inQuotes(line.id)));
  }
  return line;
}

std::vector<VerdictLine> readVerdictLines(std::istream& input, const std::string& source) {
  std::vector<VerdictLine> lines;
  std::set<std::string> ids;
  std::string text;
  for (std::size_t number = 1;; ++number) {
    const std::string where = fmt::format("{}: line {}", source, number);
    if (!readLine(input, text, where)) break;
    if (!isBlankLine(text)) lines.push_back(readVerdictLine(text, number, where, ids));
  }
  if (input.bad()) throw InputError(fmt::format("{}: reading failed", source));
  return lines;
}

bool isClear(const VerdictLine& line) {
  const Json& expect = line.expect;
  return expect.is_object() && expect.contains("clear") && expect.at("clear") == true && expect.contains("stands") &&
         expect.at("stands").is_boolean();
}

}  // namespace springtower
