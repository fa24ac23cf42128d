#pragma once

#include "apps/plot/plot.h"

#include <string>
#include <vector>

namespace springtower {

/// A mark on an axis; minor ones have no label.
struct Tick {
  double value;
  std::string label;
};

/// An axis ready to draw: its limits, how a value maps to 0 .. 1 between them, and its ticks.
struct AxisScale {
  double least = 0.0;
  double most = 1.0;
  bool logarithmic = false;
  std::vector<Tick> ticks;

  /// Place of a value between the limits, 0 to 1; outside of that range beyond the limits.
  [[nodiscard]] double place(double value) const;
  /// Whether the axis can show a value at all: finite, and positive on a logarithmic one.
  [[nodiscard]] bool shows(double value) const;
};

/// Chooses limits and ticks for values: steps of 1, 2 or 5 times a power of ten, or decades with 2 and 5 between where there are
/// few. Limits that the axis gives stand as they are; without any usable value the axis runs from 0 to 1 (0.1 to 1).
AxisScale axisScale(const PlotAxis& axis, const std::vector<double>& values);

}  // namespace springtower
