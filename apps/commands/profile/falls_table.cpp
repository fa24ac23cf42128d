// The table of falls, for people and as CSV.
#include "apps/commands/profile/falls.h"
#include "apps/commands/profile/named_row.h"
#include "apps/commands/profile/stacks.h"
#include "apps/common/output_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <ostream>

namespace springtower {
namespace {

constexpr double kBytesPerKb = 1000.0;

// Null where it was not timed on so many threads, or failed.
const ProfileResult* timedOn(const NamedRow& fall, int threads) {
  const ProfileResult* const result = fall.on(threads);
  return result != nullptr && result->failure.empty() ? result : nullptr;
}

// How many times as fast two threads are as one, in the median of wall time; empty where one of them was not timed.
std::optional<double> twoThreadsOf(const NamedRow& fall) {
  const ProfileResult* const one = timedOn(fall, 1);
  const ProfileResult* const two = timedOn(fall, 2);
  if (one == nullptr || two == nullptr || two->wall_ms.median <= 0.0) return {};
  return one->wall_ms.median / two->wall_ms.median;
}

const FallGoal* fallGoalOf(const std::string& fall) {
  const auto goals = fallGoals();
  const auto found = std::find_if(goals.begin(), goals.end(), [&](const FallGoal& goal) { return goal.fall == fall; });
  return found == goals.end() ? nullptr : &*found;
}

// "meets", "meets, goal too", or what it misses. Only the usual method is held to anything.
std::string fallVerdict(const NamedRow& fall) {
  constexpr double kGoalDepth_mm = 0.5;
  const ProfileResult& result = fall.first();
  if (!result.failure.empty()) return result.failure;
  if (result.what.method != Settings{}.method) return "-";
  const FallGoal* const goal = fallGoalOf(result.what.named);
  const ProfileResult* const one = timedOn(fall, 1);
  std::string misses;
  const auto miss = [&](bool missed, std::string_view what) {
    if (missed) misses += fmt::format("{}{}", misses.empty() ? "misses: " : ", ", what);
  };
  if (goal != nullptr && one != nullptr) {
    miss(one->processor_ms.median > goal->required_ms, "median");
    miss(one->processor_ms.max > goal->requiredWorst_ms, "worst");
  }
  miss(result.penetration_mm > (goal != nullptr ? goal->required_mm : 1.0), "depth");
  miss(result.energyRise > kMaxFallEnergyRise, "energy");
  miss(result.allBytes > kMaxFallBytes, "memory");
  const std::optional<double> faster = twoThreadsOf(fall);
  miss(faster && *faster < kLeastTwoThreads && result.blocks >= kTwoThreadsBlocks, "two threads");
  if (!misses.empty()) return misses;
  const bool goalToo = goal != nullptr && one != nullptr && one->processor_ms.median <= goal->goal_ms &&
                       one->processor_ms.max <= goal->goalWorst_ms && result.penetration_mm <= kGoalDepth_mm;
  return goalToo ? "meets, goal too" : "meets";
}

void printFall(const NamedRow& fall) {
  const ProfileResult& result = fall.first();
  std::string name = result.what.named;
  if (result.what.method != Settings{}.method) name += " " + result.methodName;
  fmt::print("{:<14}{:>7}", name, result.blocks);
  if (!result.failure.empty()) {
    fmt::print("  {}\n", result.failure);
    return;
  }
  const FallGoal* const goal = fallGoalOf(result.what.named);
  const std::optional<double> faster = twoThreadsOf(fall);
  fmt::print("{:>10.3g}{:>9.3g}{:>8}  {:>12}  {:>10}{:>9.3g}{:>10.1e}{:>7.3g}  {:<34}", result.cost().median, result.cost().max,
             faster ? fmt::format("{:.2f}", *faster) : "-",
             goal != nullptr ? fmt::format("{:g} / {:g}", goal->required_ms, goal->requiredWorst_ms) : "-",
             goal != nullptr ? fmt::format("{:g} / {:g}", goal->goal_ms, goal->goalWorst_ms) : "-", result.penetration_mm,
             result.energyRise, result.allBytes / kBytesPerKb, fallVerdict(fall));
  if (const PeerFigures* const peer = nearestInAccuracy(result); peer != nullptr) {
    fmt::print("  {} steps, {:.3g} / {:.3g} ms, {:.2g} mm ({:.2g} s)\n", peer->substeps, peer->frame_ms, peer->worst_ms,
               peer->penetration_mm, peer->simulated_s);
  } else {
    fmt::print("  -\n");
  }
}

}  // namespace

void printFalls(const Profile& profile) {
  const std::vector<NamedRow> falls = rowsOf(profile, isFall);
  if (falls.empty()) return;
  fmt::print(
      "\nfalls, all blocks awake: ms a frame in the median and in the worst frame but the first (CPU time on one thread,\n"
      "else wall time), how many times as fast two threads are (at least {:g} from {} blocks on), required and goal, depth mm\n"
      "(at most 1, goal 0.5), largest rise of energy in a frame of what there was (at most {:g}), memory kB a block (at most "
      "{:g});\nBullet: steps a frame nearest in depth, CPU time of the median and the worst frame, depth, and for how long "
      "it was looked at\n",
      kLeastTwoThreads, kTwoThreadsBlocks, kMaxFallEnergyRise, kMaxFallBytes / kBytesPerKb);
  fmt::print("{:<14}{:>7}{:>10}{:>9}{:>8}  {:>12}  {:>10}{:>9}{:>10}{:>7}  {:<34}  {}\n", "fall", "blocks", "ms median", "worst",
             "2 thr.", "required", "goal", "depth", "energy", "kB", "verdict", "Bullet");
  for (const NamedRow& fall : falls) printFall(fall);
}

void writeFallsCsv(std::ostream& stream, const Profile& profile) {
  stream << "engine,fall,blocks,method,tolerance_m,threads,substeps,wall_ms_median,wall_ms_max,cpu_ms_median,cpu_ms_max,"
            "penetration_mm,energy_rise,bytes_per_block,simulated_s,required_ms,required_worst_ms,goal_ms,goal_worst_ms,verdict,"
            "commit,compiler,flags,cpu,date\n";
  const std::string origin = csvText(profile.provenance) + "\n";
  for (const NamedRow& fall : rowsOf(profile, isFall)) {
    const FallGoal* const goal = fallGoalOf(fall.first().what.named);
    for (const ProfileResult* result : fall.results) {
      const std::string goals =
          goal == nullptr || result->what.threads != 1
              ? ",,,"
              : fmt::format("{:g},{:g},{:g},{:g}", goal->required_ms, goal->requiredWorst_ms, goal->goal_ms, goal->goalWorst_ms);
      stream << fmt::format("springtower,{},{},{},{:g},{},{:g},{},{},{},{},{},{},{},{},{},{},{}", result->what.named,
                            result->blocks, result->methodName, result->what.tolerance_m, result->what.threads, result->substeps,
                            result->wall_ms.median, result->wall_ms.max, result->processor_ms.median, result->processor_ms.max,
                            result->penetration_mm, result->energyRise, result->allBytes, result->frames * Settings{}.frame_s,
                            goals, csvText(fallVerdict(fall)), origin);
    }
    for (const PeerFigures& peer : fall.first().peers) {
      stream << fmt::format("{},{},{},,,1,{},,,{},{},{},,,{},,,,,,{}", peer.engine, fall.first().what.named, fall.first().blocks,
                            peer.substeps, peer.frame_ms, peer.worst_ms, peer.penetration_mm, peer.simulated_s, origin);
    }
  }
}

}  // namespace springtower
