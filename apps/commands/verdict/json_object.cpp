#include "apps/commands/verdict/json_object.h"

#include "core/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

std::string shownValue(const Json& value) {
  return inQuotes(value.dump(-1, ' ', true, Json::error_handler_t::replace));
}

}  // namespace

JsonObject::JsonObject(const Json& json, std::string where, std::initializer_list<std::string_view> keys)
    : json_(json), where_(std::move(where)) {
  if (!json.is_object()) fail("", shownValue(json), "an object");
  for (const auto& [key, value] : json.items()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    std::string allowed;
    for (const std::string_view name : keys) allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", name);
    throw InputError(fmt::format("{}: expected {}, got the unknown key {}", where_, allowed, inQuotes(key)));
  }
}

std::string JsonObject::text(const char* key) const {
  const Json& value = required(key);
  if (!value.is_string()) fail(key, shownValue(value), "a text");
  return value.get<std::string>();
}

double JsonObject::number(const char* key, const Range& range, std::optional<double> otherwise) const {
  if (otherwise && !has(key)) return *otherwise;
  const Json& value = required(key);
  if (!value.is_number() || !isInside(value.get<double>(), range))
    fail(key, shownValue(value), "a number from " + describe(range));
  return value.get<double>();
}

int JsonObject::wholeNumber(const char* key, int least, int most) const {
  const Json& value = required(key);
  if (!value.is_number_integer() || value.get<double>() < least || value.get<double>() > most) {
    fail(key, shownValue(value), fmt::format("a whole number from {} to {}", least, most));
  }
  return value.get<int>();
}

std::vector<JsonObject> JsonObject::list(const char* key, std::initializer_list<std::string_view> keys) const {
  std::vector<JsonObject> objects;
  if (!has(key)) return objects;
  const Json& values = json_.at(key);
  if (!values.is_array()) fail(key, shownValue(values), "a list of objects");
  for (std::size_t i = 0; i < values.size(); ++i)
    objects.emplace_back(values[i], fmt::format("{}: {}[{}]", where_, key, i), keys);
  return objects;
}

std::vector<bool> JsonObject::flags(const char* key) const {
  const Json& values = required(key);
  const bool good =
      values.is_array() && std::all_of(values.begin(), values.end(), [](const Json& value) { return value.is_boolean(); });
  if (!good) fail(key, shownValue(values), "a list of true and false");
  return values.get<std::vector<bool>>();
}

const Json& JsonObject::required(const char* key) const {
  if (!has(key)) throw InputError(fmt::format("{}: expected the key {}, got none", where_, key));
  return json_.at(key);
}

void JsonObject::fail(std::string_view key, std::string_view found, std::string_view allowed) const {
  throw InputError(fmt::format("{}{}{}: expected {}, got {}", where_, key.empty() ? "" : ": ", key, allowed, found));
}

}  // namespace springtower
