#pragma once

#include "apps/commands/chart/chart.h"
#include "apps/plot/plot.h"

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace springtower {

/// Results as good as any: no other right one of the same scene is both at least as fast and at least as accurate. In order of
/// cost, dearest first. What was cut short counts, but not for creep.
std::vector<const ChartResult*> paretoFront(const Chart& chart, ChartScene scene, ChartMeasure measure);

/// Whether a result of a scene that comes to rest is right and within a tolerance: no penetration, no compression of a row and no
/// creep above it.
bool meets(const ChartResult& result, double tolerance_mm);

/// The fastest result of a scene that meets a tolerance, method `auto` left out. Null where there is none.
const ChartResult* fastestWithin(const Chart& chart, ChartScene scene, double tolerance_mm);

/// What method `auto` took in a scene beside the fastest other result that meets kAutoTolerance_m.
struct AutoChoice {
  const ChartResult* chosen = nullptr;  ///< null where it did not run
  const ChartResult* best = nullptr;    ///< null where no other meets it
  bool within = false;
  double ratio = 0.0;  ///< of the costs
  bool passes = false;
};
AutoChoice choiceOf(const Chart& chart, ChartScene scene);

/// One chart for each scene and measure that has results, with a file name without extension; of the depth of a fall a second
/// one, of its worst frame.
std::vector<std::pair<std::string, Plot>> chartPlots(const Chart& chart);

/// The index page (Markdown): the table of tolerances, the charts, and every case that failed. `names`: of the charts.
void writeChartIndex(std::ostream& stream, const Chart& chart, const std::vector<std::string>& names);

/// The scenes that have results, in the order of the enumeration.
std::vector<ChartScene> scenesIn(const Chart& chart);

}  // namespace springtower
