#include "solver/rigid/constraints.h"

#include "solver/contact/rigid_contacts.h"
#include "solver/law/pair_geometry.h"

namespace springtower {

namespace {

// Up to four points of a manifold: position half way between the blocks, m; depth, m; and the unit normal towards upper.
struct Places {
  Lanes middle[3];
  Lanes depth;
  double normal[3];
};

SPRINGTOWER_INLINE void facePlaces(const ContactView& m, const AffineField& upper, const BlockFrame* lower, std::size_t first,
                                   Places& places) {
  const FaceAxes& lowerFace = kFaceAxes[static_cast<std::size_t>(m.referenceFace)];
  FaceField face;
  faceOf(upper, kFaceAxes[static_cast<std::size_t>(m.incidentFace)], face);
  Lanes u, v;
  load(m.place[rowOf(first)]->u.data(), u);
  load(m.place[rowOf(first)]->v.data(), v);
  Lanes point[3];
  at(face, u, v, point);
  double from[3] = {};
  for (std::size_t k = 0; k < 3; ++k) {
    places.normal[k] = lower == nullptr ? (k == 2 ? 1.0 : 0.0) : 2.0 * lowerFace.side * lower->normal[lowerFace.across][k];
    if (lower != nullptr) from[k] = lower->place.centre[k] + lowerFace.side * lower->place.side[lowerFace.across][k];
  }
  places.depth = -((point[0] - from[0]) * places.normal[0] + (point[1] - from[1]) * places.normal[1] +
                   (point[2] - from[2]) * places.normal[2]);
  for (std::size_t k = 0; k < 3; ++k) places.middle[k] = point[k] + 0.5 * places.depth * places.normal[k];
}

SPRINGTOWER_INLINE void edgePlaces(const ContactView& m, const AffineField& upper, const AffineField& lower, Places& places) {
  const EdgeAxes edgeUpper = edgeAxes(m.incidentFace);
  const EdgeAxes edgeLower = edgeAxes(m.referenceFace);
  Crossing crossing;
  crossingOf(upper, edgeUpper, lower, edgeLower, crossing);
  places.depth = Lanes{-crossing.gap, 0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < 3; ++k) {
    places.normal[k] = crossing.normal[k];
    const double middle = 0.5 * (onEdge(upper, edgeUpper, crossing.onUpper, k) + onEdge(lower, edgeLower, crossing.onLower, k));
    places.middle[k] = Lanes{middle, 0.0, 0.0, 0.0};
  }
}

// Contribution of a body to the inverse effective masses at a point.
struct Share {
  Lanes arm, lever, turn;
  double normal;
  double all;  // sum over the three directions
};

SPRINGTOWER_INLINE void shareOf(const SolverBody& body, const Lanes& normal, Share& share) {
  Lanes twice;
  crossLanes(share.arm, normal, share.lever);
  timesLanes(body.inverseInertia, share.lever, share.turn);
  timesLanes(body.inverseInertia, share.arm, twice);
  const double trace = body.inverseInertia[0][0] + body.inverseInertia[1][1] + body.inverseInertia[2][2];
  share.normal = body.inverseMass + sum(share.lever * share.turn);
  share.all = 3.0 * body.inverseMass + trace * sum(share.arm * share.arm) - sum(share.arm * twice);
}

// Warm start with the impulses of the step before.
SPRINGTOWER_INLINE void warmStart(const ContactView& m, std::size_t i, double step_s, ContactConstraint& p) {
  const ImpulseRow& row = m.impulse(i);
  const std::size_t lane = laneOf(i);
  p.push = step_s * row.normalForce[lane];
  const Lanes friction = {row.friction[0][lane], row.friction[1][lane], row.friction[2][lane], 0.0};
  p.idle = !(p.push > 0.0);
  p.friction = (p.idle ? 0.0 : step_s) * (friction - sum(friction * p.normal) * p.normal);
  p.sliding = false;
}

struct Mover {
  std::int32_t at;
  const SolverBody& body;
  Lanes centre;
};

SPRINGTOWER_INLINE void addPoints(const ContactView& m, const Mover& upper, const Mover& lower, const BlockFrame& upperFrame,
                                  const BlockFrame* lowerFrame, const Simulation& simulation, double step_s, std::int32_t pair,
                                  std::vector<ContactConstraint>& points) {
  const auto count = static_cast<std::size_t>(m.count);
  for (std::size_t first = 0; first < count; first += 4) {
    Places places;
    if (m.phase == PairPhase::edge) {
      edgePlaces(m, upperFrame.place, lowerFrame->place, places);
    } else {
      facePlaces(m, upperFrame.place, lowerFrame, first, places);
    }
    for (std::size_t i = first; i < std::min(count, first + 4); ++i) {
      const std::size_t lane = i - first;
      points.emplace_back();
      ContactConstraint& p = points.back();
      p.normal = Lanes{places.normal[0], places.normal[1], places.normal[2], 0.0};
      const Lanes place = {places.middle[0][lane], places.middle[1][lane], places.middle[2][lane], 0.0};
      Share up, low;
      up.arm = place - upper.centre;
      low.arm = place - lower.centre;
      shareOf(upper.body, p.normal, up);
      shareOf(lower.body, p.normal, low);
      p.armUpper = up.arm;
      p.armLower = low.arm;
      p.leverUpper = up.lever;
      p.leverLower = low.lever;
      p.turnUpper = up.turn;
      p.turnLower = low.turn;
      const double normal = up.normal + low.normal;
      p.normalMass = 1.0 / normal;
      // The two tangential directions together have the rest of the sum, and each has at least the inverse masses alone.
      p.acrossMass = 1.0 / (up.all + low.all - normal - (upper.body.inverseMass + lower.body.inverseMass));
      warmStart(m, i, step_s, p);
      p.gap = m.impulse(i).restDepth[lane] + springDepthOfForce(simulation, m, i) - places.depth[lane];
      p.coefficient = slipsAt(m, i) ? simulation.scene.kineticFriction : simulation.scene.staticFriction;
      p.upper = upper.at;
      p.lower = lower.at;
      p.pair = pair;
      p.point = static_cast<std::int32_t>(i);
    }
  }
}

}  // namespace

SPRINGTOWER_KERNEL
void gatherPoints(IslandStep& step, RigidIsland& island, bool again) {
  const Engine& engine = step.engine;
  island.known.clear();
  if (again) std::swap(island.known, island.points);
  island.points.clear();
  auto known = island.known.begin();
  readMovers(island);
  const auto unmoved = static_cast<std::int32_t>(island.bodies.size());
  const auto mover = [&](std::int32_t block) {
    const bool moves = block >= 0 && step.simulation.asleep[static_cast<std::size_t>(block)] == 0;
    const std::int32_t at = moves ? engine.scratch.nodeOf[static_cast<std::size_t>(block)] : unmoved;
    Lanes centre = {0.0, 0.0, 0.0, 0.0};
    if (moves) {
      const Vec3& place = island.bodies[static_cast<std::size_t>(at)].place;
      centre = Lanes{place[0], place[1], place[2], 0.0};
    }
    return Mover{at, island.movers[static_cast<std::size_t>(at)], centre};
  };
  for (const std::int32_t at : step.activePairs) {
    const ContactView m = contactOf(engine, static_cast<std::size_t>(at));
    if (m.phase == PairPhase::separated) continue;
    if (known != island.known.end() && known->pair == at) {
      for (; known != island.known.end() && known->pair == at; ++known) {
        island.points.push_back(*known);
        warmStart(m, static_cast<std::size_t>(known->point), step.drift_s, island.points.back());
      }
      continue;
    }
    const BlockFrame& upper = engine.memo.frames[static_cast<std::size_t>(m.upper)];
    const BlockFrame* lower = m.lower < 0 ? nullptr : &engine.memo.frames[static_cast<std::size_t>(m.lower)];
    addPoints(m, mover(m.upper), mover(m.lower), upper, lower, step.simulation, step.drift_s, at, island.points);
  }
  // The two are swapped: with unequal capacities a frame that is run again would allocate.
  island.known.reserve(island.points.capacity());
}

void keepPoints(IslandStep& step, const RigidIsland& island) {
  const double inverse = 1.0 / step.drift_s;
  for (const ContactConstraint& p : island.points) {
    const auto i = static_cast<std::size_t>(p.point);
    const std::size_t lane = laneOf(i);
    const std::int32_t contact = step.engine.pairs.contact[static_cast<std::size_t>(p.pair)];
    ImpulseRow& row = step.engine.contacts.points(contact)[rowOf(i)]->impulse;
    row.normalForce[lane] = inverse * p.push;
    for (std::size_t k = 0; k < 3; ++k) row.friction[k][lane] = inverse * p.friction[k];
    row.slipping[lane] = p.sliding ? 1.0 : 0.0;
  }
}

void readMovers(RigidIsland& island) {
  island.movers.resize(island.bodies.size() + 1);
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const RigidBody& body = island.bodies[i];
    SolverBody& mover = island.movers[i];
    mover.velocity = Lanes{body.velocity[0], body.velocity[1], body.velocity[2], 0.0};
    mover.spin = Lanes{body.spin[0], body.spin[1], body.spin[2], 0.0};
    for (int k = 0; k < 3; ++k)
      mover.inverseInertia[k] = Lanes{body.inverseInertia(0, k), body.inverseInertia(1, k), body.inverseInertia(2, k), 0.0};
    mover.inverseMass = body.inverseMass;
  }
  island.movers.back() = SolverBody{};
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
