#include "apps/commands/run/report.h"

#include "apps/commands/run/moves_report.h"
#include "apps/common/json_values.h"
#include "core/limits.h"
#include "core/version.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace springtower {
namespace {

using Json = nlohmann::ordered_json;

Json orNull(const std::optional<double>& value, double scale = 1.0) {
  return value ? Json(scale * *value) : Json(nullptr);
}

Json timesJson(const FrameTimes& times) {
  return {{"median", times.median}, {"p99", times.p99}, {"max", times.max}, {"cpu_median", times.cpuMedian}};
}

Json stagesJson(const RunResult& result) {
  Json stages = Json::object();
  for (std::size_t i = 0; i < kStages; ++i) stages[std::string(kStageNames[i])] = result.stage_ms[i];
  return stages;
}

std::string_view nameOf(PrepareEnd end) {
  if (end == PrepareEnd::complete) return "complete";
  return end == PrepareEnd::outOfTime ? "out_of_time" : "cancelled";
}

Json prepareJson(const PrepareResult& prepared) {
  return {{"ms", 1e3 * prepared.wall_s},
          {"cpu_ms", 1e3 * prepared.processor_s},
          {"blocks", prepared.blocks},
          {"blocks_in_balance", prepared.blocksInBalance},
          {"end", nameOf(prepared.end)}};
}

// How the scene starts, in words.
std::string startInWords(const RunResult& result) {
  if (result.resumedAt_s) return fmt::format("as saved at {:.4g} s", *result.resumedAt_s);
  const PrepareResult& prepared = result.prepared;
  std::string text = fmt::format("{} of {} blocks in equilibrium, found in {:.3g} ms", prepared.blocksInBalance, prepared.blocks,
                                 1e3 * prepared.wall_s);
  if (prepared.end == PrepareEnd::outOfTime) text += "; out of time, the others as placed";
  if (prepared.end == PrepareEnd::cancelled) text += "; broken off, the others as placed";
  return text;
}

Json energyJson(const Energy& energy) {
  return {{"kinetic", energy.kinetic}, {"gravity", energy.gravity}, {"springs", energy.springs}, {"contacts", energy.contacts}};
}

Json wakesJson(const WakeCounts& wakes) {
  Json json;
  for (std::size_t i = 0; i < kWakeReasons; ++i) json[std::string(kWakeReasonNames[i])] = wakes[i];
  return json;
}

Json countersJson(const Counters& counters) {
  return {{"replayed_frames", counters.replayedFrames},
          {"block_pairs", counters.blockPairs},
          {"candidate_tests", counters.candidateTests},
          {"box_overlaps", counters.boxOverlaps},
          {"plane_crossings", counters.planeCrossings},
          {"cubic_tests", counters.cubicTests},
          {"cubic_hits", counters.cubicHits},
          {"contacts_born", counters.contactsCreated},
          {"contacts_born_penetrating", counters.contactsCreatedPenetrating},
          {"manifold_refreshes", counters.manifoldRefreshes},
          {"spring_evaluations", counters.springEvaluations},
          {"implicit_steps", counters.implicitSteps},
          {"implicit_iterations", counters.implicitIterations},
          {"factorisations", counters.factorisations},
          {"handed_over", counters.newtonFailures},
          {"margins_spent", counters.clearanceChecks},
          {"response_iterations", counters.responseIterations}};
}

// Blocks count from 0, as everywhere.
std::string placeOf(const Penetration& penetration) {
  if (penetration.second == kFloor) return fmt::format("block {}, floor", index(penetration.first));
  return fmt::format("blocks {} and {}", index(penetration.first), index(penetration.second));
}

Json deepestJson(const RunResult& result) {
  if (result.deepest.depth <= 0.0) return nullptr;
  return {{"depth_mm", kMillimetres * result.deepest.depth},
          {"block", index(result.deepest.first)},
          {"other", result.deepest.second == kFloor ? Json("floor") : Json(index(result.deepest.second))},
          {"time_s", result.deepestTime_s}};
}

std::string millimetres(const std::optional<double>& metres, std::string_view otherwise) {
  return metres ? fmt::format("{:.3g} mm", kMillimetres * *metres) : std::string(otherwise);
}

void row(std::string_view name, std::string_view value) {
  fmt::print("  {:<34}{}\n", name, value);
}

}  // namespace

