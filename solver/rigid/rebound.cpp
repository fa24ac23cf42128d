#include "solver/rigid/rebound.h"

#include "core/tuning.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/rigid/constraints.h"
#include "solver/rigid/impact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace springtower {

namespace {

bool flies(const RigidIsland& island, std::int32_t body) {
  if (body < 0) return false;
  const RigidBody& of = island.bodies[static_cast<std::size_t>(body)];
  return !of.pushed && of.inverseMass > 0.0;
}

// One contact: along the normal to its speed of parting, then friction against what slip the impulse of that leaves. Returns the
// change of the speed, m/s.
double solveRebound(RigidIsland& island, RigidContact& contact, double& extra) {
  const double opening = relativeVelocity(island, contact).dot(contact.direction[0]);
  const double total = std::max(-contact.impulse[0], extra + contact.mass[0] * (contact.restitution * contact.impact - opening));
  const double more = total - extra;
  extra = total;
  if (more == 0.0) return 0.0;
  applyImpulse(island, contact, more * contact.direction[0]);
  const Vec3 relative = relativeVelocity(island, contact);
  double first = -contact.mass[1] * relative.dot(contact.direction[1]);
  double second = -contact.mass[2] * relative.dot(contact.direction[2]);
  boundFriction(first, second, contact.coefficient * std::max(0.0, more));
  applyImpulse(island, contact, first * contact.direction[1] + second * contact.direction[2]);
  return std::abs(more) / contact.mass[0];
}

template <class Pushes>
void markWhere(RigidIsland& island, const Pushes& pushes) {
  for (RigidBody& body : island.bodies) body.pushed = false;
  for (const RigidContact& contact : island.contacts) {
    for (const std::int32_t at : {contact.upper, contact.lower}) {
      if (at < 0) continue;
      RigidBody& body = island.bodies[static_cast<std::size_t>(at)];
      body.pushed = body.pushed || pushes(contact, body);
    }
  }
}

// Bounds the change from the velocities in island.motions to those of the bodies.
void boundChange(RigidIsland& island) {
  Vec3 velocity;
  Vec3 spin;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    RigidBody& body = island.bodies[i];
    fromLanes(island.motions[i].linear, velocity);
    fromLanes(island.motions[i].angular, spin);
    std::swap(body.velocity, velocity);
    std::swap(body.spin, spin);
    toLanes(velocity, island.motions[i].linear);
    toLanes(spin, island.motions[i].angular);
  }
  boundRebound(island, island.energyBefore_j);
  writeBodies(island);
}

}  // namespace

void setContactRebounds(const IslandStep& step, RigidIsland& island) {
  const double least = leastReboundSpeed(step.simulation);
  for (RigidContact& contact : island.contacts) {
    const double closing = -relativeVelocity(island, contact).dot(contact.direction[0]);
    const double pull = (flies(island, contact.upper) ? 1.0 : 0.0) - (flies(island, contact.lower) ? 1.0 : 0.0);
    const double gained = -2.0 * pull * step.gravity.dot(contact.direction[0]) * std::max(0.0, contact.gap);
    const double squared = closing * std::abs(closing) + gained;
    contact.restitution = restitutionOf(step.simulation, step.engine.pairs.key[static_cast<std::size_t>(contact.pair)]);
    contact.impact = squared > least * least ? std::sqrt(squared) : 0.0;
  }
}

void markPushed(const IslandStep& step, RigidIsland& island) {
  const double least_m_s = tuning::kRoundingPush * step.simulation.scene.gravity.magnitude * step.drift_s;
  markWhere(island, [&](const RigidContact& contact, const RigidBody& body) {
    return contact.impulse[0] * body.inverseMass > least_m_s;
  });
}

void markTouching(RigidIsland& island) {
  markWhere(island, [](const RigidContact& /*contact*/, const RigidBody& /*body*/) { return true; });
}

void applyContactRebounds(IslandStep& step, RigidIsland& island) {
  markPushed(step, island);
  double fastest = 0.0;
  std::vector<double>& extra = island.pivoting.column;
  extra.assign(std::max(extra.size(), island.contacts.size()), 0.0);
  for (RigidContact& contact : island.contacts) {
    // Of the points of a face that lands flat, or of a stack, one pass may push at some alone.
    const double closed = contact.impact * step.drift_s + step.simulation.lengths.contactError_m;
    const bool meets = contact.impulse[0] > 0.0 || contact.gap < closed;
    if (!meets) contact.impact = -1.0;
    if (!meets) continue;
    fastest = std::max(fastest, contact.impact);
  }
  if (!(fastest > 0.0)) return;
  island.motions.resize(island.bodies.size() + 1);
  readVelocities(island);
  double left = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < tuning::kMaxImpactPasses && left > tuning::kImpactPrecision * fastest; ++pass) {
    left = 0.0;
    for (std::size_t i = 0; i < island.contacts.size(); ++i) {
      if (island.contacts[i].impact >= 0.0) left = std::max(left, solveRebound(island, island.contacts[i], extra[i]));
    }
    step.counters.contactEvaluations += island.contacts.size();
  }
  if (step.driven.empty()) boundChange(island);
}

}  // namespace springtower
