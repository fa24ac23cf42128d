#pragma once

#include "core/tuning.h"
#include "solver/law/contact_force.h"
#include "solver/world/island_step.h"
#include "solver/world/rigid_island.h"
#include "solver/world/scales.h"

#include <algorithm>
#include <cmath>

namespace springtower {

// The manifolds of narrowphase/ as constraints between rigid blocks. Their points store impulses (ImpulseRow), or anchors
// (AnchorRow) in the position-based method, and are matched between manifolds in the same way as points of the penalty methods.

/// The kind of state that contact points store in the steps of a method.
constexpr PointKind pointKindOf(Method method) {
  const MethodTraits traits = traitsOf(method);
  if (traits.anchors) return PointKind::anchor;
  return traits.family == MethodFamily::rigid ? PointKind::impulse : PointKind::penalty;
}

/// The points of a manifold at the poses of engine.memo.frames.
PointForces pointsNow(const IslandStep& step, const ContactView& manifold);

/// Lists all points of an island's touching manifolds at the poses of engine.memo.frames, with arms, gaps, effective masses and
/// the impulses of the step before.
void gatherContacts(IslandStep& step, RigidIsland& island);

/// Stores the impulses of a step in the manifolds, as forces.
void storeForces(IslandStep& step, const RigidIsland& island);

/// The forces that `storeForces` stored in a manifold, for reports: normal and friction of each point.
void readForces(const ContactView& manifold, PointForces& points);

/// Depth to which the springs of a point would be compressed by what lasts of its normal force, m, in an island in rigid mode of
/// a penalty method. At most the tolerance; 0 in the rigid methods, which have no springs.
inline double springDepthOfForce(const Simulation& simulation, const ContactView& manifold, std::size_t point) {
  if (isRigid(simulation.scene.settings.method)) return 0.0;
  const double stiffness = pairStiffness(simulation.stiffness, manifold.upper, manifold.lower);
  const ImpulseRow& row = manifold.impulse(point);
  return std::min(std::min(row.normalForce[laneOf(point)], row.lasting[laneOf(point)]) / stiffness, simulation.tolerance_m);
}

/// Depth to which they are compressed at an overlap of `depth_m`: no deeper than from where they are without force.
inline double springStrain(const Simulation& simulation, const ContactView& manifold, std::size_t point, double depth_m) {
  const double room = depth_m - manifold.impulse(point).restDepth[laneOf(point)];
  return std::max(0.0, std::min(springDepthOfForce(simulation, manifold, point), room));
}

/// Energy stored in a point's springs at an overlap of `depth_m`, J, in an island in rigid mode of a penalty method. Springs that
/// are compressed less than the force would, hold as much less friction.
inline double strainEnergy(const Simulation& simulation, const ContactView& manifold, std::size_t point, double depth_m) {
  const double pressed = springStrain(simulation, manifold, point, depth_m);
  if (pressed == 0.0) return 0.0;
  const ImpulseRow& row = manifold.impulse(point);
  const double stiffness = pairStiffness(simulation.stiffness, manifold.upper, manifold.lower);
  const double held = stiffness * pressed / row.normalForce[laneOf(point)];
  const double stuck = held * held * vectorAt(row.friction, point).squaredNorm();
  return 0.5 * (stiffness * pressed * pressed + stuck / (simulation.scene.settings.tangentialRatio * stiffness));
}

/// Coefficient of restitution of two blocks, the second -1 for the floor.
inline double restitutionOf(const Simulation& simulation, const BlockPair& pair) {
  const AlignedVector<double>& root = simulation.model.rootRestitution;
  if (root.empty()) return simulation.scene.restitution;
  const double other = pair.b < 0 ? std::sqrt(simulation.scene.restitution) : root[static_cast<std::size_t>(pair.b)];
  return root[static_cast<std::size_t>(pair.a)] * other;
}

/// Blocks that meet at less than this do not rebound, m/s; 0 without gravity.
inline double leastReboundSpeed(const Simulation& simulation) {
  return tuning::kMinReboundSpeed * speedScale_m_s(simulation);
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

/// Bounds the two tangential parts of an impulse by Coulomb's cone: shortens them to the magnitude `most`, keeping their
/// direction. Returns whether they were longer.
inline bool boundFriction(double& first, double& second, double most) {
  const double squared = first * first + second * second;
  if (squared <= most * most) return false;
  const double share = most / std::sqrt(squared);
  first *= share;
  second *= share;
  return true;
}

/// Displacement of upper relative to lower at a contact since the step began, m, to first order in the rotations.
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
