#include "apps/commands/verdict/json.h"
#include "apps/commands/verdict/verdict.h"
#include "core/error.h"
#include "core/line_input.h"

#include <cmath>
#include <fmt/format.h>
#include <initializer_list>
#include <istream>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

// A JSON object whose complaints name the line and the key.
class Object {
 public:
  Object(const Json& json, std::string where, std::initializer_list<std::string_view> keys)
      : json_(json), where_(std::move(where)) {
    if (!json.is_object()) fail("", shown(json), "an object");
    for (const auto& [key, value] : json.items()) {
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      std::string allowed;
      for (const std::string_view name : keys) allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", name);
      throw InputError(fmt::format("{}: found the unknown key {}, allowed are {}", where_, inQuotes(key), allowed));
    }
  }

  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }

  [[nodiscard]] std::string text(const char* key) const {
    const Json& value = required(key);
    if (!value.is_string()) fail(key, shown(value), "a text");
    return value.get<std::string>();
  }

  [[nodiscard]] double number(const char* key, const Range& range, std::optional<double> otherwise = {}) const {
    if (otherwise && !has(key)) return *otherwise;
    const Json& value = required(key);
    if (!value.is_number() || !isInside(value.get<double>(), range)) fail(key, shown(value), "a number, " + describe(range));
    return value.get<double>();
  }

  [[nodiscard]] int wholeNumber(const char* key, int least, int most) const {
    const Json& value = required(key);
    if (!value.is_number_integer() || value.get<double>() < least || value.get<double>() > most) {
      fail(key, shown(value), fmt::format("a whole number, {} to {}", least, most));
    }
    return value.get<int>();
  }

  // The objects of a list, if it is there.
  [[nodiscard]] std::vector<Object> list(const char* key, std::initializer_list<std::string_view> keys) const {
    std::vector<Object> objects;
    if (!has(key)) return objects;
    const Json& values = json_.at(key);
    if (!values.is_array()) fail(key, shown(values), "a list of objects");
    for (std::size_t i = 0; i < values.size(); ++i)
      objects.emplace_back(values[i], fmt::format("{}: {}[{}]", where_, key, i), keys);
    return objects;
  }

 private:
  [[nodiscard]] const Json& required(const char* key) const {
    if (!has(key)) throw InputError(fmt::format("{}: the key {} is missing", where_, key));
    return json_.at(key);
  }

  static std::string shown(const Json& value) { return inQuotes(value.dump(-1, ' ', true, Json::error_handler_t::replace)); }

  [[noreturn]] void fail(std::string_view key, std::string_view found, std::string_view allowed) const {
    throw InputError(fmt::format("{}{}{}: found {}, allowed is {}", where_, key.empty() ? "" : ": ", key, found, allowed));
  }

  const Json& json_;
  std::string where_;
};

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
  const Object object(json, where,
                      {"id", "config", "mu", "offsets_m", "lower_m", "gravity_tilt_deg", "gravity_direction_deg", "expect"});
  TowerOptions options;
  for (const Object& offset : object.list("offsets_m", {"row", "position", "dx", "dy"})) {
    options.offsets.push_back({offset.wholeNumber("row", 0, kMaxRows - 1), offset.wholeNumber("position", 1, 3),
                               offset.number("dx", kOffsetRange, 0.0), offset.number("dy", kOffsetRange, 0.0)});
  }
  for (const Object& loose : object.list("lower_m", {"row", "position", "by"})) {
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
    throw InputError(fmt::format("{}: id: found {} for the second time, allowed is once", where, inQuotes(line.id)));
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
