#include "apps/commands/chart/recorded_peers.h"

#include "apps/common/options.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/line_input.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <span>
#include <utility>

namespace springtower {
namespace {

constexpr double kNotRecorded = std::numeric_limits<double>::quiet_NaN();

constexpr const char* kTowerColumns[] = {"engine",
                                         "version",
                                         "settings",
                                         "scene",
                                         "rows",
                                         "threads",
                                         "stands_60_s",
                                         "worst_penetration_mm",
                                         "top_height_error_mm",
                                         "creep_mm",
                                         "jitter_mm_s",
                                         "ms_per_frame",
                                         "ratio_to_bullet_16_substeps"};
constexpr const char* kRecordedColumns[] = {"engine",  "version",   "settings",           "scene",
                                            "threads", "median_ms", "penetration_end_mm", "verdict"};

// Scenes whose figures are drawn as they were recorded, and what `springtower scenes` calls them without their size.
constexpr std::pair<ChartScene, std::string_view> kRecordedScenes[] = {
    {ChartScene::wall, "wall"},    {ChartScene::pyramid, "cubes"}, {ChartScene::collapse, "collapse"}, {ChartScene::shot, "shot"},
    {ChartScene::heap200, "heap"}, {ChartScene::rain200, "rain"},  {ChartScene::pile3, "pile"}};

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

InputError withoutColumn(const std::string& path, const char* name) {
  return InputError(fmt::format("{}: expected a column {}, got none", onOneLine(path), inQuotes(name)));
}

// A line of a table, by the names of its columns.
class TableLine {
 public:
  TableLine(const std::string& path, const std::map<std::string, std::size_t>& column, const std::vector<std::string>& fields)
      : path_(path), column_(column), fields_(fields) {}
  [[nodiscard]] const std::string& text(const char* name) const {
    const auto found = column_.find(name);
    if (found == column_.end()) throw withoutColumn(path_, name);
    return fields_[found->second];
  }
  [[nodiscard]] double value(const char* name) const { return parseNumber(text(name)).value_or(kNotRecorded); }

 private:
  const std::string& path_;
  const std::map<std::string, std::size_t>& column_;
  const std::vector<std::string>& fields_;
};

PeerResult described(const TableLine& line, ChartScene scene, const char* verdict) {
  PeerResult peer;
  peer.scene = scene;
  peer.engine = line.text("engine");
  peer.settings = line.text("version") + ", " + line.text("settings");
  peer.verdict = line.text(verdict);
  peer.measured.fill(kNotRecorded);
  return peer;
}

std::optional<PeerResult> towerResult(const TableLine& line, const ChartLimits& limits) {
  if (line.text("scene") != "uniform" || line.value("rows") != limits.rows || line.text("ms_per_frame").empty()) return {};
  PeerResult peer = described(line, ChartScene::uniform, "stands_60_s");
  const auto set = [&](ChartMeasure measure, double value) { peer.measured[static_cast<std::size_t>(measure)] = value; };
  set(ChartMeasure::penetration, line.value("worst_penetration_mm"));
  set(ChartMeasure::compression, std::abs(line.value("top_height_error_mm")) / limits.rows);
  set(ChartMeasure::creep, line.value("creep_mm"));
  set(ChartMeasure::jitter, line.value("jitter_mm_s"));
  peer.frame_ms = line.value("ms_per_frame");
  peer.ratioToBullet = line.value("ratio_to_bullet_16_substeps");
  return peer;
}

// What rests has sunk as deep as it does at the end, what falls is deepest on its way.
std::optional<PeerResult> recordedResult(const TableLine& line, const ChartLimits& limits) {
  for (const auto& [scene, kind] : kRecordedScenes) {
    if (line.text("scene") != fmt::format("{}:{}", kind, sizeText(scene, limits))) continue;
    PeerResult peer = described(line, scene, "verdict");
    peer.measured[static_cast<std::size_t>(ChartMeasure::penetration)] =
        line.value(isFall(scene) ? "penetration_max_mm" : "penetration_end_mm");
    peer.frame_ms = line.value("median_ms");
    if (isFall(scene)) peer.worst_ms = line.value("worst_ms");
    peer.ratioToBullet = kNotRecorded;
    return peer;
  }
  return {};
}

}  // namespace

double drawnTime_ms(const Chart& chart, const PeerResult& peer) {
  if (isDrawnAsRecorded(peer.scene)) return peer.frame_ms;
  const ChartCase bullet{ChartScene::uniform, Method::rigidPgs, Knob::substeps, 16.0, Peer::bullet, 0};
  const auto found =
      std::find_if(chart.results.begin(), chart.results.end(), [&](const ChartResult& result) { return result.what == bullet; });
  const bool known = found != chart.results.end() && std::isfinite(found->frame_ms) && std::isfinite(peer.ratioToBullet);
  return known ? peer.ratioToBullet * found->frame_ms : kNotRecorded;
}

std::vector<PeerResult> readPeers(const std::string& path, const ChartLimits& limits) {
  LineInput input(path, "--peers");
  std::string text;
  input.next(text);
  std::map<std::string, std::size_t> column;
  const std::vector<std::string> names = fieldsOf(text);
  for (std::size_t i = 0; i < names.size(); ++i) column[names[i]] = i;
  const bool asRecorded = column.contains("penetration_end_mm");
  for (const char* needed :
       asRecorded ? std::span<const char* const>(kRecordedColumns) : std::span<const char* const>(kTowerColumns)) {
    if (!column.contains(needed)) throw withoutColumn(path, needed);
  }
  std::vector<PeerResult> peers;
  while (input.next(text)) {
    const std::vector<std::string> fields = fieldsOf(text);
    if (fields.size() != names.size()) {
      throw InputError(
          fmt::format("{}:{}: expected {} fields, got {}", onOneLine(path), input.number(), names.size(), fields.size()));
    }
    const TableLine line(path, column, fields);
    if (line.value("threads") != 1.0) continue;
    const std::optional<PeerResult> peer = asRecorded ? recordedResult(line, limits) : towerResult(line, limits);
    if (peer) peers.push_back(*peer);
  }
  return peers;
}

}  // namespace springtower
