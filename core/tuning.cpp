#include "core/tuning.h"

#include <array>

namespace springtower {

namespace {

// A row that begins a group has no name; what follows belongs to it.
constexpr auto kRowsAndGroups = std::to_array<TuningRow>({
#define TUNING_GROUP(name) {name, "", "", 0.0, "", "", ""},
#define TUNING(type, name, value, unit, purpose, evidence) \
  {"", #name, #value, static_cast<double>(tuning::name), unit, purpose, evidence},
#include "core/tuning.def"
#undef TUNING
#undef TUNING_GROUP
});

constexpr std::size_t countOfRows() {
  std::size_t count = 0;
  for (const TuningRow& row : kRowsAndGroups) count += row.name.empty() ? 0 : 1;
  return count;
}

constexpr std::array<TuningRow, countOfRows()> rowsWithTheirGroups() {
  std::array<TuningRow, countOfRows()> rows{};
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

constexpr auto kTuningTable = rowsWithTheirGroups();

}  // namespace

std::span<const TuningRow> tuningTable() {
  return kTuningTable;
}

}  // namespace springtower
