#include "apps/commands/chart/files.h"

#include "apps/common/options.h"
#include "apps/common/output_file.h"
#include "core/error.h"
#include "core/limits.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <map>
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
  return {{"rows", limits.rows},       {"seconds", limits.seconds}, {"case_s", limits.case_s},
          {"samples", limits.samples}, {"frames", limits.frames},   {"sample_s", limits.sample_s}};
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
  json["frames"] = result.frames;
  json["samples"] = result.samples;
  for (std::size_t i = 0; i < kChartMeasures; ++i) json[std::string(kChartMeasureRows[i].key)] = number(result.measured[i]);
  return json;
}

template <class Value, std::size_t N>
Value valueNamed(const std::array<std::string_view, N>& names, const std::string& name) {
  const auto* const found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw InputError("found " + inQuotes(name));
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
  json.at("frames").get_to(result.frames);
  json.at("samples").get_to(result.samples);
  for (std::size_t i = 0; i < kChartMeasures; ++i)
    result.measured[i] = numberFrom(json.at(std::string(kChartMeasureRows[i].key)));
  return result;
}

std::string csvNumber(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : std::string();
}

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

}  // namespace

void writeChartJson(std::ostream& stream, const Chart& chart) {
  Json json = provenanceJson(chart.provenance);
  json["limits"] = limitsJson(chart.limits);
  json["cases"] = Json::array();
  for (const ChartResult& result : chart.results) json["cases"].push_back(resultJson(result));
  stream << json.dump(1) << '\n';
}

std::vector<ChartResult> readChartJson(const std::string& path, const Chart& now) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return {};
  try {
    const Json json = Json::parse(stream);
    const Provenance then = provenanceFromJson(json);
    checkCommitted(then, now.provenance, "chart.json");
    const bool same = sameOrigin(then, now.provenance) && json.at("limits") == limitsJson(now.limits);
    if (!same)
      throw InputError("found figures of another build, machine or limits, allowed are those of this run, or --no-resume");
    std::vector<ChartResult> results;
    for (const Json& result : json.at("cases")) results.push_back(chartResultFromJson(result));
    return results;
  } catch (const Json::exception& error) {
    throw InputError(
        fmt::format("{}: not the chart.json of a chart of this version: {}", onOneLine(path), onOneLine(error.what())));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", onOneLine(path), error.what()));
  }
}

void writeChartCsv(std::ostream& stream, const Chart& chart) {
  stream << "measured,scene,rows,method,knob,value,iterations,outcome,note,simulated_s,settled_from_s,frames,samples,"
            "cpu_ms_per_frame,cpu_s_per_simulated_s";
  for (const ChartMeasureRow& row : kChartMeasureRows) stream << ',' << row.key;
  stream << ",commit,compiler,flags,cpu,date\n";
  const Provenance& from = chart.provenance;
  constexpr double kFramesInASecond = 60.0;
  for (const ChartResult& r : chart.results) {
    stream << fmt::format("here,{},{},{},{},{:g},{},{},{},{:.6g},{:.6g},{},{},{},{}", nameOf(r.what.scene), chart.limits.rows,
                          methodOf(r.what), nameOf(r.what.knob), r.what.value, r.what.iterations, csvText(nameOf(r.outcome)),
                          csvText(r.note), r.simulated_s, r.from_s, r.frames, r.samples, csvNumber(r.frame_ms),
                          csvNumber(1e-3 * kFramesInASecond * r.frame_ms));
    for (const double value : r.measured) stream << ',' << csvNumber(value);
    stream << fmt::format(",{},{},{},{},{}\n", from.commit, csvText(from.compiler), csvText(from.flags), csvText(from.processor),
                          from.date);
  }
  for (const PeerResult& peer : chart.peers) {
    stream << fmt::format("elsewhere,uniform,{},{},settings,{},,{},,,,,,{},{}", chart.limits.rows, csvText(peer.engine),
                          csvText(peer.settings), csvText(peer.verdict), csvNumber(carriedOver_ms(chart, peer)),
                          csvNumber(1e-3 * kFramesInASecond * carriedOver_ms(chart, peer)));
    for (const double value : peer.measured) stream << ',' << csvNumber(value);
    stream << ",elsewhere,,,,\n";
  }
}

double carriedOver_ms(const Chart& chart, const PeerResult& peer) {
  const ChartCase bullet{ChartScene::uniform, Method::rigidPgs, Knob::substeps, 16.0, Peer::bullet, 0};
  const auto found =
      std::find_if(chart.results.begin(), chart.results.end(), [&](const ChartResult& result) { return result.what == bullet; });
  const bool known = found != chart.results.end() && std::isfinite(found->frame_ms) && std::isfinite(peer.ratioToBullet);
  return known ? peer.ratioToBullet * found->frame_ms : std::nan("");
}

std::vector<PeerResult> readPeers(const std::string& path, int rows) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw InputError(fmt::format("--peers: cannot read {}", inQuotes(path)));
  std::string line;
  std::getline(stream, line);
  std::map<std::string, std::size_t> column;
  const std::vector<std::string> names = fieldsOf(line);
  for (std::size_t i = 0; i < names.size(); ++i) column[names[i]] = i;
  for (const char* needed : {"engine", "version", "settings", "scene", "rows", "threads", "stands_60_s", "worst_penetration_mm",
                             "top_height_error_mm", "creep_mm", "jitter_mm_s", "ms_per_frame", "ratio_to_bullet_16_substeps"}) {
    if (!column.contains(needed)) throw InputError(fmt::format("{}: found no column {}", onOneLine(path), inQuotes(needed)));
  }
  std::vector<PeerResult> peers;
  for (int number = 2; std::getline(stream, line); ++number) {
    const std::vector<std::string> fields = fieldsOf(line);
    if (fields.size() != names.size()) {
      throw InputError(
          fmt::format("{}:{}: found {} fields, allowed are {}", onOneLine(path), number, fields.size(), names.size()));
    }
    const auto text = [&](const char* name) { return fields[column[name]]; };
    const auto value = [&](const char* name) { return parseNumber(text(name)).value_or(std::nan("")); };
    if (text("scene") != "uniform" || value("rows") != rows || value("threads") != 1.0 || text("ms_per_frame").empty()) continue;
    PeerResult peer;
    peer.engine = text("engine");
    peer.settings = text("version") + ", " + text("settings");
    peer.verdict = text("stands_60_s");
    peer.measured = {value("worst_penetration_mm"),
                     std::abs(value("top_height_error_mm")) / rows,
                     std::nan(""),
                     value("creep_mm"),
                     value("jitter_mm_s"),
                     std::nan(""),
                     std::nan(""),
                     std::nan("")};
    peer.frame_ms = value("ms_per_frame");
    peer.ratioToBullet = value("ratio_to_bullet_16_substeps");
    peers.push_back(peer);
  }
  return peers;
}

}  // namespace springtower
