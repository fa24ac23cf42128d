#include "apps/commands/chart/files.h"

#include "apps/commands/chart/recorded_peers.h"
#include "apps/common/output_file.h"
#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <ostream>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

double numberFrom(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

std::string_view nameOf(Knob knob) {
  return knob == Knob::tolerance ? "tolerance_m" : "substeps";
}

Json limitsJson(const ChartLimits& limits) {
  return {{"rows", limits.rows},
          {"seconds", limits.seconds},
          {"case_s", limits.case_s},
          {"samples", limits.samples},
          {"frames", limits.frames},
          {"sample_s", limits.sample_s},
          {"wall_columns", limits.wallColumns},
          {"wall_courses", limits.wallCourses},
          {"pyramid_rows", limits.pyramidRows}};
}

Json resultJson(const ChartResult& result) {
  Json json;
  json["scene"] = springtower::nameOf(result.what.scene);
  json["method"] = methodOf(result.what);
  json["knob"] = nameOf(result.what.knob);
  json["value"] = result.what.value;
  json["iterations"] = result.what.iterations;
  json["outcome"] = springtower::nameOf(result.outcome);
  json["note"] = result.note;
  json["simulated_s"] = result.simulated_s;
  json["from_s"] = result.from_s;
  json["cpu_ms_per_frame"] = number(result.frame_ms);
  json["cpu_ms_worst_frame"] = number(result.worst_ms);
  json["frames"] = result.frames;
  json["samples"] = result.samples;
  for (std::size_t i = 0; i < kChartMeasures; ++i) json[std::string(kChartMeasureRows[i].key)] = number(result.measured[i]);
  return json;
}

template <class Value, std::size_t N>
Value valueNamed(const std::array<std::string_view, N>& names, const std::string& name) {
  const auto* const found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw InputError(fmt::format("expected {}, got {}", fmt::join(names, ", "), inQuotes(name)));
  return static_cast<Value>(found - names.begin());
}

ChartResult chartResultFromJson(const Json& json) {
  ChartResult result;
  result.what.scene = valueNamed<ChartScene>(kChartSceneNames, json.at("scene").get<std::string>());
  const auto method = json.at("method").get<std::string>();
  const auto* const peer = std::find(kPeerNames.begin() + 1, kPeerNames.end(), method);
  if (peer != kPeerNames.end()) {
    result.what.peer = static_cast<Peer>(peer - kPeerNames.begin());
    result.what.method = Method::rigidPgs;
  } else {
    result.what.method = methodFromName(method, "method");
  }
  json.at("iterations").get_to(result.what.iterations);
  result.what.knob = json.at("knob").get<std::string>() == nameOf(Knob::tolerance) ? Knob::tolerance : Knob::substeps;
  json.at("value").get_to(result.what.value);
  result.outcome = valueNamed<ChartOutcome>(kChartOutcomeNames, json.at("outcome").get<std::string>());
  json.at("note").get_to(result.note);
  json.at("simulated_s").get_to(result.simulated_s);
  json.at("from_s").get_to(result.from_s);
  result.frame_ms = numberFrom(json.at("cpu_ms_per_frame"));
  result.worst_ms = numberFrom(json.at("cpu_ms_worst_frame"));
  json.at("frames").get_to(result.frames);
  json.at("samples").get_to(result.samples);
  for (std::size_t i = 0; i < kChartMeasures; ++i)
    result.measured[i] = numberFrom(json.at(std::string(kChartMeasureRows[i].key)));
  return result;
}

std::string csvNumber(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string();
}

}  // namespace

void writeChartJson(std::ostream& stream, const Chart& chart) {
  Json json = provenanceJson(chart.provenance);
  json["limits"] = limitsJson(chart.limits);
  json["interrupted"] = chart.interrupted;
  json["cases"] = Json::array();
  for (const ChartResult& result : chart.results) json["cases"].push_back(resultJson(result));
  stream << json.dump(1) << '\n';
}

std::vector<ChartResult> readChartJson(const std::string& path, const Chart& now) {
  std::vector<ChartResult> results;
  readKept(path, now.provenance, {{"limits", limitsJson(now.limits)}}, [&](const Json& json) {
    for (const Json& result : json.at("cases")) results.push_back(chartResultFromJson(result));
  });
  return results;
}

void writeChartCsv(std::ostream& stream, const Chart& chart) {
  stream << "measured,scene,rows,method,knob,value,iterations,outcome,note,simulated_s,settled_from_s,frames,samples,"
            "cpu_ms_per_frame,cpu_s_per_simulated_s";
  for (const ChartMeasureRow& row : kChartMeasureRows) stream << ',' << row.key;
  stream << ",cpu_ms_worst_frame,commit,compiler,flags,cpu,date\n";
  const Provenance& from = chart.provenance;
  constexpr double kFramesInASecond = 60.0;
  for (const ChartResult& r : chart.results) {
    stream << fmt::format("here,{},{},{},{},{:g},{},{},{},{:.6g},{:.6g},{},{},{},{}", nameOf(r.what.scene),
                          sizeText(r.what.scene, chart.limits), methodOf(r.what), nameOf(r.what.knob), r.what.value,
                          r.what.iterations, csvText(nameOf(r.outcome)), csvText(r.note), r.simulated_s, r.from_s, r.frames,
                          r.samples, csvNumber(r.frame_ms), csvNumber(1e-3 * kFramesInASecond * r.frame_ms));
    for (const double value : r.measured) stream << ',' << csvNumber(value);
    stream << fmt::format(",{},{}\n", csvNumber(r.worst_ms), csvText(from));
  }
  for (const PeerResult& peer : chart.peers) {
    stream << fmt::format("elsewhere,{},{},{},settings,{},,{},,,,,,{},{}", nameOf(peer.scene), sizeText(peer.scene, chart.limits),
                          csvText(peer.engine), csvText(peer.settings), csvText(peer.verdict),
                          csvNumber(drawnTime_ms(chart, peer)), csvNumber(1e-3 * kFramesInASecond * drawnTime_ms(chart, peer)));
    for (const double value : peer.measured) stream << ',' << csvNumber(value);
    stream << fmt::format(",{},elsewhere,,,,\n", csvNumber(peer.worst_ms));
  }
}

}  // namespace springtower
