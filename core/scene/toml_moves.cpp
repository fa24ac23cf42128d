#include "core/scene/toml_moves.h"

#include <array>

namespace springtower {
namespace {

struct NamedKind {
  std::string_view name;
  MoveKind kind;
  std::vector<std::string_view> keys;  // beside `do`
};

const std::array<NamedKind, 3>& kinds() {
  static const std::array<NamedKind, 3> all = {
      {{"take", MoveKind::take, {"row", "position", "towards", "speed_m_s", "force_n", "allowed_m"}},
       {"put", MoveKind::put, {"row", "position", "drop_m", "force_n", "allowed_m"}},
       {"put-aside", MoveKind::putAside, {"force_n", "allowed_m"}}}};
  return all;
}

const NamedKind& blockClassOf(const Table& table) {
  std::string name;
  table.require("do");
  table.read("do", name);
  for (const NamedKind& kind : kinds()) {
    if (kind.name == name) return kind;
  }
  throw InputError(fmt::format("{}: expected take, put or put-aside, got {}", table.where("do"), inQuotes(name)));
}

Vec3 directionOf(const Table& table) {
  std::string name;
  table.require("towards");
  table.read("towards", name);
  if (name == "+x") return Vec3::UnitX();
  if (name == "-x") return -Vec3::UnitX();
  if (name == "+y") return Vec3::UnitY();
  if (name == "-y") return -Vec3::UnitY();
  throw InputError(fmt::format("{}: expected +x, -x, +y or -y, got {}", table.where("towards"), inQuotes(name)));
}

}  // namespace

const std::vector<std::string_view> kMoveKeys = {"do",        "row",    "position", "towards",
                                                 "speed_m_s", "drop_m", "force_n",  "allowed_m"};

Move readMove(const Table& table) {
  const NamedKind& kind = blockClassOf(table);
  for (const std::string_view key : kMoveKeys) {
    const bool used = key == "do" || std::find(kind.keys.begin(), kind.keys.end(), key) != kind.keys.end();
    if (used || !table.has(key)) continue;
    throw InputError(fmt::format("{}: expected {} for {}, got {}", table.where(key), fmt::join(kind.keys, ", "), kind.name, key));
  }
  Move move;
  move.kind = kind.kind;
  if (move.kind != MoveKind::putAside) {
    for (const std::string_view key : {"row", "position"}) table.require(key);
    table.readWhole("row", move.row, 0, kMaxRows - 1);
    table.readWhole("position", move.position, 1, 3);
  }
  if (move.kind == MoveKind::take) move.towards = directionOf(table);
  table.read("speed_m_s", move.speed_m_s, kMoveSpeedRange);
  table.read("drop_m", move.drop_m, kDropRange);
  table.read("force_n", move.limit_n, kHandForceRange);
  table.read("allowed_m", move.allowed_m, kAllowedMoveRange);
  return move;
}

}  // namespace springtower
