#include "api/convert.h"

#include "core/limits.h"

#include <array>
#include <fmt/format.h>
#include <memory>

namespace springtower::api {
namespace {

template <class Engine, class Public>
struct Match {
  Engine engine;
  Public shown;
};

using Methods = Match<springtower::Method, Method>;
constexpr std::array<Methods, 11> kMethods = {{{springtower::Method::implicit, Method::implicit},
                                               {springtower::Method::implicitEuler, Method::implicitEuler},
                                               {springtower::Method::implicitEigen, Method::implicitEigen},
                                               {springtower::Method::semiImplicitEuler, Method::semiImplicitEuler},
                                               {springtower::Method::midpoint, Method::midpoint},
                                               {springtower::Method::rungeKutta4, Method::rungeKutta4},
                                               {springtower::Method::report, Method::report},
                                               {springtower::Method::rigidPgs, Method::rigidPgs},
                                               {springtower::Method::rigidLcp, Method::rigidLcp},
                                               {springtower::Method::xpbd, Method::xpbd},
                                               {springtower::Method::automatic, Method::automatic}}};
using Sleeps = Match<springtower::Sleep, Sleep>;
constexpr std::array<Sleeps, 3> kSleeps = {
    {{springtower::Sleep::off, Sleep::off}, {springtower::Sleep::on, Sleep::on}, {springtower::Sleep::report, Sleep::report}}};
using Inertias = Match<springtower::Inertia, Inertia>;
constexpr std::array<Inertias, 2> kInertias = {
    {{springtower::Inertia::cuboid, Inertia::cuboid}, {springtower::Inertia::lumped, Inertia::lumped}}};

template <class Table, class Public>
auto engineValue(const Table& table, Public value, const char* what) {
  for (const auto& match : table) {
    if (match.shown == value) return match.engine;
  }
  throw InputError(fmt::format("{}: expected a number from 0 to {}, got {}", what, static_cast<int>(table.size()) - 1,
                               static_cast<int>(value)));
}

template <class Table, class Engine>
auto publicValue(const Table& table, Engine value) {
  for (const auto& match : table) {
    if (match.engine == value) return match.shown;
  }
  return table.front().shown;  // tests compare the tables with the enumerations
}

// The numbers of both kinds of settings have the same names.
template <class From, class To>
void copyNumbers(const From& from, To& to) {
  to.frame_s = from.frame_s;
  to.tolerance_m = from.tolerance_m;
  to.substeps = from.substeps;
  to.allowUnstable = from.allowUnstable;
  to.stabilitySafety = from.stabilitySafety;
  to.springRatio = from.springRatio;
  to.tangentialRatio = from.tangentialRatio;
  to.maxwellRatio = from.maxwellRatio;
  to.maxwellTime = from.maxwellTime;
  to.stiffnessDamping = from.stiffnessDamping;
  to.impactDepth = from.impactDepth;
  to.continuousTests = from.continuousTests;
  to.sleepSpeed = from.sleepSpeed;
  to.sleepTime = from.sleepTime;
  to.sleepImbalance = from.sleepImbalance;
  to.reportRestitution = from.reportRestitution;
  to.reportFrictionDrag = from.reportFrictionDrag;
  to.reportDisableDistance_m = from.reportDisableDistance_m;
  to.reportIterations = from.reportIterations;
  to.iterations = from.iterations;
}

}  // namespace

springtower::Method toEngine(Method method) {
  return engineValue(kMethods, method, "method");
}
Method toPublic(springtower::Method method) {
  return publicValue(kMethods, method);
}
springtower::Sleep toEngine(Sleep sleep) {
  return engineValue(kSleeps, sleep, "sleep");
}

springtower::Settings toEngine(const Settings& settings) {
  springtower::Settings result;
  result.method = toEngine(settings.method);
  result.inertia = engineValue(kInertias, settings.inertia, "inertia");
  result.sleep = toEngine(settings.sleep);
  copyNumbers(settings, result);
  return result;
}

Settings toPublic(const springtower::Settings& settings) {
  Settings result;
  result.method = toPublic(settings.method);
  result.inertia = publicValue(kInertias, settings.inertia);
  result.sleep = publicValue(kSleeps, settings.sleep);
  copyNumbers(settings, result);
  return result;
}

springtower::Gravity toEngine(const Gravity& gravity) {
  return {gravity.magnitude_m_s2, gravity.tilt_deg, gravity.direction_deg, gravity.sway_deg, gravity.sway_hz};
}

Gravity toPublic(const springtower::Gravity& gravity) {
  return {gravity.magnitude, gravity.tilt_deg, gravity.direction_deg, gravity.sway_deg, gravity.sway_hz};
}

namespace {

std::optional<springtower::Friction> frictionToEngine(const std::optional<Friction>& friction) {
  if (!friction) return {};
  return springtower::Friction{friction->staticFriction, friction->kineticFriction};
}

std::optional<Friction> frictionToPublic(const std::optional<springtower::Friction>& friction) {
  if (!friction) return {};
  return Friction{friction->staticFriction, friction->kineticFriction};
}

}  // namespace

springtower::BlockSpec toEngine(const Block& block) {
  springtower::BlockSpec result{toEngine(block.centre),
                                toEngine(block.dimensions),
                                toEngine(block.orientation),
                                toEngine(block.velocity),
                                toEngine(block.spin),
                                block.mass_kg,
                                block.row,
                                block.position,
                                block.restitution,
                                block.fixed,
                                frictionToEngine(block.friction),
                                {}};
  if (!block.strain_m) return result;
  CornerPlaces strain;
  for (std::size_t c = 0; c < strain.size(); ++c) strain[c] = toEngine((*block.strain_m)[c]);
  result.strain = std::make_shared<const CornerPlaces>(strain);
  return result;
}

Block toPublic(const springtower::BlockSpec& block) {
  Block result{toPublic(block.centre),
               toPublic(block.dimensions),
               toPublic(block.orientation),
               toPublic(block.velocity),
               toPublic(block.spin),
               block.mass,
               block.row,
               block.position,
               block.restitution,
               block.fixed,
               frictionToPublic(block.friction),
               {}};
  if (!block.strain) return result;
  result.strain_m.emplace();
  for (std::size_t c = 0; c < block.strain->size(); ++c) (*result.strain_m)[c] = toPublic((*block.strain)[c]);
  return result;
}

springtower::UserForce toEngine(const Force& force) {
  springtower::UserForce result;
  result.block = force.block;
  result.corner = force.corner;
  result.force = toEngine(force.force_n);
  result.start_s = force.start_s;
  result.end_s = force.end_s;
  result.torque = toEngine(force.torque_n_m);
  if (force.point_m) result.point = toEngine(*force.point_m);
  if (force.forceAtEnd_n) result.forceAtEnd = toEngine(*force.forceAtEnd_n);
  if (force.torqueAtEnd_n_m) result.torqueAtEnd = toEngine(*force.torqueAtEnd_n_m);
  return result;
}

Force toPublic(const springtower::UserForce& force) {
  Force result;
  result.block = force.block;
  result.corner = force.corner;
  result.force_n = toPublic(force.force);
  result.start_s = force.start_s;
  result.end_s = force.end_s;
  result.torque_n_m = toPublic(force.torque);
  if (force.point) result.point_m = toPublic(*force.point);
  if (force.forceAtEnd) result.forceAtEnd_n = toPublic(*force.forceAtEnd);
  if (force.torqueAtEnd) result.torqueAtEnd_n_m = toPublic(*force.torqueAtEnd);
  return result;
}

springtower::TowerOptions toEngine(const TowerOptions& options) {
  springtower::TowerOptions result;
  result.heightsSigma_m = options.heightsSigma_m;
  result.massSigma_kg = options.massSigma_kg;
  result.seed = options.seed;
  result.startGap_m = options.startGap_m;
  for (const BlockOffset& offset : options.offsets)
    result.offsets.push_back({offset.row, offset.position, offset.dx_m, offset.dy_m});
  for (const LooseBlock& block : options.loose) result.loose.push_back({block.row, block.position, block.by_m});
  return result;
}

springtower::Scene toEngine(const Scene& scene) {
  springtower::Scene result;
  result.name = scene.name;
  result.blocks.reserve(scene.blocks.size());
  for (const Block& block : scene.blocks) result.blocks.push_back(toEngine(block));
  for (const Force& force : scene.forces) result.forces.push_back(toEngine(force));
  for (const Drive& drive : scene.drives) {
    result.drives.push_back({drive.block, toEngine(drive.velocity_m_s), toEngine(drive.spin_rad_s), toEngine(drive.amplitude_m),
                             drive.frequency_hz, drive.start_s, drive.end_s});
    const auto block = static_cast<std::size_t>(drive.block);
    if (block < result.blocks.size()) result.blocks[block].fixed = true;  // others are refused when the scene is checked
  }
  result.gravity = toEngine(scene.gravity);
  result.floor = scene.floor;
  result.plane = scene.plane;
  result.staticFriction = scene.staticFriction;
  result.kineticFriction = scene.kineticFriction;
  result.restitution = scene.restitution;
  result.floorFriction = frictionToEngine(scene.floorFriction);
  for (const FrictionPair& pair : scene.frictionPairs)
    result.frictionPairs.push_back({pair.a, pair.b, {pair.friction.staticFriction, pair.friction.kineticFriction}});
  result.seconds = scene.seconds;
  result.settings = toEngine(scene.settings);
  return result;
}

Scene toPublic(const springtower::Scene& scene) {
  Scene result;
  result.name = scene.name;
  result.blocks.reserve(scene.blocks.size());
  for (const springtower::BlockSpec& block : scene.blocks) result.blocks.push_back(toPublic(block));
  for (const springtower::UserForce& force : scene.forces) result.forces.push_back(toPublic(force));
  for (const springtower::Drive& drive : scene.drives) {
    result.drives.push_back({drive.block, toPublic(drive.velocity), toPublic(drive.spin), toPublic(drive.amplitude),
                             drive.frequency_hz, drive.start_s, drive.end_s});
  }
  result.gravity = toPublic(scene.gravity);
  result.floor = scene.floor;
  result.plane = scene.plane;
  result.staticFriction = scene.staticFriction;
  result.kineticFriction = scene.kineticFriction;
  result.restitution = scene.restitution;
  result.floorFriction = frictionToPublic(scene.floorFriction);
  for (const springtower::FrictionPair& pair : scene.frictionPairs)
    result.frictionPairs.push_back({pair.a, pair.b, {pair.friction.staticFriction, pair.friction.kineticFriction}});
  result.seconds = scene.seconds;
  result.settings = toPublic(scene.settings);
  return result;
}

std::string sourceOf(const Scene& scene) {
  return scene.name.empty() ? "scene" : onOneLine(scene.name);
}

}  // namespace springtower::api
