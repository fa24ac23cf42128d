#include "apps/commands/profile/files.h"

#include "apps/commands/profile/falls.h"
#include "apps/commands/profile/stacks.h"
#include "apps/common/output_file.h"
#include "core/error.h"
#include "core/limits.h"
#include "core/whole_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

Json costJson(const FrameCost& cost) {
  return {{"median", cost.median}, {"p99", cost.p99}, {"max", cost.max}};
}

FrameCost costFromJson(const Json& json) {
  return {json.at("median").get<double>(), json.at("p99").get<double>(), json.at("max").get<double>()};
}

std::string sizeWithUnit(const ProfileCase& what) {
  if (isNamed(what.scene)) return what.named;
  return fmt::format("{} rows{}", what.rows, what.towers > 1 ? fmt::format(" x {}", what.towers) : "");
}

void addNamed(const ProfileResult& result, Json& json) {
  if (isStack(result.what.scene)) {
    json["stack"] = result.what.named;
    json["equilibrium_s"] = result.equilibrium_s;
    json["creep_mm_per_minute"] = result.creepPerMinute_mm;
  } else {
    json["fall"] = result.what.named;
    json["energy_rise"] = result.energyRise;
  }
  json["peers"] = Json::array();
  for (const PeerFigures& peer : result.peers) {
    json["peers"].push_back({{"engine", peer.engine},
                             {"substeps", peer.substeps},
                             {"cpu_ms_median", peer.frame_ms},
                             {"cpu_ms_max", peer.worst_ms},
                             {"penetration_mm", peer.penetration_mm},
                             {"simulated_s", peer.simulated_s},
                             {"stands", peer.stands}});
  }
}

void readNamed(const Json& json, ProfileResult& result) {
  if (isStack(result.what.scene)) {
    result.what.named = stackFrom(json.at("stack").get<std::string>());
    json.at("equilibrium_s").get_to(result.equilibrium_s);
    json.at("creep_mm_per_minute").get_to(result.creepPerMinute_mm);
  } else {
    result.what.named = fallFrom(json.at("fall").get<std::string>());
    json.at("energy_rise").get_to(result.energyRise);
  }
  for (const Json& one : json.at("peers")) {
    PeerFigures peer;
    one.at("engine").get_to(peer.engine);
    one.at("substeps").get_to(peer.substeps);
    one.at("cpu_ms_median").get_to(peer.frame_ms);
    if (one.contains("cpu_ms_max")) one.at("cpu_ms_max").get_to(peer.worst_ms);  // profiles of before the falls have none
    one.at("penetration_mm").get_to(peer.penetration_mm);
    one.at("simulated_s").get_to(peer.simulated_s);
    one.at("stands").get_to(peer.stands);
    result.peers.push_back(peer);
  }
}

Json resultJson(const ProfileResult& result) {
  Json json;
  json["scene"] = nameOf(result.what.scene);
  json["rows"] = result.what.rows;
  json["towers"] = result.what.towers;
  json["blocks"] = result.blocks;
  json["method"] = result.methodName;
  json["inertia"] = nameOf(result.what.inertia);
  json["tolerance_m"] = result.what.tolerance_m;
  json["threads"] = result.what.threads;
  json["failure"] = result.failure.empty() ? Json(nullptr) : Json(result.failure);
  json["prepared_s"] = result.prepared_s;
  json["frames"] = result.frames;
  json["samples"] = result.samples;
  json["cpu_ms"] = costJson(result.processor_ms);
  json["wall_ms"] = costJson(result.wall_ms);
  json["raw_wall_ms"] = costJson(result.rawWall_ms);
  json["frames_per_second"] = result.framesPerSecond();
  Json stages = Json::object();
  for (std::size_t i = 0; i < kStages; ++i) stages[std::string(kStageNames[i])] = result.stage_ms[i];
  json["stage_ms"] = stages;
  Json counters = Json::object();
  for (std::size_t i = 0; i < kCounterNames.size(); ++i) counters[std::string(kCounterNames[i].first)] = result.counted[i];
  json["counters_per_frame"] = counters;
  json["substeps"] = result.substeps;
  json["stiffness_n_m"] = result.stiffness_n_m;
  json["max_penetration_mm"] = result.penetration_mm;
  json["bottom_row_compression_mm"] = result.compression_mm;
  json["stands"] = result.stands;
  json["bytes_per_block"] = {{"state", result.stateBytes}, {"contacts", result.contactBytes}, {"all", result.allBytes}};
  json["bytes_per_pair"] = {
      {"near", result.pairBytes}, {"touching", result.touchingBytes}, {"touching_step", result.touchingStepBytes}};
  if (isNamed(result.what.scene)) addNamed(result, json);
  json["frame_ms"] = result.frame_ms;
  return json;
}

