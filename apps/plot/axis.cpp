#include "apps/plot/axis.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace springtower {
namespace {

constexpr double kMaxTicks = 8.0;

// 1, 2 or 5 times a power of ten, so that a span has no more than kMaxTicks of them.
double niceStep(double span) {
  const double raw = span / kMaxTicks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power * (1.0 + 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

// A single value gets room on both sides.
void widen(AxisScale& scale) {
  if (scale.most > scale.least) return;
  const double value = scale.least;
  if (scale.logarithmic) {
    scale.least = 0.5 * value;
    scale.most = 2.0 * value;
  } else {
    const double room = value == 0.0 ? 1.0 : 0.5 * std::abs(value);
    scale.least = value - room;
    scale.most = value + room;
  }
}

void linearTicks(const PlotAxis& axis, AxisScale& scale) {
  // From zero on, unless the values are far from it for their spread.
  if (!axis.least && scale.least > 0.0 && scale.least < 0.7 * scale.most) scale.least = 0.0;
  const double step = niceStep(scale.most - scale.least);
  if (!axis.least) scale.least = step * std::floor(scale.least / step + 1e-9);
  if (!axis.most) scale.most = step * std::ceil(scale.most / step - 1e-9);
  for (double i = std::ceil(scale.least / step - 1e-9); i * step <= scale.most + 1e-9 * step; ++i) {
    const double value = i == 0.0 ? 0.0 : i * step;
    scale.ticks.push_back({value, fmt::format("{:.6g}", value)});
  }
}

void logarithmicTicks(const PlotAxis& axis, AxisScale& scale) {
  const double decades = std::log10(scale.most / scale.least);
  const auto labelled = [&](int digit) { return digit == 1 || (decades < 3.0 && (digit == 2 || digit == 5)); };
  const int first = static_cast<int>(std::floor(std::log10(scale.least)));
  const int last = static_cast<int>(std::ceil(std::log10(scale.most)));
  const auto valueOf = [](int exponent, int digit) { return digit * std::pow(10.0, exponent); };
  // Out to the next tick that has a label.
  double low = valueOf(first, 1);
  double high = valueOf(last, 1);
  for (int exponent = first; exponent <= last; ++exponent) {
    for (const int digit : {1, 2, 5}) {
      const double value = valueOf(exponent, digit);
      if (!labelled(digit)) continue;
      if (value <= scale.least * (1.0 + 1e-9)) low = std::max(low, value);
      if (value >= scale.most * (1.0 - 1e-9)) high = std::min(high, value);
    }
  }
  if (!axis.least) scale.least = low;
  if (!axis.most) scale.most = high;
  const int every = decades > 2.0 * kMaxTicks ? static_cast<int>(std::ceil(decades / kMaxTicks)) : 1;
  for (int exponent = first; exponent <= last; ++exponent) {
    for (int digit = 1; digit <= 9; ++digit) {
      const double value = valueOf(exponent, digit);
      if (value < scale.least * (1.0 - 1e-9) || value > scale.most * (1.0 + 1e-9)) continue;
      scale.ticks.push_back({value, labelled(digit) && exponent % every == 0 ? fmt::format("{:.6g}", value) : ""});
    }
  }
}

}  // namespace

double AxisScale::place(double value) const {
  if (logarithmic) return std::log(value / least) / std::log(most / least);
  return (value - least) / (most - least);
}

bool AxisScale::shows(double value) const {
  return std::isfinite(value) && (!logarithmic || value > 0.0);
}

AxisScale axisScale(const PlotAxis& axis, const std::vector<double>& values) {
  AxisScale scale;
  scale.logarithmic = axis.logarithmic;
  bool any = false;
  const auto take = [&](double value) {
    if (!scale.shows(value)) return;
    scale.least = any ? std::min(scale.least, value) : value;
    scale.most = any ? std::max(scale.most, value) : value;
    any = true;
  };
  for (const double value : values) take(value);
  if (axis.least) scale.least = *axis.least;
  if (axis.most) scale.most = *axis.most;
  if (!any && scale.logarithmic && !axis.least) scale.least = 0.1;
  widen(scale);
  if (!axis.labels.empty()) {
    for (const auto& [value, label] : axis.labels) scale.ticks.push_back({value, label});
  } else if (scale.logarithmic) {
    logarithmicTicks(axis, scale);
  } else {
    linearTicks(axis, scale);
  }
  return scale;
}

}  // namespace springtower
