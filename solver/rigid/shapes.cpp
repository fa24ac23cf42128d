#include "solver/rigid/shapes.h"

#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/block/springs.h"
#include "solver/block/static_shape.h"
#include "solver/contact/query.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/world/over_island.h"
#include "solver/world/stiffness.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <span>

namespace springtower {

namespace {

// Rounds by which forces are found that store a given energy.
constexpr int kStrainBounds = 4;

// The body of a block of the island; null of any other.
RigidBody* bodyOf(const IslandStep& step, std::int32_t block, RigidIsland& island) {
  if (sleeps(step.simulation, block)) return nullptr;
  const auto node = static_cast<std::size_t>(step.engine.scratch.nodeOf[static_cast<std::size_t>(block)]);
  return node < step.blocks.size() && step.blocks[node] == block ? &island.bodies[node] : nullptr;
}

void addForce(const Vec3& place, const Vec3& force, RigidBody* body) {
  if (body == nullptr) return;
  const Vec3 arm = body->axes.transpose() * (place - body->place);
  const Vec3 own = body->axes.transpose() * force;
  body->load += arm * own.transpose();
}

// The share of a point's forces by which its springs are compressed, at most by the tolerance.
double lastingShare(const Simulation& simulation, const ContactView& manifold, std::size_t point, double normalForce) {
  const double stiffness = pairStiffness(simulation.stiffness, manifold.upper, manifold.lower);
  return stiffness * springDepthOfForce(simulation, manifold, point) / normalForce;
}

// Calls `visit(contact, manifold, points)` for each manifold of the island that stores impulses, with its forces now.
template <class Visit>
void forEachRigidContact(const IslandStep& step, std::span<const std::int32_t> pairs, Visit visit) {
  for (const std::int32_t pair : pairs) {
    const auto at = static_cast<std::size_t>(pair);
    if (!step.engine.pairs.touches(at)) continue;
    const ContactView manifold = contactOf(step.engine, at);
    if (manifold.kind == PointKind::impulse) visit(step.engine.pairs.contact[at], manifold, forcesNow(step.simulation, manifold));
  }
}

void addLoads(const IslandStep& step, RigidIsland& island) {
  forEachRigidContact(step, step.pairs, [&](std::int32_t, const ContactView& manifold, const PointForces& points) {
    RigidBody* upper = bodyOf(step, manifold.upper, island);
    RigidBody* lower = bodyOf(step, manifold.lower, island);
    for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
      if (!(points.normal[i] > 0.0)) continue;
      const Vec3 whole = points.normal[i] * points.direction + vectorAt(manifold.impulse(i).friction, i);
      const Vec3 force = lastingShare(step.simulation, manifold, i, points.normal[i]) * whole;
      addForce(points.place[i], force, upper);
      addForce(points.lowerPlace[i], -force, lower);
    }
  });
}

const StaticResponse& responseOf(const Engine& engine, std::int32_t block) {
  const std::vector<std::int32_t>& start = engine.responseStart;
  return engine.staticResponse[static_cast<std::size_t>(std::upper_bound(start.begin(), start.end(), block) - start.begin()) - 1];
}

// The corners of block `i` of the island with a share of what its loads change.
void relaxed(const IslandStep& step, std::size_t i, const RigidBody& body, double share, OwnCorners& corner) {
  const std::int32_t block = step.blocks[i];
  staticShape(responseOf(step.engine, block), step.simulation.model.dimensions[static_cast<std::size_t>(block)], body.load,
              corner);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t c = 0; c < kCorners; ++c) corner[a][c] = body.corner[a][c] + share * (corner[a][c] - body.corner[a][c]);
  }
}

