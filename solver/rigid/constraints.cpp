#include "solver/rigid/constraints.h"

namespace springtower {

namespace {

// A vector given in a body's axes, in the world's.
SPRINGTOWER_INLINE void turned(const Eigen::Matrix3d& axes, const Lanes& own, Lanes& world) {
  Lanes x, y, z;
  toLanes(axes.col(0), x);
  toLanes(axes.col(1), y);
  toLanes(axes.col(2), z);
  world = x * own[0] + y * own[1] + z * own[2];
}

// A point's place on one of its bodies, and that body's centre; of what does not move the world's origin.
SPRINGTOWER_INLINE void placeOn(const RigidIsland& island, std::int32_t body, const Lanes& own, Lanes& centre, Lanes& place) {
  centre = Lanes{0.0, 0.0, 0.0, 0.0};
  place = own;
  if (body == unmovedBody(island)) return;
  const RigidBody& moves = island.bodies[static_cast<std::size_t>(body)];
  toLanes(moves.place, centre);
  turned(moves.axes, own, place);
  place += centre;
}

// Contribution of a body to the inverse effective masses at a point.
struct Share {
  double normal;
  double all;  // sum over the three directions
};

SPRINGTOWER_INLINE void shareOf(const SolverBody& body, const Lanes& arm, const Lanes& normal, Lanes& lever, Lanes& turn,
                                Share& share) {
  Lanes twice;
  crossLanes(arm, normal, lever);
  timesLanes(body.inverseInertia, lever, turn);
  timesLanes(body.inverseInertia, arm, twice);
  const double trace = body.inverseInertia[0][0] + body.inverseInertia[1][1] + body.inverseInertia[2][2];
  share.normal = body.inverseMass + sum(lever * turn);
  share.all = 3.0 * body.inverseMass + trace * sum(arm * arm) - sum(arm * twice);
}

SPRINGTOWER_INLINE void place(const RigidIsland& island, ContactConstraint& p) {
  Lanes centreUpper, onUpper, centreLower, onLower;
  placeOn(island, p.upper, p.placeUpper, centreUpper, onUpper);
  placeOn(island, p.lower, p.placeLower, centreLower, onLower);
  if (p.normalOf != NormalOf::world) {
    const std::int32_t body = p.normalOf == NormalOf::a ? p.upper : p.lower;
    turned(island.bodies[static_cast<std::size_t>(body)].axes, p.ownNormal, p.normal);
  }
  p.gap = sum(p.normal * (onUpper - onLower)) + p.allowed;
  const Lanes middle = 0.5 * (onUpper + onLower);
  p.armUpper = middle - centreUpper;
  p.armLower = middle - centreLower;
  const SolverBody& upper = island.movers[static_cast<std::size_t>(p.upper)];
  const SolverBody& lower = island.movers[static_cast<std::size_t>(p.lower)];
  Share up, low;
  shareOf(upper, p.armUpper, p.normal, p.leverUpper, p.turnUpper, up);
  shareOf(lower, p.armLower, p.normal, p.leverLower, p.turnLower, low);
  const double normal = up.normal + low.normal;
  p.normalMass = 1.0 / normal;
  // The two tangential directions together have the rest of the sum, and each has at least the inverse masses alone.
  p.acrossMass = 1.0 / (up.all + low.all - normal - (upper.inverseMass + lower.inverseMass));
  p.friction -= sum(p.friction * p.normal) * p.normal;
}

SPRINGTOWER_KERNEL
void placeAll(const RigidIsland& island, std::vector<ContactConstraint>& points) {
  for (ContactConstraint& p : points) place(island, p);
}

SPRINGTOWER_KERNEL
void moveGapsOf(const std::vector<RigidBody>& bodies, std::vector<ContactConstraint>& points) {
  const auto read = [&](std::int32_t at, Lanes& moved, Lanes& turn) {
    moved = turn = Lanes{0.0, 0.0, 0.0, 0.0};
    if (static_cast<std::size_t>(at) == bodies.size()) return;
    toLanes(bodies[static_cast<std::size_t>(at)].moved, moved);
    toLanes(bodies[static_cast<std::size_t>(at)].turned, turn);
  };
  for (ContactConstraint& p : points) {
    Lanes movedUpper, turnedUpper, movedLower, turnedLower;
    read(p.upper, movedUpper, turnedUpper);
    read(p.lower, movedLower, turnedLower);
    p.gap += sum(p.normal * (movedUpper - movedLower) + (p.leverUpper * turnedUpper - p.leverLower * turnedLower));
  }
}

}  // namespace

void placeConstraints(RigidIsland& island) {
  placeAll(island, island.steady.points);
  placeAll(island, island.fast.points);
}

void moveGaps(RigidIsland& island) {
  moveGapsOf(island.bodies, island.steady.points);
  moveGapsOf(island.bodies, island.fast.points);
}

void readMovers(RigidIsland& island) {
  island.movers.resize(island.bodies.size() + 1);
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const RigidBody& body = island.bodies[i];
    SolverBody& mover = island.movers[i];
    for (int k = 0; k < 3; ++k)
      mover.inverseInertia[k] = Lanes{body.inverseInertia(0, k), body.inverseInertia(1, k), body.inverseInertia(2, k), 0.0};
    mover.inverseMass = body.inverseMass;
  }
  island.movers.back() = SolverBody{};
  readVelocities(island);
}

void readVelocities(RigidIsland& island) {
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    toLanes(island.bodies[i].velocity, island.movers[i].velocity);
    toLanes(island.bodies[i].spin, island.movers[i].spin);
  }
}

void writeMovers(RigidIsland& island) {
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const SolverBody& mover = island.movers[i];
    for (int k = 0; k < 3; ++k) {
      island.bodies[i].velocity[k] = mover.velocity[k];
      island.bodies[i].spin[k] = mover.spin[k];
    }
  }
}

}  // namespace springtower
