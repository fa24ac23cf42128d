#include "apps/commands/chart/maps_kept.h"

#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <ostream>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

// Which methods are mapped does not matter: a row is one method's.
Json limitsJson(const MapLimits& limits) {
  return {{"steps", limits.steps}, {"seconds", limits.seconds}, {"case_s", limits.case_s}};
}

Json pointsJson(const std::vector<MapPoint>& points) {
  Json json = Json::array();
  for (const MapPoint& point : points) {
    json.push_back({{"steps", point.steps},
                    {"step_s", point.step_s},
                    {"stiffness", point.stiffness},
                    {"rows", point.rows},
                    {"omega", point.omega},
                    {"verdict", nameOf(point.verdict)}});
  }
  return json;
}

std::vector<MapPoint> pointsFromJson(const Json& json) {
  std::vector<MapPoint> points;
  for (const Json& from : json) {
    MapPoint& point = points.emplace_back();
    from.at("steps").get_to(point.steps);
    from.at("step_s").get_to(point.step_s);
    from.at("stiffness").get_to(point.stiffness);
    from.at("rows").get_to(point.rows);
    from.at("omega").get_to(point.omega);
    const auto name = from.at("verdict").get<std::string>();
    const auto* const found = std::find(kMapVerdictNames.begin(), kMapVerdictNames.end(), name);
    if (found == kMapVerdictNames.end())
      throw InputError(fmt::format("verdict: expected {}, got {}", fmt::join(kMapVerdictNames, ", "), inQuotes(name)));
    point.verdict = static_cast<MapVerdict>(found - kMapVerdictNames.begin());
  }
  return points;
}

Json rowJson(const MapRow& row) {
  return {{"method", nameOf(row.method)},
          {"over_stiffness", row.axis == MapAxis::stiffness},
          {"rows", row.rows},
          {"tolerance_m", row.tolerance_m},
          {"points", pointsJson(row.points)},
          {"boundary", pointsJson(row.boundary)}};
}

MapRow rowFromJson(const Json& json) {
  return {methodFromName(json.at("method").get<std::string>(), "method"),
          json.at("over_stiffness").get<bool>() ? MapAxis::stiffness : MapAxis::rows,
          json.at("rows").get<int>(),
          json.at("tolerance_m").get<double>(),
          pointsFromJson(json.at("points")),
          pointsFromJson(json.at("boundary"))};
}

}  // namespace

void writeKeptRows(std::ostream& stream, const std::vector<MapRow>& rows, const MapLimits& limits, const Provenance& provenance) {
  Json json = provenanceJson(provenance);
  json["limits"] = limitsJson(limits);
  json["map_rows"] = Json::array();
  for (const MapRow& row : rows) json["map_rows"].push_back(rowJson(row));
  stream << json.dump(1) << '\n';
}

std::vector<MapRow> readKeptRows(const std::string& path, const MapLimits& limits, const Provenance& provenance) {
  std::vector<MapRow> rows;
  readKept(path, provenance, {{"limits", limitsJson(limits)}}, [&](const Json& json) {
    for (const Json& row : json.at("map_rows")) rows.push_back(rowFromJson(row));
  });
  return rows;
}

}  // namespace springtower
