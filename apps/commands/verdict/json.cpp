#include "apps/commands/verdict/json.h"

#include "core/error.h"
#include "core/limits.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

// The library parses any depth, but copies and prints by recursion, which ends the program where there is very much of it.
constexpr int kMaxNesting = 32;

// Follows the parser through a line and refuses what the parser would let pass.
class ParseCheck {
 public:
  explicit ParseCheck(const std::string& where) : where_(where) {}

  void see(int depth, Json::parse_event_t event, const Json& parsed) {
    const bool opens = event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
    if (opens && depth == kMaxNesting) {
      throw InputError(fmt::format("{}: expected at most {} levels of nesting, got more", place(), kMaxNesting));
    }
    if (event == Json::parse_event_t::object_start) keys_.emplace_back();
    if (event == Json::parse_event_t::object_end) keys_.pop_back();
    if (event != Json::parse_event_t::key) return;
    const auto& key = parsed.get_ref<const std::string&>();
    if (!keys_.back().insert(key).second) {
      throw InputError(fmt::format("{}: expected each key once, got {} for the second time", keys_.size() == 1 ? where_ : place(),
                                   inQuotes(key)));
    }
    if (keys_.size() == 1) outermost_ = key;
  }

 private:
  [[nodiscard]] std::string place() const {
    return outermost_.empty() ? where_ : fmt::format("{}: in {}", where_, inQuotes(outermost_));
  }

  const std::string& where_;
  std::vector<std::set<std::string>> keys_;  // of the objects that are open
  std::string outermost_;                    // the key of the line under which the parser is
};

}  // namespace

bool isBlankLine(std::string_view text) {
  return text.find_first_not_of(" \t\r") == std::string_view::npos;
}

Json parseVerdictLine(const std::string& text, const std::string& where) {
  ParseCheck watch(where);
  try {
    return Json::parse(text, [&](int depth, Json::parse_event_t event, Json& parsed) {
      watch.see(depth, event, parsed);
      return true;
    });
  } catch (const Json::exception&) {
    throw InputError(fmt::format("{}: expected a JSON object, got {}", where, inQuotes(text)));
  }
}

}  // namespace springtower