ProfileResult profileResultFromJson(const Json& json) {
  ProfileResult result;
  const auto scene = json.at("scene").get<std::string>();
  const auto* const found = std::find(kProfileSceneNames.begin(), kProfileSceneNames.end(), scene);
  if (found == kProfileSceneNames.end())
    throw InputError(fmt::format("scene: expected {}, got {}", fmt::join(kProfileSceneNames, ", "), inQuotes(scene)));
  result.what.scene = static_cast<ProfileScene>(found - kProfileSceneNames.begin());
  json.at("rows").get_to(result.what.rows);
  json.at("towers").get_to(result.what.towers);
  json.at("blocks").get_to(result.blocks);
  json.at("method").get_to(result.methodName);
  result.what.method = methodFromName(result.methodName, "method");
  result.what.inertia = inertiaFromName(json.at("inertia").get<std::string>(), "inertia");
  json.at("tolerance_m").get_to(result.what.tolerance_m);
  json.at("threads").get_to(result.what.threads);
  if (!json.at("failure").is_null()) json.at("failure").get_to(result.failure);
  json.at("prepared_s").get_to(result.prepared_s);
  json.at("frames").get_to(result.frames);
  json.at("samples").get_to(result.samples);
  result.processor_ms = costFromJson(json.at("cpu_ms"));
  result.wall_ms = costFromJson(json.at("wall_ms"));
  result.rawWall_ms = costFromJson(json.at("raw_wall_ms"));
  for (std::size_t i = 0; i < kStages; ++i) json.at("stage_ms").at(std::string(kStageNames[i])).get_to(result.stage_ms[i]);
  for (std::size_t i = 0; i < kCounterNames.size(); ++i) {
    json.at("counters_per_frame").at(std::string(kCounterNames[i].first)).get_to(result.counted[i]);
  }
  json.at("substeps").get_to(result.substeps);
  json.at("stiffness_n_m").get_to(result.stiffness_n_m);
  json.at("max_penetration_mm").get_to(result.penetration_mm);
  json.at("bottom_row_compression_mm").get_to(result.compression_mm);
  json.at("stands").get_to(result.stands);
  json.at("bytes_per_block").at("state").get_to(result.stateBytes);
  json.at("bytes_per_block").at("contacts").get_to(result.contactBytes);
  json.at("bytes_per_block").at("all").get_to(result.allBytes);
  if (json.contains("bytes_per_pair")) {  // profiles of before the tables of pairs have none
    json.at("bytes_per_pair").at("near").get_to(result.pairBytes);
    json.at("bytes_per_pair").at("touching").get_to(result.touchingBytes);
    json.at("bytes_per_pair").at("touching_step").get_to(result.touchingStepBytes);
  }
  if (isNamed(result.what.scene)) readNamed(json, result);
  json.at("frame_ms").get_to(result.frame_ms);
  return result;
}

}  // namespace

void writeProfileJson(std::ostream& stream, const Profile& profile) {
  Json json = provenanceJson(profile.provenance);
  json["limits"] = {{"samples", profile.limits.samples},   {"frames", profile.limits.frames},
                    {"settle_s", profile.limits.settle_s}, {"prepare_s", profile.limits.prepare_s},
                    {"sample_s", profile.limits.sample_s}, {"peer_s", profile.limits.peer_s}};
  json["cases"] = Json::array();
  for (const ProfileResult& result : profile.results) json["cases"].push_back(resultJson(result));
  stream << json.dump(1) << '\n';
}

Profile readProfileJson(const std::string& path) {
  const std::string text = wholeFile(path, "--from " + inQuotes(path), kMaxResultsBytes);
  try {
    const Json json = Json::parse(text);
    Profile profile;
    profile.provenance = provenanceFromJson(json);
    const Json& limits = json.at("limits");
    limits.at("samples").get_to(profile.limits.samples);
    limits.at("frames").get_to(profile.limits.frames);
    limits.at("settle_s").get_to(profile.limits.settle_s);
    limits.at("prepare_s").get_to(profile.limits.prepare_s);
    limits.at("sample_s").get_to(profile.limits.sample_s);
    if (limits.contains("peer_s")) limits.at("peer_s").get_to(profile.limits.peer_s);  // earlier profiles have no stacks
    for (const Json& result : json.at("cases")) profile.results.push_back(profileResultFromJson(result));
    return profile;
  } catch (const Json::exception& error) {
    throw InputError(fmt::format("{}: expected the profile.json of a profile of this version, got another file: {}",
                                 onOneLine(path), onOneLine(error.what())));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", onOneLine(path), error.what()));
  }
}

