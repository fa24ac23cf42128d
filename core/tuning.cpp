#include "core/tuning.h"

#include <array>
#ifdef SPRINGTOWER_TUNING_FROM_FILE
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#endif

namespace springtower {

namespace {

#ifdef SPRINGTOWER_TUNING_FROM_FILE
#define TUNING_CONSTANT const
#else
#define TUNING_CONSTANT constexpr
#endif

// A row that begins a group has no name; what follows belongs to it.
TUNING_CONSTANT auto kRowsAndGroups = std::to_array<TuningRow>({
#define TUNING_GROUP(name) {name, "", "", 0.0, "", "", ""},
#define TUNING(type, name, value, unit, purpose, evidence) \
  {"", #name, #value, static_cast<double>(tuning::name), unit, purpose, evidence},
#include "core/tuning.def"
#undef TUNING
#undef TUNING_GROUP
});

constexpr auto kNames = std::to_array<std::string_view>({
#define TUNING_GROUP(name)
#define TUNING(type, name, value, unit, purpose, evidence) #name,
#include "core/tuning.def"
#undef TUNING
#undef TUNING_GROUP
});
constexpr std::size_t kCountOfRows = kNames.size();

constexpr std::array<TuningRow, kCountOfRows> rowsWithTheirGroups() {
  std::array<TuningRow, kCountOfRows> rows{};
  std::string_view group;
  std::size_t at = 0;
  for (TuningRow row : kRowsAndGroups) {
    if (row.name.empty()) {
      group = row.group;
      continue;
    }
    row.group = group;
    rows[at++] = row;
  }
  return rows;
}

TUNING_CONSTANT auto kTuningTable = rowsWithTheirGroups();

#undef TUNING_CONSTANT

#ifdef SPRINGTOWER_TUNING_FROM_FILE
[[noreturn]] void refuse(const std::string& where, const std::string& found, const char* allowed) {
  std::fprintf(stderr, "SPRINGTOWER_TUNING=%s: expected %s, got %s\n", where.c_str(), allowed, found.c_str());
  std::exit(2);
}

// Read before any constant is: constants are made before main begins.
const std::map<std::string, double, std::less<>>& valuesOfFile() {
  static const std::map<std::string, double, std::less<>> values = [] {
    std::map<std::string, double, std::less<>> read;
    const char* path = std::getenv("SPRINGTOWER_TUNING");
    if (path == nullptr) return read;
    std::ifstream file(path);
    if (!file) refuse(path, "none that can be read", "a file of lines `name value`");
    for (std::string line; std::getline(file, line);) {
      if (line.empty()) continue;
      std::istringstream words(line);
      std::string name;
      double value = 0.0;
      if (!(words >> name >> value) || !(words >> std::ws).eof() || std::find(kNames.begin(), kNames.end(), name) == kNames.end())
        refuse(path, "'" + line + "'", "the name of a constant of core/tuning.def and a number");
      read[name] = value;
    }
    return read;
  }();
  return values;
}
#endif

}  // namespace

#ifdef SPRINGTOWER_TUNING_FROM_FILE
const double* tunedByFile(std::string_view name) {
  const auto found = valuesOfFile().find(name);
  return found == valuesOfFile().end() ? nullptr : &found->second;
}
#endif

std::span<const TuningRow> tuningTable() {
  return kTuningTable;
}

}  // namespace springtower
