#include "tests/random/bounds.h"

#include "core/settings.h"
#include "scenarios/random_scene.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <limits>

namespace springtower {
namespace {

// Each rate is the upper end of 99.9 % confidence (Clopper and Pearson 1934): with a larger one, so few as were found would be
// found less than once in a thousand times. Where they were measured is in docs/random-scenes.md. They are to be lowered when
// more scenes are measured, and when the engine gets better.
constexpr std::array<Bound, kFaults.size()> kBounds = {{
    {Fault::crash, 0.0, "must never be"},
    {Fault::refused, 0.0, "must never be: the generator makes scenes that can be simulated"},
    {Fault::notFinite, 0.0, "must never be: what is not finite is named as divergence"},
    {Fault::threads, 0.0, "must never be"},
    {Fault::program, 0.0, "must never be"},
    {Fault::energy, 0.0061, "6 of 3000: hands, and method report"},
    {Fault::diverged, 0.0023, "0 of 3000; by implicit or auto none may"},
    {Fault::hung, 0.0091, "12 of 3000: explicit methods of stiff scenes"},
    {Fault::slow, 0.0632, "149 of 3000 on the slowest machine: explicit methods of stiff scenes"},
    {Fault::deep, 0.0525, "120 of 3000: nearly all by explicit methods and rigid ones with few steps"},
    {Fault::momentum, 0.0023, "0 of 3000"},
    {Fault::verdict, 0.0031, "1 of 3000"},
}};

// How bad a fault is.
double numberOf(const Record& record, Fault fault) {
  switch (fault) {
    case Fault::energy:
      return record.energyGained;
    case Fault::deep:
      return record.deepest_m / record.leastSide_m;
    case Fault::momentum:
      if (std::isnan(*record.momentumLost)) return *record.momentumLost;
      return std::max(*record.angularLost, *record.momentumLost);  // the first where it is not a number
    case Fault::slow:
    case Fault::hung:
      return record.simulated_s > 0.0 ? record.processor_s / record.simulated_s : 1e9;
    // Few light blocks, and masses that are alike, should be the last to diverge.
    case Fault::diverged:
      return -record.massRatio - static_cast<double>(record.blocks);
    default:
      return 0.0;
  }
}

// The same for the order of the seeds, in which what is not a number comes first.
double weightOf(const Record& record, Fault fault) {
  const double number = numberOf(record, fault);
  return std::isnan(number) ? std::numeric_limits<double>::infinity() : number;
}

bool isImplicitOrAutomatic(const Record& record) {
  return record.method == nameOf(Method::implicit) || record.method == nameOf(Method::automatic);
}

// Whatever is drawn: the default methods go on.
bool isDefaultThatDiverged(const Record& record) {
  return isImplicitOrAutomatic(record) && has(record, Fault::diverged);
}

constexpr std::array<std::string_view, 5> kRatioNames = {"1", "to 10", "to 100", "to 1000", "above"};

std::size_t ratioClassOf(const Record& record) {
  constexpr double kRounding = 1e-9;
  std::size_t place = 0;
  for (double most = 1.0 + kRounding; record.massRatio > most && place + 1 < kRatioNames.size(); most *= 10.0) ++place;
  return place;
}

using Choice = std::function<bool(const Record&)>;

std::string rowOf(std::string_view name, std::span<const Record> records, const Choice& chosen) {
  std::array<int, kFaults.size()> counts{};
  int scenes = 0;
  int cut = 0;
  int stepLimit = 0;
  for (const Record& record : records) {
    if (!chosen(record)) continue;
    ++scenes;
    cut += record.cut ? 1 : 0;
    stepLimit += record.stepLimit.empty() ? 0 : 1;
    for (const Fault fault : faultsOf(record)) ++counts[static_cast<std::size_t>(fault)];
  }
  if (scenes == 0) return {};
  std::string row = fmt::format("{:28}{:>8}", name, scenes);
  for (const int count : counts) row += fmt::format("{:>11}", count);
  return row + fmt::format("{:>11}{:>11}\n", cut, stepLimit);
}

}  // namespace

std::span<const Bound> bounds() {
  return kBounds;
}

int mostAllowed(double rate, int scenes, double falseAlarm) {
  if (rate <= 0.0) return 0;
  const double n = scenes;
  double below = 0.0;  // probability of at most k
  for (int k = 0; k < scenes; ++k) {
    const double log =
        std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) + k * std::log(rate) + (n - k) * std::log1p(-rate);
    below += std::exp(log);
    if (1.0 - below < falseAlarm) return k;
  }
  return scenes;
}

std::string tableOf(std::span<const Record> records) {
  std::string table = fmt::format("{:28}{:>8}", "", "scenes");
  for (const Fault fault : kFaults) table += fmt::format("{:>11}", nameOf(fault));
  table += fmt::format("{:>11}{:>11}\n", "cut", "step-limit");
  for (const RandomKind kind : kRandomKinds) {
    table += rowOf(nameOf(kind), records, [&](const Record& record) { return record.kind == nameOf(kind); });
  }
  std::vector<std::string> methods;
  for (const Record& record : records) methods.push_back(record.method);
  std::sort(methods.begin(), methods.end());
  methods.erase(std::unique(methods.begin(), methods.end()), methods.end());
  for (const std::string& method : methods) {
    table += rowOf(method, records, [&](const Record& record) { return record.method == method; });
  }
  for (const bool implicit : {true, false}) {
    for (std::size_t ratio = 0; ratio < kRatioNames.size(); ++ratio) {
      const std::string name = fmt::format("{}, masses {}", implicit ? "implicit, auto" : "others", kRatioNames[ratio]);
      table += rowOf(name, records, [&](const Record& record) {
        return isImplicitOrAutomatic(record) == implicit && ratioClassOf(record) == ratio;
      });
    }
  }
  return table + rowOf("all", records, [](const Record&) { return true; });
}

std::string faultLines(std::span<const Record> records) {
  constexpr std::size_t kMostSeeds = 12;
  std::string text;
  for (const Bound& bound : bounds()) {
    std::vector<const Record*> found;
    for (const Record& record : records) {
      if (has(record, bound.fault)) found.push_back(&record);
    }
    text += fmt::format("{:11}{:>6} of {}, at most {}: {}\n", nameOf(bound.fault), found.size(), records.size(),
                        mostAllowed(bound.rate, static_cast<int>(records.size())), bound.reason);
    std::stable_sort(found.begin(), found.end(),
                     [&](const Record* a, const Record* b) { return weightOf(*a, bound.fault) > weightOf(*b, bound.fault); });
    for (std::size_t i = 0; i < std::min(found.size(), kMostSeeds); ++i) {
      text += fmt::format("    {} ({}, {} blocks, masses 1:{:.3g}) {}\n", found[i]->scene, found[i]->method, found[i]->blocks,
                          found[i]->massRatio, describe(*found[i], bound.fault));
    }
  }
  return text;
}

std::vector<Fault> exceededBounds(std::span<const Record> records, bool judgeTimes) {
  std::vector<Fault> exceeded;
  for (const Bound& bound : bounds()) {
    if (!judgeTimes && (bound.fault == Fault::slow || bound.fault == Fault::hung)) continue;
    const auto count =
        std::count_if(records.begin(), records.end(), [&](const Record& record) { return has(record, bound.fault); });
    const bool never = bound.fault == Fault::diverged && std::any_of(records.begin(), records.end(), isDefaultThatDiverged);
    if (never || count > mostAllowed(bound.rate, static_cast<int>(records.size()))) exceeded.push_back(bound.fault);
  }
  return exceeded;
}

}  // namespace springtower
