#pragma once

#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <string_view>

namespace springtower {

#ifdef SPRINGTOWER_TUNING_FROM_FILE
/// The value that the file named by the environment variable SPRINGTOWER_TUNING gives a constant in a line `name value`, or null.
/// For studies of what a constant decides. Ends the program with a message where a line cannot be read or names no constant.
const double* tunedByFile(std::string_view name);

template <class Value>
Value tunedValue(std::string_view name, Value value) {
  const double* given = tunedByFile(name);
  return given != nullptr ? static_cast<Value>(*given) : value;
}
#endif

/// Numbers that are choices, neither physics nor layout: thresholds, caps, safety factors. They stand in one table
/// (core/tuning.def) with unit, purpose and evidence, from which these constants and what `springtower settings --all` prints
/// both come. What a scene may set is in core/settings.h instead.
namespace tuning {
#define TUNING_GROUP(name)
#ifdef SPRINGTOWER_TUNING_FROM_FILE
#define TUNING(type, name, value, unit, purpose, evidence) inline const type name = tunedValue<type>(#name, value);
#define TUNING_SIZE(type, name, value, unit, purpose, evidence) inline constexpr type name = value;
#else
#define TUNING(type, name, value, unit, purpose, evidence) inline constexpr type name = value;
#endif
#include "core/tuning.def"
#undef TUNING
#undef TUNING_GROUP
}  // namespace tuning

/// One row of the table.
struct TuningRow {
  std::string_view group;
  std::string_view name;
  std::string_view expression;  ///< as written; of others where it is derived
  double value;
  std::string_view unit;      ///< SI, or h (least block height), g, tolerances, ...; 1 for a pure number
  std::string_view purpose;   ///< what it is for
  std::string_view evidence;  ///< the measurement, derivation or source it rests on; none where there is none
};

/// All rows, group by group.
std::span<const TuningRow> tuningTable();

}  // namespace springtower
