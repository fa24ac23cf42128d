#include "solver/frame/inputs.h"

#include "api/convert.h"
#include "api/world_impl.h"
#include "core/limits.h"
#include "core/scene/input_check.h"

#include <cmath>
#include <fmt/format.h>
#include <springtower/inputs.h>

namespace springtower::api {
namespace {

constexpr Range kComponentRange{-1e300, 1e300, ""};  // of a direction, whose length means nothing

void requireVector(const Vec3& value, const Range& range, const char* what) {
  requireInRange(value.x, range, fmt::format("{}: x", what));
  requireInRange(value.y, range, fmt::format("{}: y", what));
  requireInRange(value.z, range, fmt::format("{}: z", what));
}

// What leads out of the plane of a scene that has one.
void requireInPlane(const springtower::Simulation& simulation, double y, const char* what) {
  if (!simulation.scene.plane) return;
  springtower::UserForce force;
  force.force.y() = y;
  checkForceInPlane(force, what);
}

Hand& heldHand(WorldImpl& impl, const char* what) {
  Hand& hand = impl.lead.draw.hand;
  if (hand.block == springtower::kFloor)
    throw InputError(fmt::format("{}: expected a hand that has grabbed a block, got one that holds nothing", what));
  return hand;
}

// A direction of length 1.
springtower::Vec3 unitOf(const Vec3& direction, const char* what) {
  requireVector(direction, kComponentRange, what);
  const springtower::Vec3 vector = toEngine(direction);
  const double length = vector.stableNorm();
  if (!(length > 0.0)) throw InputError(fmt::format("{}: expected a length above 0, got {}", what, length));
  return vector / length;
}

}  // namespace

void applyForce(World& world, const Force& force) {
  springtower::Simulation& simulation = WorldAccess::running(world).simulation;
  withPublicErrors([&] { springtower::applyForce(simulation, toEngine(force)); });
}

void pushThroughFrame(World& world, int block, const Vec3& force_n) {
  WorldImpl& impl = WorldAccess::running(world);
  const std::size_t count = impl.simulation.model.blockCount();
  withPublicErrors([&] {
    const springtower::UserForce force =
        forceForOneFrame(impl.simulation, checkedBlock(block, count, "force: block"), toEngine(force_n));
    checkForce(force, impl.simulation.model.dimensions, "force");
    requireMovable(impl.simulation.scene, static_cast<std::size_t>(force.block), "force: block");
    if (impl.simulation.scene.plane) checkForceInPlane(force, "force");
    impl.passing.push_back(force);
  });
}

void clearForces(World& world) {
  WorldImpl& impl = WorldAccess::running(world);
  springtower::clearForces(impl.simulation);
  impl.passing.clear();
}

void setGravity(World& world, const Gravity& gravity) {
  springtower::Simulation& simulation = WorldAccess::running(world).simulation;
  withPublicErrors([&] { springtower::setGravity(simulation, toEngine(gravity)); });
}

Gravity gravity(const World& world) {
  return toPublic(WorldAccess::impl(world).simulation.scene.gravity);
}

void setFriction(World& world, double staticFriction, double kineticFriction) {
  springtower::Simulation& simulation = WorldAccess::running(world).simulation;
  withPublicErrors([&] { springtower::setFriction(simulation, staticFriction, kineticFriction); });
}

void setSleep(World& world, Sleep sleep) {
  springtower::setSleep(WorldAccess::running(world).simulation, toEngine(sleep));
}

void kick(World& world, int block, const Vec3& velocity_m_s) {
  springtower::Simulation& simulation = WorldAccess::running(world).simulation;
  const std::size_t b = checkedBlock(block, simulation.model.blockCount(), "kick: block");
  withPublicErrors([&] {
    requireMovable(simulation.scene, b, "kick: block");
    requireVector(velocity_m_s, kVelocityRange, "kick: velocity");
    requireInPlane(simulation, velocity_m_s.y, "kick");
  });
  springtower::kick(simulation, b, toEngine(velocity_m_s));
}

void grab(World& world, int block, double limit_n) {
  WorldImpl& impl = WorldAccess::running(world);
  const std::size_t b = checkedBlock(block, impl.simulation.model.blockCount(), "grab: block");
  withPublicErrors([&] {
    requireMovable(impl.simulation.scene, b, "grab: block");
    requireInRange(limit_n, kHandForceRange, "grab: limit");
  });
  impl.lead = {};
  impl.lead.draw.hand = handOn(impl.simulation, blockId(b), limit_n);
  impl.lead.target = impl.lead.draw.hand.place;
}

void moveHand(World& world, const Vec3& place, double speed_m_s) {
  WorldImpl& impl = WorldAccess::running(world);
  Hand& hand = heldHand(impl, "moveHand");
  withPublicErrors([&] {
    requireVector(place, kPlaceRange, "moveHand: place");
    requireInPlane(impl.simulation, place.y, "moveHand");
    requireInRange(speed_m_s, kMoveSpeedRange, "moveHand: speed");
  });
  hand.line.setZero();
  impl.lead.pulls = false;
  impl.lead.target = toEngine(place);
  impl.lead.speed_m_s = speed_m_s;
}

void turnHand(World& world, const Quaternion& orientation) {
  constexpr Range kUnit{1.0 - 1e-9, 1.0 + 1e-9, ""};
  WorldImpl& impl = WorldAccess::running(world);
  Hand& hand = heldHand(impl, "turnHand");
  const Eigen::Quaterniond turn = toEngine(orientation);
  withPublicErrors([&] {
    requireInRange(turn.norm(), kUnit, "turnHand: length of the quaternion");
    if (impl.simulation.scene.plane) checkTurnInPlane(turn, "turnHand");
  });
  hand.turn = turn;
}

void pull(World& world, int block, const Vec3& direction, double speed_m_s, double limit_n) {
  WorldImpl& impl = WorldAccess::running(world);
  const std::size_t b = checkedBlock(block, impl.simulation.model.blockCount(), "pull: block");
  const springtower::Vec3 along = withPublicErrors([&] {
    requireMovable(impl.simulation.scene, b, "pull: block");
    requireInPlane(impl.simulation, direction.y, "pull");
    requireInRange(speed_m_s, kMoveSpeedRange, "pull: speed");
    requireInRange(limit_n, kHandForceRange, "pull: limit");
    return unitOf(direction, "pull: direction");
  });
  impl.lead = {};
  impl.lead.draw = drawingFrom(impl.simulation, blockId(b), along, speed_m_s, limit_n);
  impl.lead.pulls = true;
}

void release(World& world) {
  WorldImpl& impl = WorldAccess::running(world);
  impl.lead = {};
  letGo(impl.simulation);
}

HandState handState(const World& world) {
  const WorldImpl& impl = WorldAccess::running(world);
  const Hand& hand = impl.lead.draw.hand;
  if (hand.block == springtower::kFloor) return {};
  HandState state;
  state.block = static_cast<int>(hand.block);
  state.place = toPublic(hand.place);
  // The springs of a hand that has let go of another block, or has yet to take this one, are none of it.
  if (impl.simulation.tether.block != hand.block) return state;
  const GripForce force = gripForce(impl.simulation);
  state.force_n = toPublic(force.force);
  state.torque_n_m = toPublic(force.torque);
  state.limited = force.limited;
  return state;
}

void leadHand(WorldImpl& impl) {
  springtower::Simulation& simulation = impl.simulation;
  HandLead& lead = impl.lead;
  Hand& hand = lead.draw.hand;
  if (hand.block == springtower::kFloor) {
    letGo(simulation);
    return;
  }
  const std::vector<ContactForce> contacts = contactForcesOn(simulation, hand.block);
  if (lead.pulls) {
    advancePull(lead.draw, contacts, simulation);
    return;
  }
  const double frame_s = simulation.scene.settings.frame_s;
  const springtower::Vec3 way = lead.target - hand.place;
  const double step_m = lead.speed_m_s * frame_s;
  const springtower::Vec3 next = way.norm() > step_m ? springtower::Vec3(hand.place + way * (step_m / way.norm())) : lead.target;
  hand.velocity = (next - hand.place) / frame_s;
  hand.place = next;
  hold(hand, contacts, lead.draw.grip, simulation);
}

}  // namespace springtower::api
