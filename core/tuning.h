#pragma once

#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <string_view>

namespace springtower {

/// Numbers that are choices, neither physics nor layout: thresholds, caps, safety factors. They stand in one table
/// (core/tuning.def) with unit, purpose and evidence, from which these constants and what `springtower settings --all` prints
/// both come. What a scene may set is in core/settings.h instead.
namespace tuning {
#define TUNING_GROUP(name)
#define TUNING(type, name, value, unit, purpose, evidence) inline constexpr type name = value;
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
