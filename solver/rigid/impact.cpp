#include "solver/rigid/impact.h"

#include "solver/contact/rigid_contacts.h"
#include "solver/rigid/constraints.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace springtower {

namespace {

// A block that flies gains some speed before it meets what does not: the square of it, m2/s2, along a normal.
SPRINGTOWER_KERNEL
void setImpactsOf(const RigidIsland& island, const Lanes& gravity, double least, std::vector<ContactConstraint>& points) {
  const auto flies = [&](std::int32_t at) {
    if (at == unmovedBody(island)) return 0.0;
    const RigidBody& body = island.bodies[static_cast<std::size_t>(at)];
    return body.pushed || body.inverseMass == 0.0 ? 0.0 : 1.0;
  };
  for (ContactConstraint& p : points) {
    const SolverBody& upper = island.movers[static_cast<std::size_t>(p.upper)];
    const SolverBody& lower = island.movers[static_cast<std::size_t>(p.lower)];
    const double closing =
        -(sum(p.normal * (upper.velocity - lower.velocity)) + sum(p.leverUpper * upper.spin) - sum(p.leverLower * lower.spin));
    const double gained = -2.0 * (flies(p.upper) - flies(p.lower)) * sum(p.normal * gravity) * std::max(0.0, p.gap);
    const double squared = closing * std::abs(closing) + gained;
    p.before = p.push;
    p.impact = squared > least * least ? __builtin_sqrt(squared) : 0.0;
  }
}

double twiceKinetic(const RigidBody& body, const Vec3& velocity, const Vec3& spin, const Vec3& otherVelocity,
                    const Vec3& otherSpin) {
  const Vec3 own = body.axes.transpose() * spin;
  const Vec3 other = body.axes.transpose() * otherSpin;
  return velocity.dot(otherVelocity) / body.inverseMass + own.dot(body.moment * other);
}

}  // namespace

void setImpacts(const IslandStep& step, RigidIsland& island) {
  Lanes gravity;
  toLanes(step.gravity, gravity);
  const double least = leastReboundSpeed(step.simulation);
  setImpactsOf(island, gravity, least, island.steady.points);
  setImpactsOf(island, gravity, least, island.fast.points);
}

double fastestImpact(const RigidIsland& island) {
  double fastest = 0.0;
  for (const PointList* list : {&island.steady, &island.fast}) {
    for (const std::int32_t i : list->active) {
      const ContactConstraint& p = list->points[static_cast<std::size_t>(i)];
      if (p.push > 0.0) fastest = std::max(fastest, p.impact);
    }
  }
  return fastest;
}

double kineticEnergy(const std::vector<RigidBody>& bodies) {
  double twice = 0.0;
  for (const RigidBody& body : bodies) {
    if (body.inverseMass > 0.0) twice += twiceKinetic(body, body.velocity, body.spin, body.velocity, body.spin);
  }
  return 0.5 * twice;
}

// The energy is a square polynomial of the share of the change.
void boundRebound(RigidIsland& island, double most_j) {
  double start = 0.0;
  double linear = 0.0;
  double square = 0.0;
  const auto changeOf = [&](std::size_t i, Vec3& velocity, Vec3& spin) {
    const SolverBody& mover = island.movers[i];
    velocity = Vec3(mover.velocity[0], mover.velocity[1], mover.velocity[2]) - island.bodies[i].velocity;
    spin = Vec3(mover.spin[0], mover.spin[1], mover.spin[2]) - island.bodies[i].spin;
  };
  Vec3 velocity;
  Vec3 spin;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const RigidBody& body = island.bodies[i];
    if (body.inverseMass == 0.0) continue;
    changeOf(i, velocity, spin);
    start += 0.5 * twiceKinetic(body, body.velocity, body.spin, body.velocity, body.spin);
    linear += twiceKinetic(body, body.velocity, body.spin, velocity, spin);
    square += 0.5 * twiceKinetic(body, velocity, spin, velocity, spin);
  }
  const double left = most_j - start;
  if (linear + square <= left || !(square > 0.0)) return;
  const double share = left > 0.0 ? (std::sqrt(linear * linear + 4.0 * square * left) - linear) / (2.0 * square) : 0.0;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    if (island.bodies[i].inverseMass == 0.0) continue;
    changeOf(i, velocity, spin);
    toLanes(island.bodies[i].velocity + share * velocity, island.movers[i].velocity);
    toLanes(island.bodies[i].spin + share * spin, island.movers[i].spin);
  }
}

void forgetImpact(IslandStep& step, RigidIsland& island) {
  const double least = leastReboundSpeed(step.simulation);
  for (RigidBody& body : island.bodies) body.struck = (body.velocity - body.velocityBefore).squaredNorm() > least * least;
  const auto isStruck = [&](std::int32_t at) {
    return at != unmovedBody(island) && island.bodies[static_cast<std::size_t>(at)].struck;
  };
  for (PointList* list : {&island.steady, &island.fast}) {
    for (const PointGroup& group : list->groups) {
      const std::span<ContactConstraint> points =
          std::span(list->points).subspan(static_cast<std::size_t>(group.first), static_cast<std::size_t>(group.count));
      for (ContactConstraint& p : points) {
        if (!(p.push > p.before) || (!isStruck(p.upper) && !isStruck(p.lower))) continue;
        step.engine.scratch.covered[static_cast<std::size_t>(group.pair)] = kCoveredAndMet;
        p.friction *= p.before / p.push;
        p.push = p.before;
        p.idle = p.push == 0.0;
      }
    }
  }
}

}  // namespace springtower
