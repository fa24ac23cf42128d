#pragma once

#include "apps/chart.h"
#include "apps/plot.h"

#include <iosfwd>
#include <string>
#include <utility>
#include <vector>

namespace springtower {

/// A result as good as any: no other right one of the same scene is both at least as fast and at least as accurate. Results in
/// order of cost, dearest first.
std::vector<const ChartResult*> paretoFront(const Chart& chart, ChartScene scene, ChartMeasure measure);

/// Whether a result of a scene that comes to rest is right and within a tolerance: no penetration, no compression of a row and no
/// creep above it.
bool meets(const ChartResult& result, double tolerance_mm);

/// The fastest result of a scene that meets a tolerance, method `auto` left out. Null where there is none.
const ChartResult* fastestWithin(const Chart& chart, ChartScene scene, double tolerance_mm);

/// One chart for each scene and measure that has results, with a file name without extension.
std::vector<std::pair<std::string, Plot>> chartPlots(const Chart& chart);

/// The index page (Markdown): the table of tolerances, the charts, and every case that failed. `names`: of the charts.
void writeChartIndex(std::ostream& stream, const Chart& chart, const std::vector<std::string>& names);

/// The scenes that have results, in the order of the enumeration.
std::vector<ChartScene> scenesIn(const Chart& chart);

}  // namespace springtower