void writeProfileCsv(std::ostream& stream, const Profile& profile) {
  stream << "scene,rows,towers,blocks,method,inertia,tolerance_m,threads,failure,prepared_s,frames,samples,frames_per_second,"
            "cpu_ms_median,cpu_ms_p99,cpu_ms_max,wall_ms_median,wall_ms_p99,wall_ms_max,raw_wall_ms_median,raw_wall_ms_p99,"
            "raw_wall_ms_max";
  for (const std::string_view name : kStageNames) stream << ',' << name << "_ms";
  for (const auto& [name, member] : kCounterNames) stream << ',' << name;
  stream << ",substeps,stiffness_n_m,max_penetration_mm,bottom_row_compression_mm,stands,state_bytes_per_block,"
            "contact_bytes_per_block,bytes_per_block,bytes_per_near_pair,bytes_per_touching_pair,"
            "step_bytes_per_touching_pair,commit,compiler,flags,cpu,date\n";
  const Provenance& from = profile.provenance;
  for (const ProfileResult& result : profile.results) {
    stream << fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", nameOf(result.what.scene), result.what.rows,
                          result.what.towers, result.blocks, result.methodName, nameOf(result.what.inertia),
                          result.what.tolerance_m, result.what.threads, csvText(result.failure), result.prepared_s, result.frames,
                          result.samples, result.framesPerSecond());
    for (const FrameCost* cost : {&result.processor_ms, &result.wall_ms, &result.rawWall_ms}) {
      stream << fmt::format(",{},{},{}", cost->median, cost->p99, cost->max);
    }
    for (const double value : result.stage_ms) stream << fmt::format(",{}", value);
    for (const double value : result.counted) stream << fmt::format(",{}", value);
    stream << fmt::format(",{},{},{},{},{},{},{},{},{},{},{}", result.substeps, result.stiffness_n_m, result.penetration_mm,
                          result.compression_mm, result.stands ? "yes" : "no", result.stateBytes, result.contactBytes,
                          result.allBytes, result.pairBytes, result.touchingBytes, result.touchingStepBytes);
    stream << fmt::format(",{}\n", csvText(from));
  }
}

void writeTrace(std::ostream& stream, const Provenance& provenance, const std::vector<TracedCase>& traced) {
  Json events = Json::array();
  const auto name = [&](const char* kind, int process, int thread, const std::string& text) {
    events.push_back({{"ph", "M"}, {"name", kind}, {"pid", process}, {"tid", thread}, {"args", {{"name", text}}}});
  };
  for (std::size_t i = 0; i < traced.size(); ++i) {
    const ProfileCase& what = traced[i].what;
    if (traced[i].frames.empty()) continue;
    const int process = static_cast<int>(what.scene) + 1;
    const int thread = static_cast<int>(i) + 1;
    name("process_name", process, 0, std::string(nameOf(what.scene)));
    name("thread_name", process, thread,
         fmt::format("{}, {}, {:g} mm, {} thread{}", sizeWithUnit(what), nameOf(what.method), 1e3 * what.tolerance_m,
                     what.threads, what.threads == 1 ? "" : "s"));
    int number = 0;
    for (const TracedFrame& frame : traced[i].frames) {
      const auto slice = [&](std::string_view label, double start_us, double duration_us, Json arguments) {
        events.push_back({{"ph", "X"},
                          {"name", label},
                          {"pid", process},
                          {"tid", thread},
                          {"ts", start_us},
                          {"dur", duration_us},
                          {"args", std::move(arguments)}});
      };
      slice("frame", frame.start_us, frame.duration_us,
            {{"number", ++number},
             {"substeps", frame.substeps},
             {"contact_evaluations", frame.contactEvaluations},
             {"awake_blocks", frame.awakeBlocks}});
      const double sum = std::accumulate(frame.stage_us.begin(), frame.stage_us.end(), 0.0);
      const double shrink = sum > frame.duration_us ? frame.duration_us / sum : 1.0;
      double start = frame.start_us;
      for (std::size_t s = 0; s < kStages; ++s) {
        if (frame.stage_us[s] <= 0.0) continue;
        slice(kStageNames[s], start, shrink * frame.stage_us[s], {{"ms", 1e-3 * frame.stage_us[s]}});
        start += shrink * frame.stage_us[s];
      }
    }
  }
  const Json trace = {{"traceEvents", events}, {"displayTimeUnit", "ms"}, {"otherData", provenanceJson(provenance)}};
  stream << trace.dump() << '\n';
}

}  // namespace springtower
