#pragma once

#include "apps/commands/chart/chart.h"

#include <iosfwd>
#include <string>
#include <vector>

namespace springtower {

/// Everything measured so far, for a later run to resume from and for other programs to read.
void writeChartJson(std::ostream& stream, const Chart& chart);

/// The results that a file of an earlier run holds; empty where there is no such file. Throws InputError for a file that is not a
/// chart's, or of another build, processor or limits, so that it cannot be gone on with.
std::vector<ChartResult> readChartJson(const std::string& path, const Chart& now);

/// One line a result, with commit, compiler, flags, processor and date; then the peers, whose `measured` column says elsewhere.
void writeChartCsv(std::ostream& stream, const Chart& chart);

}  // namespace springtower