// Energy that a share of that change stores in the springs, J. Energy is convex: a part of the share stores no more than that
// part of it.
double storedBy(const IslandStep& step, const RigidIsland& island, double share) {
  const BlockModel& model = step.simulation.model;
  double stored_j = 0.0;
  OwnCorners corner;
  for (std::size_t i = 0; i < step.blocks.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    const RigidBody& body = island.bodies[i];
    relaxed(step, i, body, share, corner);
    stored_j += springEnergy(model, corner, b) - springEnergy(model, body.corner, b);
  }
  return stored_j;
}

}  // namespace

void setMoments(Inertia inertia, double mass_kg, RigidBody& body) {
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  double farthest = 0.0;
  for (std::size_t c = 0; c < kCorners; ++c) {
    const Vec3 arm(body.corner[0][c], body.corner[1][c], body.corner[2][c]);
    farthest = std::max(farthest, arm.squaredNorm());
    moment += arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose();
  }
  body.moment = mass_kg / inverseMass(inertia).own * moment;
  body.inverseMoment = body.moment.inverse();
  body.radius_m = std::sqrt(farthest);
}

void prepareShapes(Simulation& simulation) {
  const BlockModel& model = simulation.model;
  Engine& engine = *simulation.engine;
  engine.staticResponse.clear();
  engine.responseStart.clear();
  for (std::size_t b = 0; b < model.blockCount(); ++b) {
    if (equalsPrevious(model, simulation.stiffness, b)) continue;
    engine.staticResponse.push_back(staticResponse(model, simulation.scene.settings.inertia, b));
    engine.responseStart.push_back(static_cast<std::int32_t>(b));
  }
}

double strainEnergyOfContacts(const IslandStep& step) {
  const auto sum = [&](std::size_t first, std::size_t last) {
    double energy_j = 0.0;
    const auto add = [&](std::int32_t, const ContactView& manifold, const PointForces& points) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i)
        energy_j += strainEnergy(step.simulation, manifold, i, points.depth[i]);
    };
    forEachRigidContact(step, step.pairs.subspan(first, last - first), add);
    return energy_j;
  };
  return sumRanges(step.pairs.size(), tuning::kPairGrain, isWide(step), sum);
}

double boundStrainOfContacts(const IslandStep& step, double most_j) {
  double energy_j = strainEnergyOfContacts(step);
  const double bound_j = std::max(0.0, most_j);
  for (int i = 0; i < kStrainBounds && energy_j > bound_j; ++i) {
    const double share = std::sqrt(bound_j / energy_j);  // the energy is quadratic in what lasts, or grows less
    const auto scale = [&](std::int32_t contact, const ContactView& manifold, const PointForces&) {
      const PointRows rows = step.engine.contacts.points(contact);
      for (std::size_t k = 0; k < static_cast<std::size_t>(manifold.count); ++k)
        rows[rowOf(k)]->impulse.lasting[laneOf(k)] *= share;
    };
    overPairs(step, [&](std::size_t first, std::size_t last) {
      forEachRigidContact(step, step.pairs.subspan(first, last - first), scale);
    });
    energy_j = strainEnergyOfContacts(step);
  }
  return energy_j;
}

void relaxShapes(const IslandStep& step, double time_s, double lost_j, RigidIsland& island) {
  const Simulation& simulation = step.simulation;
  for (RigidBody& body : island.bodies) body.load.setZero();
  addLoads(step, island);
  const double whole = time_s / (time_s + simulation.lengths.fallTime_s);
  const double stored_j = storedBy(step, island, whole);
  const double paid_j = std::max(0.0, lost_j);
  const double share = stored_j > paid_j ? whole * paid_j / stored_j : whole;
  OwnCorners corner;
  for (std::size_t i = 0; i < step.blocks.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    RigidBody& body = island.bodies[i];
    relaxed(step, i, body, share, corner);
    const Vec3 momentum = body.moment * (body.axes.transpose() * body.spin);
    body.corner = corner;
    setMoments(simulation.scene.settings.inertia, simulation.model.mass[b], body);
    body.spin = body.axes * (body.inverseMoment * momentum);
  }
}

}  // namespace springtower
