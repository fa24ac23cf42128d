#pragma once

#include "core/limits.h"

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace springtower {

/// A JSON object of a line, read key by key. What is wrong with a value is thrown as an InputError of the line and the key, with
/// what is expected and what it got. Refers to the JSON, which must outlive it.
class JsonObject {
 public:
  /// Throws InputError where `json` is no object or has a key that is not among `keys`. `where` begins all messages.
  JsonObject(const nlohmann::ordered_json& json, std::string where, std::initializer_list<std::string_view> keys);

  [[nodiscard]] bool has(const char* key) const { return json_.contains(key); }

  [[nodiscard]] std::string text(const char* key) const;

  /// A number inside of `range`; `otherwise` where there is one and the key is missing.
  [[nodiscard]] double number(const char* key, const Range& range, std::optional<double> otherwise = {}) const;

  /// A whole number from `least` to `most`.
  [[nodiscard]] int wholeNumber(const char* key, int least, int most) const;

  /// The objects of a list, none where the key is missing. `keys` are theirs.
  [[nodiscard]] std::vector<JsonObject> list(const char* key, std::initializer_list<std::string_view> keys) const;

  /// A list of true and false, which has to be there.
  [[nodiscard]] std::vector<bool> flags(const char* key) const;

 private:
  [[nodiscard]] const nlohmann::ordered_json& required(const char* key) const;
  [[noreturn]] void fail(std::string_view key, std::string_view found, std::string_view allowed) const;

  const nlohmann::ordered_json& json_;
  std::string where_;
};

}  // namespace springtower
