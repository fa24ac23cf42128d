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

/// Other engines' figures on the uniform tower of `rows` rows, one thread, from a table with the columns engine, version,
/// settings, scene, rows, threads, stands_60_s, worst_penetration_mm, top_height_error_mm, creep_mm, jitter_mm_s,
/// ms_per_frame and ratio_to_bullet_16_substeps. Throws InputError naming the file and line.
std::vector<PeerResult> readPeers(const std::string& path, int rows);

/// The time of a frame (ms) of an engine measured elsewhere, by its ratio to Bullet; NaN where Bullet was not measured here.
double carriedOver_ms(const Chart& chart, const PeerResult& peer);

}  // namespace springtower
