#include "solver/contact/rigid_contacts.h"

#include "solver/contact/slip.h"
#include "solver/world/driven_blocks.h"

#include <algorithm>
#include <span>

namespace springtower {

namespace {

// Two unit tangents, from the world axis that is farthest from the normal.
void chooseTangents(std::array<Vec3, 3>& direction) {
  Eigen::Index axis = 0;
  direction[0].cwiseAbs().minCoeff(&axis);
  direction[1] = direction[0].cross(Vec3::Unit(axis)).normalized();
  direction[2] = direction[0].cross(direction[1]);
}

std::int32_t bodyOf(const IslandStep& step, std::int32_t block) {
  if (sleeps(step.simulation, block) && !isDriven(step, block)) return -1;
  return step.engine.scratch.nodeOf[static_cast<std::size_t>(block)];
}

// Warm start with the state of the point in the step before.
void warmStart(const IslandStep& step, const ContactView& manifold, std::size_t i, RigidContact& contact) {
  if (manifold.kind == PointKind::anchor) {
    const AnchorRow& row = manifold.anchor(i);
    const Vec3 anchor = vectorAt(row.displacement, i);
    contact.impulse = {step.drift_s * row.normalForce[laneOf(i)], 0.0, 0.0};
    contact.anchor_m = {anchor.dot(contact.direction[1]), anchor.dot(contact.direction[2])};
    return;
  }
  const ImpulseRow& row = manifold.impulse(i);
  const Vec3 friction = vectorAt(row.friction, i);
  contact.impulse = {step.drift_s * row.normalForce[laneOf(i)], step.drift_s * friction.dot(contact.direction[1]),
                     step.drift_s * friction.dot(contact.direction[2])};
}

// Friction is kinetic where all points of a manifold slip, otherwise static.
void chooseFriction(const IslandStep& step, const RigidIsland& island, const ContactView& manifold,
                    std::span<RigidContact> points) {
  const Friction friction = step.simulation.friction.of(manifold.upper, manifold.lower);
  double coefficient = friction.staticFriction;
  if (friction.kineticFriction != friction.staticFriction) {
    SlipOfPoints slip;
    for (const RigidContact& contact : points) {
      Vec3 relative = relativeVelocity(island, contact);
      relative -= relative.dot(contact.direction[0]) * contact.direction[0];
      // Where impulses are exact the speeds alone decide: bounds that follow from other normal forces are no measure of slip.
      const bool slips = manifold.kind == PointKind::impulse || slipsAt(manifold, static_cast<std::size_t>(contact.point));
      slip.add(contact.impulse[0] > 0.0, slips, relative.norm());
    }
    const double noise_m_s = manifold.kind == PointKind::anchor ? slipNoise_m_s(step) : 0.0;
    if (slip.isGross(step.simulation, noise_m_s)) coefficient = friction.kineticFriction;
  }
  for (RigidContact& contact : points) contact.coefficient = coefficient;
}

}  // namespace

PointForces pointsNow(const IslandStep& step, const ContactView& manifold) {
  static const AffineField still{};
  const auto side = [&](std::int32_t block) {
    return block < 0 ? ContactSide{} : ContactSide{&step.engine.memo.frames[static_cast<std::size_t>(block)], &still, &still};
  };
  return pointForces(manifold, side(manifold.upper), side(manifold.lower), step.law);
}

void gatherContacts(IslandStep& step, RigidIsland& island) {
  island.contacts.clear();
  for (const std::int32_t at : step.pairs) {
    const ContactView manifold = contactOf(step.engine, static_cast<std::size_t>(at));
    if (manifold.phase == PairPhase::separated) continue;
    const PointForces points = pointsNow(step, manifold);
    RigidContact contact;
    contact.upper = bodyOf(step, manifold.upper);
    contact.lower = bodyOf(step, manifold.lower);
    contact.pair = at;
    contact.direction[0] = points.direction;
    chooseTangents(contact.direction);
    contact.share = 1.0 / std::max(1, manifold.count);
    const std::size_t first = island.contacts.size();
    for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
      contact.point = static_cast<std::int32_t>(i);
      contact.gap = -points.depth[i];
      const Vec3 middle = 0.5 * (points.place[i] + points.lowerPlace[i]);
      if (contact.upper >= 0) contact.armUpper = middle - island.bodies[static_cast<std::size_t>(contact.upper)].place;
      if (contact.lower >= 0) contact.armLower = middle - island.bodies[static_cast<std::size_t>(contact.lower)].place;
      for (std::size_t k = 0; k < 3; ++k) contact.mass[k] = 1.0 / inverseEffectiveMass(island, contact, contact.direction[k]);
      warmStart(step, manifold, i, contact);
      island.contacts.push_back(contact);
    }
    chooseFriction(step, island, manifold, std::span(island.contacts).subspan(first));
  }
}

void storeForces(IslandStep& step, const RigidIsland& island) {
  for (const RigidContact& contact : island.contacts) {
    const auto i = static_cast<std::size_t>(contact.point);
    const std::size_t lane = laneOf(i);
    const std::int32_t stored = step.engine.pairs.contact[static_cast<std::size_t>(contact.pair)];
    PointRow& row = *step.engine.contacts.points(stored)[rowOf(i)];
    const std::array<double, 3> force = {contact.impulse[0] / step.drift_s, contact.impulse[1] / step.drift_s,
                                         contact.impulse[2] / step.drift_s};
    const double slipping = contact.sliding ? 1.0 : 0.0;
    if (step.pointKind == PointKind::anchor) {
      setVectorAt(row.anchor.displacement, i,
                  contact.anchor_m[0] * contact.direction[1] + contact.anchor_m[1] * contact.direction[2]);
      row.anchor.normalForce[lane] = force[0];
      row.anchor.firstFriction[lane] = force[1];
      row.anchor.secondFriction[lane] = force[2];
      row.anchor.slipping[lane] = slipping;
    } else {
      setVectorAt(row.impulse.friction, i, force[1] * contact.direction[1] + force[2] * contact.direction[2]);
      row.impulse.normalForce[lane] = force[0];
      row.impulse.slipping[lane] = slipping;
    }
  }
}

void readForces(const ContactView& manifold, PointForces& points) {
  std::array<Vec3, 3> direction = {points.direction};
  chooseTangents(direction);
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    const std::size_t lane = laneOf(i);
    if (manifold.kind == PointKind::impulse) {
      const ImpulseRow& row = manifold.impulse(i);
      points.normal[i] = row.normalForce[lane];
      points.friction[i] = {row.friction[0][lane], row.friction[1][lane], row.friction[2][lane]};
      continue;
    }
    const AnchorRow& row = manifold.anchor(i);
    points.normal[i] = row.normalForce[lane];
    const bool pushed = row.normalForce[lane] > 0.0;
    const Vec3 friction = row.firstFriction[lane] * direction[1] + row.secondFriction[lane] * direction[2];
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
