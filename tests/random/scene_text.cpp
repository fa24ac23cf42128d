#include "tests/random/scene_text.h"

#include "core/limits.h"
#include "core/scene/rotation.h"

#include <fmt/format.h>

namespace springtower {
namespace {

// A number with a point or an exponent, as TOML has floating-point numbers.
std::string number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string vector(const Vec3& value) {
  return fmt::format("[{}, {}, {}]", number(value.x()), number(value.y()), number(value.z()));
}

std::string frictionText(const Friction& friction) {
  return fmt::format("static_friction = {}\nkinetic_friction = {}\n", number(friction.staticFriction),
                     number(friction.kineticFriction));
}

std::string towerText(const RandomScene& random) {
  std::string text = fmt::format("[tower]\ncode = \"{}\"\n", random.towerCode);
  const TowerOptions& tower = random.tower;
  if (tower.heightsSigma_m) text += fmt::format("heights_sigma_m = {}\n", number(*tower.heightsSigma_m));
  if (tower.massSigma_kg) text += fmt::format("mass_sigma_kg = {}\n", number(*tower.massSigma_kg));
  if (tower.seed) text += fmt::format("seed = {}\n", *tower.seed);
  return text;
}

std::string blockText(const BlockSpec& block) {
  std::string text = fmt::format("[[block]]\ncentre_m = {}\ndimensions_m = {}\nmass_kg = {}\n", vector(block.centre),
                                 vector(block.dimensions), number(block.mass));
  const Vec3 rotation_deg = rotationOfOrientation(block.orientation);
  if (!rotation_deg.isZero(0.0)) text += fmt::format("rotation_deg = {}\n", vector(rotation_deg));
  if (!block.velocity.isZero(0.0)) text += fmt::format("velocity_m_s = {}\n", vector(block.velocity));
  if (!block.spin.isZero(0.0)) text += fmt::format("spin_rad_s = {}\n", vector(block.spin));
  if (block.restitution) text += fmt::format("restitution = {}\n", number(*block.restitution));
  if (block.friction) text += frictionText(*block.friction);
  if (block.fixed) text += "fixed = true\n";
  return text;
}

std::string forceText(const UserForce& force) {
  std::string text = fmt::format("[[force]]\nblock = {}\nforce_n = {}\nstart_s = {}\nend_s = {}\n", force.block,
                                 vector(force.force), number(force.start_s), number(force.end_s));
  if (!force.torque.isZero(0.0) || force.torqueAtEnd) text += fmt::format("torque_n_m = {}\n", vector(force.torque));
  if (force.point) text += fmt::format("point_m = {}\n", vector(*force.point));
  if (force.forceAtEnd) text += fmt::format("force_end_n = {}\n", vector(*force.forceAtEnd));
  if (force.torqueAtEnd) text += fmt::format("torque_end_n_m = {}\n", vector(*force.torqueAtEnd));
  if (force.corner >= 0) text += fmt::format("corner = {}\n", force.corner);
  return text;
}

std::string driveText(const Drive& drive) {
  std::string text =
      fmt::format("[[drive]]\nblock = {}\nstart_s = {}\nend_s = {}\n", drive.block, number(drive.start_s), number(drive.end_s));
  if (!drive.velocity.isZero(0.0)) text += fmt::format("velocity_m_s = {}\n", vector(drive.velocity));
  if (!drive.spin.isZero(0.0)) text += fmt::format("spin_rad_s = {}\n", vector(drive.spin));
  if (drive.frequency_hz != 0.0) {
    text += fmt::format("amplitude_m = {}\nfrequency_hz = {}\n", vector(drive.amplitude), number(drive.frequency_hz));
  }
  return text;
}

std::string moveText(const Move& move) {
  if (move.kind == MoveKind::putAside) return fmt::format("[[moves]]\ndo = \"put-aside\"\nforce_n = {}\n", number(move.limit_n));
  const std::string place = fmt::format("row = {}\nposition = {}\nforce_n = {}\n", move.row, move.position, number(move.limit_n));
  if (move.kind == MoveKind::put) return fmt::format("[[moves]]\ndo = \"put\"\n{}drop_m = {}\n", place, number(move.drop_m));
  const bool alongX = move.towards.x() != 0.0;
  const bool positive = (alongX ? move.towards.x() : move.towards.y()) > 0.0;
  return fmt::format("[[moves]]\ndo = \"take\"\n{}towards = \"{}{}\"\nspeed_m_s = {}\n", place, positive ? '+' : '-',
                     alongX ? 'x' : 'y', number(move.speed_m_s));
}

std::string settingsText(const Settings& settings) {
  const Settings usual;
  std::string text = fmt::format("[settings]\nmethod = \"{}\"\n", nameOf(settings.method));
  if (settings.inertia != usual.inertia) text += fmt::format("inertia = \"{}\"\n", nameOf(settings.inertia));
  if (settings.sleep != usual.sleep) text += fmt::format("sleep = \"{}\"\n", nameOf(settings.sleep));
  for (const SettingRow& row : settingTable()) {
    const std::optional<double> value = numberOf(settings, row);
    if (!value || value == numberOf(usual, row)) continue;
    const bool flag = std::holds_alternative<bool Settings::*>(row.member);
    const bool whole = std::holds_alternative<int Settings::*>(row.member);
    text += fmt::format("{} = {}\n", row.key,
                        flag    ? (*value != 0.0 ? "true" : "false")
                        : whole ? fmt::format("{}", static_cast<int>(*value))
                                : number(*value));
  }
  return text;
}

}  // namespace

std::string sceneText(const RandomScene& random, std::string_view comment) {
  const Scene& scene = random.scene;
  std::string text = fmt::format("# {}\nname = \"{}\"\nseconds = {}\n", onOneLine(comment), scene.name, number(scene.seconds));
  if (scene.plane) text += "plane = true\n";
  if (!random.towerCode.empty()) text += towerText(random);
  for (const BlockSpec& block : scene.blocks) {
    if (block.row < 0) text += blockText(block);
  }
  for (const UserForce& force : scene.forces) text += forceText(force);
  for (const Drive& drive : scene.drives) text += driveText(drive);
  for (const Move& move : scene.moves) text += moveText(move);
  for (const FrictionPair& pair : scene.frictionPairs) {
    text += fmt::format("[[friction_pair]]\na = {}\nb = {}\n{}", pair.a, pair.b, frictionText(pair.friction));
  }
  text += fmt::format("[floor]\npresent = {}\n", scene.floor);
  if (scene.floorFriction) text += frictionText(*scene.floorFriction);
  text += fmt::format("[contact]\nrestitution = {}\n", number(scene.restitution));
  text += fmt::format("[friction]\nstatic = {}\nkinetic = {}\n", number(scene.staticFriction), number(scene.kineticFriction));
  const Gravity& gravity = scene.gravity;
  text += fmt::format("[gravity]\nmagnitude_m_s2 = {}\n", number(gravity.magnitude));
  if (gravity.tilt_deg != 0.0 || gravity.sway_deg != 0.0) {
    text += fmt::format("tilt_deg = {}\ndirection_deg = {}\n", number(gravity.tilt_deg), number(gravity.direction_deg));
  }
  if (gravity.sway_deg != 0.0) {
    text += fmt::format("sway_deg = {}\nsway_hz = {}\n", number(gravity.sway_deg), number(gravity.sway_hz));
  }
  return text + settingsText(scene.settings);
}

}  // namespace springtower
