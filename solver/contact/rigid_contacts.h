#pragma once

#include "solver/law/contact_force.h"
#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"

#include <algorithm>
#include <cmath>

namespace springtower {

// The manifolds of narrowphase/ as constraints between rigid blocks. Their points store impulses (ImpulseRow), or anchors
// (AnchorRow) in the position-based method, and are handed from manifold to manifold as those of the penalty methods are.

/// What the points of contacts store in the steps of a method.
constexpr PointKind pointKindOf(Method method) {
  const MethodTraits traits = traitsOf(method);
  if (traits.anchors) return PointKind::anchor;
  return traits.family == MethodFamily::rigid ? PointKind::impulse : PointKind::penalty;
}

/// Lists all points of an island's touching manifolds at the places of engine.memo.frames, with arms, gaps, effective masses and
/// the impulses of the step before.
void gatherContacts(IslandStep& step, RigidIsland& island);

/// Puts the impulses of a step back into the manifolds, as forces.
void keepForces(IslandStep& step, const RigidIsland& island);

/// The forces that `keepForces` put into a manifold, for reports: normal and friction of each point.
void readForces(const ContactView& manifold, PointForces& points);

/// How deep the springs of a point would be pressed by the normal force that rigid steps remember, m: so deep they leave it where
/// an island of another method falls, and what is pressed holds its energy. No deeper than the tolerance, as what stands; 0 of
/// the rigid methods, which have no springs.
inline double pressedDepth(const Simulation& simulation, const ContactView& manifold, std::size_t point) {
  if (isRigid(simulation.scene.settings.method)) return 0.0;
  const double stiffness = manifold.lower < 0 ? simulation.floorStiffness_n_m : simulation.contactStiffness_n_m;
  return std::min(manifold.impulse(point).normalForce[laneOf(point)] / stiffness, simulation.tolerance_m);
}

/// Velocity of upper against lower at a contact, m/s.
inline Vec3 relativeVelocity(const RigidIsland& island, const RigidContact& contact) {
  Vec3 relative = Vec3::Zero();
  if (contact.upper >= 0) {
    const RigidBody& body = island.bodies[static_cast<std::size_t>(contact.upper)];
    relative += body.velocity + body.spin.cross(contact.armUpper);
  }
  if (contact.lower >= 0) {
    const RigidBody& body = island.bodies[static_cast<std::size_t>(contact.lower)];
    relative -= body.velocity + body.spin.cross(contact.armLower);
  }
  return relative;
}

/// Applies an impulse (N s) to both blocks of a contact, to upper as it is and to lower reversed.
inline void applyImpulse(RigidIsland& island, const RigidContact& contact, const Vec3& impulse) {
  if (contact.upper >= 0) {
    RigidBody& body = island.bodies[static_cast<std::size_t>(contact.upper)];
    body.velocity += body.inverseMass * impulse;
    body.spin += body.inverseInertia * contact.armUpper.cross(impulse);
  }
  if (contact.lower >= 0) {
    RigidBody& body = island.bodies[static_cast<std::size_t>(contact.lower)];
    body.velocity -= body.inverseMass * impulse;
    body.spin -= body.inverseInertia * contact.armLower.cross(impulse);
  }
}

/// One over the effective mass of a contact along a unit direction, 1/kg.
double inverseEffectiveMass(const RigidIsland& island, const RigidContact& contact, const Vec3& direction);

/// Bounds the two tangential parts of an impulse by Coulomb's cone: keeps their direction and shortens them to `most`. Returns
/// whether they were longer.
inline bool boundFriction(double& first, double& second, double most) {
  const double squared = first * first + second * second;
  if (squared <= most * most) return false;
  const double share = most / std::sqrt(squared);
  first *= share;
  second *= share;
  return true;
}

/// How far upper has moved against lower at a contact since the step began, m, to first order in the turns.
inline Vec3 relativeMove(const RigidIsland& island, const RigidContact& contact) {
  Vec3 moved = Vec3::Zero();
  if (contact.upper >= 0) {
    const RigidBody& body = island.bodies[static_cast<std::size_t>(contact.upper)];
    moved += body.moved + body.turned.cross(contact.armUpper);
  }
  if (contact.lower >= 0) {
    const RigidBody& body = island.bodies[static_cast<std::size_t>(contact.lower)];
    moved -= body.moved + body.turned.cross(contact.armLower);
  }
  return moved;
}

}  // namespace springtower
