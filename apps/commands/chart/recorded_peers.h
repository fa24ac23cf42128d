#pragma once

#include "apps/commands/chart/chart.h"

#include <string>
#include <vector>

namespace springtower {

/// Other engines' figures, one thread, from either of two tables (bench/data/peers), which the names of its columns tell apart.
/// Of the uniform tower of the chart's rows: engine, version, settings, scene, rows, threads, stands_60_s, worst_penetration_mm,
/// top_height_error_mm, creep_mm, jitter_mm_s, ms_per_frame and ratio_to_bullet_16_substeps. Of the chart's wall, pyramid and
/// falls, whose scenes are named as `springtower scenes` names them (wall:40x25, cubes:40, heap:200): engine, version, settings,
/// scene, threads, median_ms, penetration_end_mm and verdict, of falls also worst_ms and penetration_max_mm. Figures of other
/// scenes and sizes are left out. Throws InputError naming the file and line.
std::vector<PeerResult> readPeers(const std::string& path, const ChartLimits& limits);

/// Whether engines measured elsewhere are drawn with the times they were recorded with: all but those on the tower at rest.
constexpr bool isDrawnAsRecorded(ChartScene scene) {
  return scene != ChartScene::uniform;
}

/// The time (ms) with which an engine measured elsewhere is drawn: on the tower by its ratio to Bullet, NaN where Bullet was not
/// measured here; else as it was recorded.
double drawnTime_ms(const Chart& chart, const PeerResult& peer);

}  // namespace springtower
