#include "tests/random/record.h"

#include "core/error.h"
#include "core/limits.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, kFaults.size()> kFaultNames = {
    "crash", "refused", "not-finite", "threads", "program", "energy", "diverged", "hung", "slow", "deep", "momentum", "verdict"};

constexpr const char* kNotFinite = "not finite";  // in place of a number

// Calls use(key, member) for every member, so that writing and reading cannot differ.
template <class SomeRecord, class Use>
void forEachMember(SomeRecord& record, const Use& use) {
  use("scene", record.scene);
  use("seed", record.seed);
  use("kind", record.kind);
  use("method", record.method);
  use("blocks", record.blocks);
  use("mass_ratio", record.massRatio);
  use("least_side_m", record.leastSide_m);
  use("tolerance_m", record.tolerance_m);
  use("frames", record.frames);
  use("simulated_s", record.simulated_s);
  use("processor_s", record.processor_s);
  use("by_hand", record.byHand);
  use("cut", record.cut);
  use("most_substeps", record.mostSubsteps);
  use("diverged", record.diverged);
  use("step_limit", record.stepLimit);
  use("not_finite", record.notFinite);
  use("refused", record.refused);
  use("deepest_m", record.deepest_m);
  use("energy_gained", record.energyGained);
  use("momentum_lost", record.momentumLost);
  use("angular_lost", record.angularLost);
  use("moved_most", record.movedMost);
  use("same_on_two_threads", record.sameOnTwoThreads);
  use("same_verdict", record.sameVerdict);
  use("program_agrees", record.programAgrees);
  use("program_says", record.programSays);
  use("hash", record.hash);
  use("ended", record.ended);
}

template <class Value>
Json jsonOf(const Value& value) {
  return value;
}
template <class Value>
Json jsonOf(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}
// JSON has no number that is not finite, and null is an empty option.
Json jsonOf(const std::optional<double>& value) {
  if (value && !std::isfinite(*value)) return kNotFinite;
  return value ? Json(*value) : Json(nullptr);
}

template <class Value>
void readJson(const Json& json, Value& value) {
  value = json.get<Value>();
}
// A number that is not finite is written as null.
void readJson(const Json& json, double& value) {
  value = json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}
template <class Value>
void readJson(const Json& json, std::optional<Value>& value) {
  value = json.is_null() ? std::nullopt : std::optional<Value>(json.get<Value>());
}
void readJson(const Json& json, std::optional<double>& value) {
  value.reset();
  if (!json.is_null()) value = json == kNotFinite ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

// NaN is no smaller than any bound.
bool exceeds(double value, double most) {
  return !(value <= most);
}

}  // namespace

std::string_view nameOf(Fault fault) {
  return kFaultNames[static_cast<std::size_t>(fault)];
}

Fault faultFromName(std::string_view name, std::string_view source) {
  for (const Fault fault : kFaults) {
    if (nameOf(fault) == name) return fault;
  }
  throw InputError(fmt::format("{}: expected {}, got {}", source, fmt::join(kFaultNames, ", "), inQuotes(name)));
}

bool has(const Record& record, Fault fault) {
  // Without a frame there is nothing to measure; what diverges or is not finite has no energy that means anything.
  const bool sound = record.diverged.empty() && record.notFinite.empty() && record.frames > 0;
  switch (fault) {
    case Fault::crash:
      return !record.ended.empty() && record.ended != "limit";
    case Fault::refused:
      return !record.refused.empty();
    case Fault::notFinite:
      return !record.notFinite.empty();
    case Fault::threads:
      return record.sameOnTwoThreads == false;
    case Fault::program:
      return record.programAgrees == false;
    case Fault::energy:
      return sound && exceeds(record.energyGained, record.byHand ? kMaxEnergyGainByHand : kMaxEnergyGain);
    case Fault::diverged:
      return !record.diverged.empty();
    case Fault::hung:
      return record.ended == "limit";
    case Fault::slow:
      return has(record, Fault::hung) ||
             (record.diverged.empty() && record.stepLimit.empty() && record.processor_s > record.simulated_s);
    case Fault::deep:
      return sound && exceeds(record.deepest_m, kMaxDepthShare * record.leastSide_m);
    case Fault::momentum:
      return sound && record.momentumLost &&
             (exceeds(*record.momentumLost, kMaxMomentumLoss) || exceeds(*record.angularLost, kMaxAngularLoss));
    case Fault::verdict:
      return record.sameVerdict == false;
  }
  return false;
}

std::vector<Fault> faultsOf(const Record& record) {
  std::vector<Fault> faults;
  for (const Fault fault : kFaults) {
    if (has(record, fault)) faults.push_back(fault);
  }
  return faults;
}

std::string describe(const Record& record, Fault fault) {
  const auto what = [&]() -> std::string {
    switch (fault) {
      case Fault::crash:
        return record.ended;
      case Fault::refused:
        return record.refused;
      case Fault::notFinite:
        return record.notFinite;
      case Fault::threads:
        return "another state on 2 threads than on 1";
      case Fault::program:
        return record.programSays;
      case Fault::energy:
        return fmt::format("gained {:.3g} of what there was", record.energyGained);
      case Fault::diverged:
        return record.diverged;
      case Fault::hung:
        return fmt::format("{} was not over when its process was ended at its limit",
                           record.hash.empty() ? "the first run" : "a run after the first");
      case Fault::slow:
        return fmt::format("{:.3g} s of processor time for {:.3g} s", record.processor_s, record.simulated_s);
      case Fault::deep:
        return fmt::format("{:.3g} mm, {:.3g} of the least side, {:.3g} tolerances", 1e3 * record.deepest_m,
                           record.deepest_m / record.leastSide_m, record.deepest_m / record.tolerance_m);
      case Fault::momentum:
        return fmt::format("lost {:.3g}, angular {:.3g}", *record.momentumLost, *record.angularLost);
      case Fault::verdict:
        return fmt::format("moved by {:.3g} sides, otherwise with sleep than without", record.movedMost);
    }
    return {};
  };
  return fmt::format("{}: {}", nameOf(fault), what());
}

Json recordJson(const Record& record) {
  Json json;
  forEachMember(record, [&](const char* key, const auto& value) { json[key] = jsonOf(value); });
  return json;
}

Record recordFromJson(const Json& json) {
  Record record;
  forEachMember(record, [&](const char* key, auto& value) { readJson(json.at(key), value); });
  return record;
}

}  // namespace springtower
