#include "apps/commands/run/moves_report.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace springtower {
namespace {

std::string_view shortNameOf(Rest rest) {
  switch (rest) {
    case Rest::stands:
      return "stands";
    case Rest::leans:
      return "leans";
    case Rest::falls:
      return "falls";
  }
  return {};
}

std::string outcomeOf(const Move& move, const MoveResult& result) {
  if (!result.done) return "not done";
  if (!result.rested) return "not at rest";
  if (!move.allowed_m) return "";
  return fmt::format("{} {:g} mm", isWithin(move, result) ? "within" : "beyond", 1e3 * *move.allowed_m);
}

constexpr std::size_t kColumns = 12;  // blocks side by side

// A table of how far each other block moved in each step, some blocks side by side.
void printEach(const RunResult& result) {
  if (result.moves.empty()) return;
  const std::size_t blocks = result.moves.front().each_m.size();
  for (std::size_t first = 0; first < blocks; first += kColumns) {
    const std::size_t last = std::min(first + kColumns, blocks);
    fmt::print("\n  {:<16}", "moved mm, block");
    for (std::size_t b = first; b < last; ++b) fmt::print("{:>9}", b);
    fmt::print("\n");
    for (std::size_t i = 0; i < result.moves.size(); ++i) {
      const MoveResult& what = result.moves[i];
      fmt::print("  {:<16}", fmt::format("step {}", i + 1));
      for (std::size_t b = first; b < last; ++b) {
        fmt::print("{:>9}", b == index(what.block) ? "-" : fmt::format("{:.4f}", 1e3 * what.each_m[b]));
      }
      fmt::print("\n");
    }
  }
}

}  // namespace

std::string describe(const Move& move) {
  switch (move.kind) {
    case MoveKind::take:
      return fmt::format("take row {}, position {}, {:g} m/s", move.row, move.position, move.speed_m_s);
    case MoveKind::put:
      return fmt::format("{} row {}, position {}", move.drop_m > 0.0 ? fmt::format("drop {:g} cm,", 1e2 * move.drop_m) : "lay",
                         move.row, move.position);
    case MoveKind::putAside:
      return "put aside";
  }
  return {};
}

nlohmann::ordered_json movesJson(const Simulation& simulation, const RunResult& result) {
  nlohmann::ordered_json moves = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < result.moves.size(); ++i) {
    const Move& move = simulation.scene.moves[i];
    const MoveResult& what = result.moves[i];
    nlohmann::ordered_json each = nlohmann::ordered_json::array();
    for (const double moved : what.each_m) each.push_back(1e3 * moved);
    moves.push_back(
        {{"move", describe(move)},
         {"block", index(what.block)},
         {"done", what.done},
         {"rested", what.rested},
         {"largest_moved_mm", 1e3 * what.moved_m},
         {"largest_moved_block", what.moved == kFloor ? nlohmann::ordered_json() : nlohmann::ordered_json(index(what.moved))},
         {"moved_mm", each},
         {"statics", shortNameOf(what.statics)},
         {"rigid_settlement_mm", 1e3 * what.settlement_m},
         {"allowed_mm", move.allowed_m ? nlohmann::ordered_json(1e3 * *move.allowed_m) : nlohmann::ordered_json()},
         {"within", isWithin(move, what)},
         {"slide_mm", 1e3 * what.slide_m},
         {"largest_force_n", what.force_n},
         {"begin_s", what.begin_s},
         {"end_s", what.end_s}});
  }
  return moves;
}

void printMoves(const Simulation& simulation, const RunResult& result) {
  if (simulation.scene.moves.empty()) return;
  fmt::print("  {:<38}{:>9}{:>6}{:>12}{:>10}{:>8}  {}\n", "move", "moved mm", "block", "settling mm", "slide mm", "force N", "");
  for (std::size_t i = 0; i < result.moves.size(); ++i) {
    const Move& move = simulation.scene.moves[i];
    const MoveResult& what = result.moves[i];
    fmt::print("  {:<38}{:>9.4f}{:>6}{:>12.4f}{:>10.4f}{:>8.3f}  {}\n", describe(move), 1e3 * what.moved_m,
               what.moved == kFloor ? "-" : fmt::format("{}", index(what.moved)), 1e3 * what.settlement_m, 1e3 * what.slide_m,
               what.force_n, outcomeOf(move, what));
  }
  fmt::print("  {} of {} moves made\n", result.moves.size(), simulation.scene.moves.size());
  printEach(result);
}

}  // namespace springtower