Json reportJson(const Simulation& simulation, const RunResult& result, int threads) {
  const Settings& settings = simulation.scene.settings;
  Json report;
  report["version"] = kVersion;
  report["commit"] = kGitCommit;
  report["compiler"] = fmt::format("{}, {}, {}", kCompiler, kBuildType, kCompilerFlags);
  report["scene"] = simulation.scene.name;
  report["blocks"] = simulation.model.blockCount();
  report["method"] = nameOf(settings.method);
  report["inertia"] = nameOf(settings.inertia);
  report["sleep"] = nameOf(settings.sleep);
  report["tolerance_m"] = simulation.tolerance_m;
  report["stiffness_n_m"] = largestStiffness(simulation.stiffness);
  report["spring_stiffness_n_m"] = largest(simulation.stiffness.edge_n_m);
  report["substeps"] = result.substeps;
  report["threads"] = threads;

  report["stands"] = result.standing.stands;
  report["fall"] = result.standing.stands ? Json(nullptr) : Json(describe(result.standing));
  report["fall_time_s"] = orNull(result.fallTime_s);
  report["t_rest_s"] = orNull(result.restTime_s);
  report["interrupted"] = result.interrupted;
  report["resumed_at_s"] = orNull(result.resumedAt_s);
  report["simulated_s"] = result.simulated_s;
  report["wall_s"] = result.wall_s;
  report["prepare"] = prepareJson(result.prepared);
  report["frames"] = result.frames;
  report["steps"] = result.counters.steps;
  report["contact_evaluations"] = result.counters.contactEvaluations;
  report["cubic_tests"] = result.counters.cubicTests;
  report["contacts_born_penetrating"] = result.counters.contactsCreatedPenetrating;
  report["ms_per_frame"] = timesJson(result.frameTimes);
  report["stage_ms"] = stagesJson(result);

  report["max_penetration_mm"] = orNull(result.maxPenetration_m, kMillimetres);
  report["max_penetration_all_mm"] = kMillimetres * result.deepest.depth;
  report["deepest_penetration"] = deepestJson(result);
  report["bottom_row_compression_mm"] = kMillimetres * result.bottomRowCompression_m;
  report["max_strain"] = result.maxStrain;
  report["creep_mm"] = orNull(result.creep_m, kMillimetres);
  report["jitter_mm_s"] = kMillimetres * result.jitter_m_s;
  report["top_height_error_mm"] = kMillimetres * result.topHeightError_m;
  report["energy_start_j"] = result.energyStart.total();
  report["energy_end_j"] = result.energyEnd.total();
  report["energy_end_parts_j"] = energyJson(result.energyEnd);
  report["max_energy_rise"] = orNull(result.maxEnergyRise);
  report["max_force_imbalance"] = result.imbalance.force;
  report["max_torque_imbalance"] = result.imbalance.torque;
  report["max_outside_cone_n"] = result.outsideCone_n;
  report["asleep_blocks"] = result.asleepBlocks;
  report["awake_blocks"] = result.awakeBlocks;
  report["counters"] = countersJson(result.counters);
  report["wakes"] = wakesJson(result.wakes);
  if (!simulation.scene.moves.empty()) report["moves"] = movesJson(simulation, result);
  report["state_hash"] = fmt::format("{:016x}", result.stateHash);
  return report;
}

void printResult(const Simulation& simulation, const RunResult& result, int threads) {
  const Settings& settings = simulation.scene.settings;
  const FrameTimes& times = result.frameTimes;
  fmt::print("{}, {} blocks\n", onOneLine(simulation.scene.name), simulation.model.blockCount());
  row("method",
      fmt::format("{}, {} inertia, sleep {}", nameOf(settings.method), nameOf(settings.inertia), nameOf(settings.sleep)));
  row("tolerance", fmt::format("{:.4g} mm{}", kMillimetres * simulation.tolerance_m,
                               simulation.fixedSubsteps > 0 && !settings.tolerance_m ? ", as the substeps allow" : ""));
  row("contact stiffness", fmt::format("{:.4g} kN/m", 1e-3 * largestStiffness(simulation.stiffness)));
  row("start", startInWords(result));
  row("substeps", fmt::format("{} in the last awake frame, {} in all", result.substeps, result.counters.steps));
  if (result.standing.stands) {
    row("stands", "yes");
  } else {
    row("stands", fmt::format("no: from {:.3f} s on {}", result.fallTime_s.value_or(0.0), describe(result.standing)));
  }
  row("at rest", result.restTime_s ? fmt::format("from {:.2f} s on", *result.restTime_s) : "no");
  row("asleep", fmt::format("{} of {} blocks", result.asleepBlocks, result.asleepBlocks + result.awakeBlocks));
  const std::string woken = wakesInWords(result.wakes);
  if (!woken.empty()) row("woken", woken);
  row("penetration, settled", millimetres(result.maxPenetration_m, "not settled"));
  row("penetration, whole run", result.deepest.depth > 0.0
                                    ? fmt::format("{}, {} at {:.3f} s", millimetres(result.deepest.depth, ""),
                                                  placeOf(result.deepest), result.deepestTime_s)
                                    : "none");
  row("bottom row compressed", millimetres(result.bottomRowCompression_m, ""));
  row("creep", millimetres(result.creep_m, "not settled"));
  row("jitter, last second", fmt::format("{:.3g} mm/s", kMillimetres * result.jitter_m_s));
  row("height error against rigid stack", fmt::format("{:+.3g} mm", kMillimetres * result.topHeightError_m));
  row("max energy gain in a frame",
      result.maxEnergyRise ? fmt::format("{:.2g} of the most energy there was", *result.maxEnergyRise) : "unknown");
  row("simulated",
      fmt::format("{:.4g} s in {:.3g} s, {} thread{}", result.simulated_s, result.wall_s, threads, threads == 1 ? "" : "s"));
  if (result.interrupted) row("interrupted", "yes, by a signal: all figures are of the time until then");
  row("frame, CPU time", fmt::format("{:.3g} ms median", times.cpuMedian));
  row("frame, wall time",
      fmt::format("{:.3g} ms median, {:.3g} ms 99th percentile, {:.3g} ms longest", times.median, times.p99, times.max));
  row("state", fmt::format("{:016x}", result.stateHash));
  printMoves(simulation, result);
}

}  // namespace springtower
