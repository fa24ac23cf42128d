#include "core/error.h"
#include "core/limits.h"
#include "core/scene/corners.h"
#include "core/scene/rotation.h"
#include "core/scene/scene.h"
#include "core/scene/toml_keys.h"
#include "core/scene/toml_moves.h"
#include "core/scene/toml_table.h"
#include "core/whole_file.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <toml++/toml.h>
#include <utility>

namespace springtower {
namespace {

constexpr std::int64_t kMaxWhole = std::numeric_limits<std::int64_t>::max();

// Corners as `run --poses` writes them. checkScene finds the cuboid that fits them.
void readCorners(const Table& table, BlockSpec& block) {
  for (const std::string_view key : {"centre_m", "rotation_deg"}) {
    if (table.has(key)) throw InputError(fmt::format("{}: expected {} or corners_m, got both", table.where(key), key));
  }
  CornerPlaces corners;
  table.read("corners_m", corners, kPlaceRange);
  placeByCorners(corners, block);
}

// Friction of a table that has other keys as well: one coefficient, or both; nothing where it has none of them.
void readSurface(const Table& table, std::optional<Friction>& friction) {
  const bool both = table.has("static_friction") || table.has("kinetic_friction");
  if (!both && !table.has("friction")) return;
  if (both && table.has("friction"))
    throw InputError(table.where() + ": expected either friction or static_friction with kinetic_friction, got both");
  Friction& read = friction.emplace();
  if (!both) {
    table.read("friction", read.staticFriction, kFrictionRange);
    read.kineticFriction = read.staticFriction;
    return;
  }
  table.require("static_friction");
  table.require("kinetic_friction");
  table.read("static_friction", read.staticFriction, kFrictionRange);
  table.read("kinetic_friction", read.kineticFriction, {0.0, read.staticFriction, "(the static one)"});
}

FrictionPair readFrictionPair(const Table& table, std::size_t blocks) {
  FrictionPair pair;
  for (const std::string_view key : {"a", "b"}) table.require(key);
  const auto last = static_cast<std::int64_t>(blocks) - 1;
  table.readWhole("a", pair.a, -1, last);
  table.readWhole("b", pair.b, -1, last);
  std::optional<Friction> friction;
  readSurface(table, friction);
  if (!friction) throw InputError(table.where() + ": expected friction or static_friction with kinetic_friction, got neither");
  pair.friction = *friction;
  return pair;
}

BlockSpec readBlock(const Table& table) {
  BlockSpec block;
  table.read("dimensions_m", block.dimensions, kDimensionRange);
  if (table.has("corners_m")) {
    readCorners(table, block);
  } else {
    table.require("centre_m");
    table.read("centre_m", block.centre, kPlaceRange);
    Vec3 rotation_deg = Vec3::Zero();
    table.read("rotation_deg", rotation_deg, kDirectionRange);
    block.orientation = orientationOfRotation(rotation_deg);
  }
  table.read("mass_kg", block.mass, kMassRange);
  table.read("velocity_m_s", block.velocity, kVelocityRange);
  table.read("spin_rad_s", block.spin, kSpinRange);
  table.read("restitution", block.restitution, kRestitutionRange);
  table.read("fixed", block.fixed);
  readSurface(table, block.friction);
  return block;
}

// Where a force acts in its block.
void readPoint(const Table& table, const Vec3& dimensions, UserForce& force) {
  const Vec3 half = 0.5 * dimensions;
  Vec3& point = force.point.emplace(Vec3::Zero());
  table.read("point_m", point, {-half.maxCoeff(), half.maxCoeff(), "m"});
  if ((point.cwiseAbs().array() > half.array()).any()) {
    throw InputError(fmt::format("{}: expected a point within the block, up to {}, {} and {} m from its centre, got [{}, {}, {}]",
                                 table.where("point_m"), half.x(), half.y(), half.z(), point.x(), point.y(), point.z()));
  }
}

// Force and torque, and what they change to.
void readLoad(const Table& table, UserForce& force) {
  if (!table.has("force_n") && !table.has("torque_n_m"))
    throw InputError(table.where() + ": expected force_n, torque_n_m or both, got neither");
  table.read("force_n", force.force, kForceRange);
  table.read("torque_n_m", force.torque, kTorqueRange);
  if (table.has("force_end_n")) {
    table.require("force_n");
    table.read("force_end_n", force.forceAtEnd.emplace(Vec3::Zero()), kForceRange);
  }
  if (table.has("torque_end_n_m")) {
    table.require("torque_n_m");
    table.read("torque_end_n_m", force.torqueAtEnd.emplace(Vec3::Zero()), kTorqueRange);
  }
}

// The block that a table names by number, or by its place in the tower.
int namedBlock(const Table& table, const Scene& scene) {
  if (table.has("block") == (table.has("row") || table.has("position"))) {
    throw InputError(table.where() + ": expected either block or row with position, got both or neither");
  }
  int number = 0;
  if (table.has("block")) {
    table.readWhole("block", number, 0, static_cast<std::int64_t>(scene.blocks.size()) - 1);
    return number;
  }
  int row = 0;
  int position = 0;
  table.require("row");
  table.require("position");
  table.readWhole("row", row, 0, kMaxRows - 1);
  table.readWhole("position", position, 1, 3);
  const auto block = std::find_if(scene.blocks.begin(), scene.blocks.end(), [&](const BlockSpec& candidate) {
    return candidate.row == row && candidate.position == position;
  });
  if (block == scene.blocks.end()) {
    throw InputError(fmt::format("{}: expected a block of the tower, got row {}, position {}", table.where(), row, position));
  }
  return static_cast<int>(block - scene.blocks.begin());
}

UserForce readForce(const Table& table, const Scene& scene) {
  UserForce force;
  force.block = namedBlock(table, scene);
  if (table.has("corner") && table.has("point_m")) throw InputError(table.where() + ": expected corner or point_m, got both");
  table.readWhole("corner", force.corner, 0, 7);
  if (table.has("point_m")) readPoint(table, scene.blocks[static_cast<std::size_t>(force.block)].dimensions, force);
  readLoad(table, force);
  table.require("end_s");
  table.read("start_s", force.start_s, kTimeRange);
  table.read("end_s", force.end_s, {force.start_s, kTimeRange.most, kTimeRange.unit});
  return force;
}

// A block that is driven is fixed to all else.
Drive readDrive(const Table& table, Scene& scene) {
  Drive drive;
  drive.block = namedBlock(table, scene);
  table.read("velocity_m_s", drive.velocity, kVelocityRange);
  table.read("spin_rad_s", drive.spin, kSpinRange);
  table.read("amplitude_m", drive.amplitude, kAmplitudeRange);
  table.read("frequency_hz", drive.frequency_hz, kFrequencyRange);
  table.read("start_s", drive.start_s, kTimeRange);
  table.read("end_s", drive.end_s, {drive.start_s, kTimeRange.most, kTimeRange.unit});
  scene.blocks[static_cast<std::size_t>(drive.block)].fixed = true;
  return drive;
}

void readFriction(const Table& table, Scene& scene) {
  if (table.has("coefficient") == (table.has("static") || table.has("kinetic"))) {
    throw InputError(table.where() + ": expected either coefficient or static with kinetic, got both or neither");
  }
  if (table.has("coefficient")) {
    table.read("coefficient", scene.staticFriction, kFrictionRange);
    scene.kineticFriction = scene.staticFriction;
    return;
  }
  table.require("static");
  table.require("kinetic");
  table.read("static", scene.staticFriction, kFrictionRange);
  table.read("kinetic", scene.kineticFriction, {0.0, scene.staticFriction, "(the static one)"});
}

void readGravity(const Table& table, Gravity& gravity) {
  table.read("magnitude_m_s2", gravity.magnitude, kGravityRange);
  table.read("tilt_deg", gravity.tilt_deg, kTiltRange);
  table.read("direction_deg", gravity.direction_deg, kDirectionRange);
  table.read("sway_deg", gravity.sway_deg, kTiltRange);
  table.read("sway_hz", gravity.sway_hz, kFrequencyRange);
}

// Method, inertia and sleep by their names.
template <class T>
void readNamed(const Table& table, std::string_view key, T& target, T (*fromName)(std::string_view, std::string_view)) {
  if (!table.has(key)) return;
  std::string name;
  table.read(key, name);
  target = fromName(name, table.where(key));
}

// The key by which a table gives a setting, if it does: the one that it has now, or its former one.
std::string_view keyIn(const Table& table, const SettingRow& row) {
  const std::string_view former = formerKeyOf(row.key);
  if (former.empty() || !table.has(former)) return row.key;
  if (!table.has(row.key)) return former;
  throw InputError(fmt::format("{}: expected {} or its former name {}, got both", table.where(row.key), row.key, former));
}

void readSettings(const Table& table, Settings& settings) {
  readNamed(table, "method", settings.method, methodFromName);
  readNamed(table, "inertia", settings.inertia, inertiaFromName);
  readNamed(table, "sleep", settings.sleep, sleepFromName);
  for (const SettingRow& row : settingTable()) {
    const std::string_view key = keyIn(table, row);
    if (const auto* number = std::get_if<double Settings::*>(&row.member)) {
      table.read(key, settings.**number, {row.least, row.most, row.unit});
    } else if (const auto* optional = std::get_if<std::optional<double> Settings::*>(&row.member)) {
      table.read(key, settings.**optional, {row.least, row.most, row.unit});
    } else if (const auto* whole = std::get_if<int Settings::*>(&row.member)) {
      table.readWhole(key, settings.**whole, static_cast<std::int64_t>(row.least), static_cast<std::int64_t>(row.most));
    } else {
      table.read(key, settings.*std::get<bool Settings::*>(row.member));
    }
  }
}

std::vector<std::string_view> settingKeys() {
  std::vector<std::string_view> keys = {"method", "inertia", "sleep"};
  for (const SettingRow& row : settingTable()) keys.push_back(row.key);
  return keys;
}

std::vector<std::string_view> formerSettingKeys() {
  std::vector<std::string_view> keys;
  for (const SettingAlias& alias : settingAliases()) keys.push_back(alias.formerKey);
  return keys;
}

// The file's tower; options that are given go before those of the file.
std::vector<BlockSpec> readTower(const Table& table, const TowerOptions& given) {
  TowerOptions options;
  table.read("heights_sigma_m", options.heightsSigma_m, kHeightsSigmaRange);
  table.read("mass_sigma_kg", options.massSigma_kg, kMassSigmaRange);
  table.readWhole("seed", options.seed.emplace(1), 0, kMaxWhole);
  table.read("start_gap_m", options.startGap_m, kStartGapRange);
  table.readTables("offset", {"row", "position", "dx_m", "dy_m"}, [&](const Table& item) {
    BlockOffset& offset = options.offsets.emplace_back();
    for (const std::string_view key : {"row", "position"}) item.require(key);
    item.readWhole("row", offset.row, 0, kMaxRows - 1);
    item.readWhole("position", offset.position, 1, 3);
    item.read("dx_m", offset.dx, kOffsetRange);
    item.read("dy_m", offset.dy, kOffsetRange);
  });
  table.readTables("loose", {"row", "position", "by_m"}, [&](const Table& item) {
    LooseBlock& loose = options.loose.emplace_back();
    for (const std::string_view key : {"row", "position"}) item.require(key);
    item.readWhole("row", loose.row, 0, kMaxRows - 1);
    item.readWhole("position", loose.position, 1, 3);
    item.read("by_m", loose.by, kLooseRange);
  });
  if (given.heightsSigma_m) options.heightsSigma_m = given.heightsSigma_m;
  if (given.massSigma_kg) options.massSigma_kg = given.massSigma_kg;
  if (given.seed) options.seed = given.seed;
  if (given.startGap_m) options.startGap_m = given.startGap_m;
  if (!given.offsets.empty()) options.offsets = given.offsets;
  if (!given.loose.empty()) options.loose = given.loose;

  if (table.has("rows") == table.has("code")) {
    throw InputError(table.where() + ": expected either rows or code, got both or neither");
  }
  int rows = 0;
  std::string code;
  table.readWhole("rows", rows, 1, kMaxRows);
  table.read("code", code);
  try {
    return (table.has("rows") ? towerScene(rows, options) : bitCodeScene(code, options)).blocks;
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", table.where(), error.what()));
  }
}

void refuseTowerOptions(const TowerOptions& given, const std::string& file) {
  const std::string_view name = firstGiven(given);
  if (!name.empty()) throw InputError(fmt::format("{}: expected a [tower] for {}, got a scene without", file, name));
}

Scene readScene(const Table& top, const TowerOptions& given, const std::string& file) {
  Scene scene;
  scene.name = file;
  top.read("name", scene.name);
  top.read("seconds", scene.seconds, kSecondsRange);
  top.read("plane", scene.plane);
  if (!top.has("tower")) refuseTowerOptions(given, file);
  top.readTable("tower", {"rows", "code", "heights_sigma_m", "mass_sigma_kg", "seed", "start_gap_m", "offset", "loose"},
                [&](const Table& table) { scene.blocks = readTower(table, given); });
  top.readTables("block",
                 {"centre_m", "dimensions_m", "mass_kg", "rotation_deg", "velocity_m_s", "spin_rad_s", "restitution", "fixed",
                  "friction", "static_friction", "kinetic_friction", "corners_m"},
                 [&](const Table& table) { scene.blocks.push_back(readBlock(table)); });
  if (scene.blocks.empty()) throw InputError(file + ": expected a [tower], [[block]]s or both, got no blocks");
  top.readTables("force",
                 {"block", "row", "position", "corner", "point_m", "force_n", "force_end_n", "torque_n_m", "torque_end_n_m",
                  "start_s", "end_s"},
                 [&](const Table& table) { scene.forces.push_back(readForce(table, scene)); });
  top.readTables("drive",
                 {"block", "row", "position", "velocity_m_s", "spin_rad_s", "amplitude_m", "frequency_hz", "start_s", "end_s"},
                 [&](const Table& table) { scene.drives.push_back(readDrive(table, scene)); });
  top.readTables("moves", kMoveKeys, [&](const Table& table) { scene.moves.push_back(readMove(table)); });
  top.readTable("floor", {"present", "friction", "static_friction", "kinetic_friction"}, [&](const Table& table) {
    table.read("present", scene.floor);
    readSurface(table, scene.floorFriction);
  });
  top.readTable("friction", {"coefficient", "static", "kinetic"}, [&](const Table& table) { readFriction(table, scene); });
  top.readTable("contact", {"restitution"},
                [&](const Table& table) { table.read("restitution", scene.restitution, kRestitutionRange); });
  top.readTables("friction_pair", {"a", "b", "friction", "static_friction", "kinetic_friction"},
                 [&](const Table& table) { scene.frictionPairs.push_back(readFrictionPair(table, scene.blocks.size())); });
  top.readTable("gravity", {"magnitude_m_s2", "tilt_deg", "direction_deg", "sway_deg", "sway_hz"},
                [&](const Table& table) { readGravity(table, scene.gravity); });
  top.readTable(
      "settings", settingKeys(), [&](const Table& table) { readSettings(table, scene.settings); }, formerSettingKeys());
  return scene;
}

std::string textOf(const std::string& path, const std::string& file) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw InputError(file + ": expected a scene file, got a folder");
  if (!std::filesystem::exists(path, error)) {
    throw InputError(file + ": expected a scene file, tower:R with R rows, or a bit code such as (010)-(111), got no such file");
  }
  return wholeFile(path, file);
}

}  // namespace

Scene sceneFromToml(const std::string& path, const TowerOptions& options) {
  const std::string file = onOneLine(path);
  const std::string text = textOf(path, file);
  refuseLongKeys(text, file);
  toml::table parsed;
  try {
    parsed = toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    const toml::source_position& place = error.source().begin;
    throw InputError(fmt::format("{}:{}:{}: expected TOML, got what cannot be read as such: {}", file, place.line, place.column,
                                 onOneLine(error.description())));
  }
  Scene scene = readScene(Table(parsed, "", file,
                                {"name", "seconds", "plane", "tower", "block", "force", "drive", "moves", "floor", "friction",
                                 "friction_pair", "contact", "gravity", "settings"}),
                          options, file);
  checkScene(scene, file);
  return scene;
}

}  // namespace springtower
