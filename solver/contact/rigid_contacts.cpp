#include "solver/contact/rigid_contacts.h"

#include <algorithm>

namespace springtower {

namespace {

// Two unit vectors across a normal, from the world axis that is farthest from it.
void chooseTangents(std::array<Vec3, 3>& direction) {
  Eigen::Index axis = 0;
  direction[0].cwiseAbs().minCoeff(&axis);
  direction[1] = direction[0].cross(Vec3::Unit(axis)).normalized();
  direction[2] = direction[0].cross(direction[1]);
}

std::int32_t bodyOf(const IslandStep& step, std::int32_t block) {
  if (block < 0 || step.simulation.asleep[static_cast<std::size_t>(block)] != 0) return -1;
  return step.engine.nodeOf[static_cast<std::size_t>(block)];
}

// The points of a manifold as they lie at engine.frames.
PointForces pointsNow(const IslandStep& step, const Manifold& manifold) {
  static const AffineField still{};
  const auto side = [&](std::int32_t block) {
    return block < 0 ? ContactSide{} : ContactSide{&step.engine.frames[static_cast<std::size_t>(block)], &still, &still};
  };
  return pointForces(manifold, side(manifold.upper), side(manifold.lower), step.law);
}

void recall(const IslandStep& step, const Manifold& manifold, std::size_t i, RigidContact& contact) {
  const Scene& scene = step.simulation.scene;
  const bool slid = manifold.sliding[i] != 0.0;
  contact.coefficient = slid ? scene.kineticFriction : scene.staticFriction;
  const Vec3 across(manifold.stretchX[i], manifold.stretchY[i], manifold.stretchZ[i]);
  contact.impulse = {step.drift_s * manifold.relaxed[i], 0.0, 0.0};
  contact.stretch = {across.dot(contact.direction[1]), across.dot(contact.direction[2])};
  if (scene.settings.method == Method::xpbd) return;
  contact.impulse[1] = step.drift_s * contact.stretch[0];
  contact.impulse[2] = step.drift_s * contact.stretch[1];
}

}  // namespace

void gatherContacts(IslandStep& step, RigidIsland& island) {
  island.contacts.clear();
  for (const std::int32_t at : step.pairs) {
    const Manifold& manifold = step.engine.pairs[static_cast<std::size_t>(at)].manifold;
    if (manifold.touch == PairPhase::separated) continue;
    const PointForces points = pointsNow(step, manifold);
    RigidContact contact;
    contact.upper = bodyOf(step, manifold.upper);
    contact.lower = bodyOf(step, manifold.lower);
    contact.pair = at;
    contact.direction[0] = points.direction;
    chooseTangents(contact.direction);
    contact.share = 1.0 / std::max(1, manifold.count);
    for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
      contact.point = static_cast<std::int32_t>(i);
      contact.gap = -points.depth[i];
      const Vec3 middle = 0.5 * (points.place[i] + points.lowerPlace[i]);
      if (contact.upper >= 0) contact.armUpper = middle - island.bodies[static_cast<std::size_t>(contact.upper)].place;
      if (contact.lower >= 0) contact.armLower = middle - island.bodies[static_cast<std::size_t>(contact.lower)].place;
      for (std::size_t k = 0; k < 3; ++k) contact.mass[k] = 1.0 / inverseEffectiveMass(island, contact, contact.direction[k]);
      recall(step, manifold, i, contact);
      island.contacts.push_back(contact);
    }
  }
}

void keepForces(IslandStep& step, const RigidIsland& island) {
  const bool anchored = step.simulation.scene.settings.method == Method::xpbd;
  for (const RigidContact& contact : island.contacts) {
    Manifold& manifold = step.engine.pairs[static_cast<std::size_t>(contact.pair)].manifold;
    const auto i = static_cast<std::size_t>(contact.point);
    const std::array<double, 3> force = {contact.impulse[0] / step.drift_s, contact.impulse[1] / step.drift_s,
                                         contact.impulse[2] / step.drift_s};
    const Vec3 across = anchored ? Vec3(contact.stretch[0] * contact.direction[1] + contact.stretch[1] * contact.direction[2])
                                 : Vec3(force[1] * contact.direction[1] + force[2] * contact.direction[2]);
    manifold.relaxed[i] = force[0];
    manifold.stretchX[i] = across.x();
    manifold.stretchY[i] = across.y();
    manifold.stretchZ[i] = across.z();
    manifold.sliding[i] = contact.sliding ? 1.0 : 0.0;
    if (!anchored) continue;
    manifold.offset[i] = force[1];
    manifold.scale[i] = force[2];
  }
}

void readForces(const Manifold& manifold, Method method, PointForces& points) {
  std::array<Vec3, 3> direction = {points.direction};
  chooseTangents(direction);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    points.normal[i] = manifold.relaxed[i];
    points.friction[i] = {manifold.stretchX[i], manifold.stretchY[i], manifold.stretchZ[i]};
    if (method != Method::xpbd) continue;
    const bool pushed = manifold.relaxed[i] > 0.0;
    const Vec3 friction = manifold.offset[i] * direction[1] + manifold.scale[i] * direction[2];
    for (std::size_t k = 0; k < 3; ++k) points.friction[i][k] = pushed ? friction[static_cast<Eigen::Index>(k)] : 0.0;
  }
}

double inverseEffectiveMass(const RigidIsland& island, const RigidContact& contact, const Vec3& direction) {
  double inverse = 0.0;
  const auto add = [&](std::int32_t at, const Vec3& arm) {
    if (at < 0) return;
    const RigidBody& body = island.bodies[static_cast<std::size_t>(at)];
    const Vec3 turning = arm.cross(direction);
    inverse += body.inverseMass + turning.dot(body.inverseInertia * turning);
  };
  add(contact.upper, contact.armUpper);
  add(contact.lower, contact.armLower);
  return inverse;
}

}  // namespace springtower
