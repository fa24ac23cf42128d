// The table of walls and pyramids, for people and as CSV.
#include "apps/commands/profile/named_row.h"
#include "apps/commands/profile/stacks.h"
#include "apps/common/output_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <ostream>

namespace springtower {
namespace {

std::vector<int> threadsOf(const std::vector<NamedRow>& rows) {
  std::vector<int> threads;
  for (const NamedRow& row : rows) {
    for (const ProfileResult* result : row.results) threads.push_back(result->what.threads);
  }
  std::sort(threads.begin(), threads.end());
  threads.erase(std::unique(threads.begin(), threads.end()), threads.end());
  return threads;
}

const StackGoal* goalOf(const std::string& stack) {
  const auto goals = stackGoals();
  const auto found = std::find_if(goals.begin(), goals.end(), [&](const StackGoal& goal) { return goal.stack == stack; });
  return found == goals.end() ? nullptr : &*found;
}

void add(std::string& list, const std::string& text) {
  list += (list.empty() ? "" : ", ") + text;
}

// A frame's time on one thread and on two, as far as they are measured, against bounds; what is above them goes to `misses`.
// Returns whether there was anything to judge.
bool judgeTimes(const NamedRow& row, const std::array<double, 2>& bounds_ms, std::string& misses) {
  bool judged = false;
  for (std::size_t i = 0; i < bounds_ms.size(); ++i) {
    const int threads = static_cast<int>(i) + 1;
    const ProfileResult* const result = row.on(threads);
    if (std::isnan(bounds_ms[i]) || result == nullptr) continue;
    judged = true;
    if (result->cost().median > bounds_ms[i]) add(misses, fmt::format("ms on {} thread{}", threads, threads == 1 ? "" : "s"));
  }
  return judged;
}

// "meets", "meets, goal too", or what it misses. Only the usual method is held to anything but standing.
std::string verdictOf(const NamedRow& row) {
  const ProfileResult& result = row.first();
  std::string misses;
  if (!result.stands) add(misses, "it fell");
  if (result.what.method != Settings{}.method) return misses.empty() ? "stands" : misses;
  if (result.penetration_mm > 1e3 * result.what.tolerance_m) add(misses, "depth");
  if (result.creepPerMinute_mm > kMaxStackCreepPerMinute_mm) add(misses, "creep");
  const StackGoal* const goal = goalOf(result.what.named);
  if (goal == nullptr) return misses.empty() ? "meets" : "misses: " + misses;
  judgeTimes(row, goal->required_ms, misses);
  if (result.equilibrium_s > goal->equilibrium_s) add(misses, "equilibrium");
  if (!misses.empty()) return "misses: " + misses;
  std::string beyond;
  const bool judged = judgeTimes(row, goal->goal_ms, beyond);
  return judged && beyond.empty() ? "meets, goal too" : "meets";
}

// "17, 11" of what is set; "-" where nothing is.
std::string boundsText(const std::array<double, 2>& bounds) {
  std::string text;
  for (const double bound : bounds) {
    if (!std::isnan(bound)) add(text, fmt::format("{:g}", bound));
  }
  return text.empty() ? "-" : text;
}

std::string requiredText(const NamedRow& row) {
  const StackGoal* const goal = goalOf(row.first().what.named);
  if (goal == nullptr || std::isnan(goal->required_ms[0])) return "-";
  return fmt::format("{} ({})", boundsText(goal->required_ms), boundsText(goal->goal_ms));
}

std::string firstText(const NamedRow& row) {
  const StackGoal* const goal = goalOf(row.first().what.named);
  const std::string measured = fmt::format("{:.2g}", row.first().equilibrium_s);
  return goal == nullptr || std::isnan(goal->equilibrium_s) ? measured : fmt::format("{} ({:g})", measured, goal->equilibrium_s);
}

std::string peerText(const ProfileResult& result) {
  const PeerFigures* const peer = nearestInAccuracy(result);
  if (peer == nullptr) return "-";
  const std::string depth = peer->stands ? fmt::format("{:.2g} mm", peer->penetration_mm) : "fell";
  return fmt::format("{} steps, {:.3g} ms, {} ({:.2g} s)", peer->substeps, peer->frame_ms, depth, peer->simulated_s);
}

void printRow(const NamedRow& row, const std::vector<int>& threads) {
  const ProfileResult& result = row.first();
  std::string name = result.what.named;
  if (result.what.method != Settings{}.method) name += " " + result.methodName;
  fmt::print("{:<17}{:>7}", name, result.blocks);
  if (!result.failure.empty()) {
    fmt::print("  {}\n", result.failure);
    return;
  }
  for (const int count : threads) {
    const ProfileResult* const one = row.on(count);
    if (one == nullptr || !one->failure.empty()) {
      fmt::print("  {:>24}", one == nullptr ? "-" : one->failure);
    } else {
      fmt::print("  {:>8.3g}{:>8.3g}{:>8.3g}", one->wall_ms.median, one->wall_ms.p99, one->processor_ms.median);
    }
  }
  fmt::print("  {:>16}{:>10.2g}{:>9.1g}  {:>11}  {:<20}  {}\n", requiredText(row), result.penetration_mm,
             result.creepPerMinute_mm, firstText(row), verdictOf(row), peerText(result));
}

void printGrowth(const Profile& profile) {
  for (const StackGrowth& growth : stackGrowth(profile)) {
    fmt::print("growth of {}, {} to {} blocks, {} thread{}: exponent {:.2f}, at most {} allowed: {}\n",
               familyOf(growth.family).what, growth.least, growth.most, growth.threads, growth.threads == 1 ? "" : "s",
               growth.exponent, kMaxGrowthExponent, growth.exponent <= kMaxGrowthExponent ? "meets" : "misses");
  }
}

}  // namespace

void printStacks(const Profile& profile) {
  const std::vector<NamedRow> rows = rowsOf(profile, isStack);
  if (rows.empty()) return;
  const std::vector<int> threads = threadsOf(rows);
  fmt::print(
      "\nwalls, pyramids and towers, at rest and awake: ms a frame (wall time, its 99th percentile, CPU time of all threads; of "
      "each frame\nthe minimum over the samples), required and in brackets the goal, judged by CPU time on one thread and by "
      "wall time on more;\ndepth mm (at most the tolerance), creep mm a minute (at most {:g}), equilibrium: s of CPU time "
      "(what is allowed);\nBullet: steps a frame nearest in depth, CPU time, depth, and for how long it was simulated\n",
      kMaxStackCreepPerMinute_mm);
  fmt::print("{:<17}{:>7}", "stack", "blocks");
  for (const int count : threads) fmt::print("  {:>8}{:>8}{:>8}", fmt::format("{} thr.", count), "p99", "cpu");
  fmt::print("  {:>16}{:>10}{:>9}  {:>11}  {:<20}  {}\n", "required (goal)", "depth", "creep", "prepare", "verdict", "Bullet");
  for (const NamedRow& row : rows) printRow(row, threads);
  printGrowth(profile);
}

void writeStacksCsv(std::ostream& stream, const Profile& profile) {
  stream << "engine,stack,blocks,method,tolerance_m,threads,substeps,wall_ms_median,wall_ms_p99,cpu_ms_median,cpu_ms_p99,"
            "penetration_mm,creep_mm_per_minute,equilibrium_s,simulated_s,stands,required_ms,goal_ms,first_frame_allowed_s,"
            "verdict,commit,compiler,flags,cpu,date\n";
  const std::string origin = csvText(profile.provenance) + "\n";
  const auto set = [](double bound) { return std::isnan(bound) ? std::string() : fmt::format("{:g}", bound); };
  for (const NamedRow& row : rowsOf(profile, isStack)) {
    const StackGoal* const goal = goalOf(row.first().what.named);
    for (const ProfileResult* result : row.results) {
      const ProfileCase& what = result->what;
      const bool judged = goal != nullptr && (what.threads == 1 || what.threads == 2);
      const auto at = static_cast<std::size_t>(what.threads - 1);
      stream << fmt::format("springtower,{},{},{},{:g},{},{:g},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", what.named,
                            result->blocks, result->methodName, what.tolerance_m, what.threads, result->substeps,
                            result->wall_ms.median, result->wall_ms.p99, result->processor_ms.median, result->processor_ms.p99,
                            result->penetration_mm, result->creepPerMinute_mm, result->equilibrium_s, result->prepared_s,
                            result->stands ? "yes" : "no", judged ? set(goal->required_ms[at]) : "",
                            judged ? set(goal->goal_ms[at]) : "", goal != nullptr ? set(goal->equilibrium_s) : "",
                            csvText(result->failure.empty() ? verdictOf(row) : result->failure), origin);
    }
    for (const PeerFigures& peer : row.first().peers) {
      stream << fmt::format("{},{},{},,,1,{},,,{},,{},,,{},{},,,,,{}", peer.engine, row.first().what.named, row.first().blocks,
                            peer.substeps, peer.frame_ms, peer.penetration_mm, peer.simulated_s, peer.stands ? "yes" : "no",
                            origin);
    }
  }
}

}  // namespace springtower
