#include "core/error.h"
#include "core/limits.h"
#include "core/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>
#include <utility>

namespace springtower {
namespace {

void checkNumbers(const Move& move, const std::string& where) {
  requireInRange(move.speed_m_s, kMoveSpeedRange, where + ": speed");
  requireInRange(move.drop_m, kDropRange, where + ": drop");
  requireInRange(move.limit_n, kHandForceRange, where + ": force");
  if (move.allowed_m) requireInRange(*move.allowed_m, kAllowedMoveRange, where + ": allowed");
  requireInRange(move.row, {0.0, kMaxRows - 1.0, ""}, where + ": row");
  requireInRange(move.position, {1.0, 3.0, ""}, where + ": position");
  if (move.towards.cwiseAbs() == Vec3::UnitX() || move.towards.cwiseAbs() == Vec3::UnitY()) return;
  throw InputError(where + ": expected the direction +x, -x, +y or -y, got another");
}

}  // namespace

void checkMoves(const Scene& scene, std::string_view source) {
  std::set<std::pair<int, int>> taken;  // places with a block
  std::set<std::pair<int, int>> fixed;
  for (const BlockSpec& block : scene.blocks) {
    if (block.row < 0) continue;
    taken.emplace(block.row, block.position);
    if (block.fixed) fixed.emplace(block.row, block.position);
  }
  bool held = false;
  for (std::size_t i = 0; i < scene.moves.size(); ++i) {
    const Move& move = scene.moves[i];
    const std::string where = fmt::format("{}: moves[{}]", source, i);
    const std::string place = fmt::format("row {}, position {}", move.row, move.position);
    checkNumbers(move, where);
    if (move.kind == MoveKind::take) {
      if (held) throw InputError(where + ": expected put or put-aside before the next take, got take with a block in the hand");
      if (fixed.contains({move.row, move.position}))
        throw InputError(fmt::format("{}: expected a block that moves, got {}, whose block is fixed", where, place));
      if (taken.erase({move.row, move.position}) == 0) {
        throw InputError(fmt::format("{}: expected a place of the tower that has a block, got {} without one", where, place));
      }
      held = true;
      continue;
    }
    if (!held) throw InputError(where + ": expected take before it, got nothing in the hand to put");
    held = false;
    if (move.kind == MoveKind::putAside) {
      if (!scene.floor) throw InputError(where + ": expected a floor to put a block on, got none");
      continue;
    }
    const bool carried =
        move.row == 0 || std::any_of(taken.begin(), taken.end(), [&](const auto& other) { return other.first == move.row - 1; });
    if (!carried || !taken.emplace(move.row, move.position).second) {
      throw InputError(
          fmt::format("{}: expected a free place on a row, got {} {}", where, place, carried ? "with a block" : "on no row"));
    }
  }
}

}  // namespace springtower
