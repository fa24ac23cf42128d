#include "solver/contact/query.h"

#include "core/parallel.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/block/springs.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/world/over_island.h"
#include "solver/world/stiffness.h"

#include <algorithm>

namespace springtower {

namespace {

// A manifold at the present positions: frames of its blocks, and a copy of its points advanced to them.
struct ManifoldNow {
  Manifold manifold;
  PointForces points;
  PairForce force;

  ManifoldNow(const Simulation& simulation, const ContactLaw& law, const ContactView& stored) : manifold(copyOf(stored)) {
    const auto upper = static_cast<std::size_t>(stored.upper);
    // Of the floor nothing is used. The block in its place is this island's own: another one might be moving meanwhile.
    const auto lower = static_cast<std::size_t>(stored.lower < 0 ? stored.upper : stored.lower);
    const ParticleArray& carried = carriedVelocities(simulation);
    const BlockFrame frames[2] = {blockFrame(simulation.state.position, upper), blockFrame(simulation.state.position, lower)};
    const AffineField motion[2] = {affineField(simulation.state.velocity, upper), affineField(simulation.state.velocity, lower)};
    const AffineField carriedBy[2] = {affineField(carried, upper), affineField(carried, lower)};
    const ContactSide up{&frames[0], &motion[0], &carriedBy[0]};
    const ContactSide low{&frames[1], &motion[1], &carriedBy[1]};
    const double behind = simulation.engine->memo.blockHistory[upper].lastExplicitStep_s;
    const double kick = traitsOf(simulation.scene.settings.method).leapfrog ? behind : 0.0;
    const PointRows rows{manifold.points.data(), manifold.points.data() + 1};
    manifoldForces(manifold, up, low, law, {behind, 1.0, false, false, kick}, reducedMass(simulation.model, stored), &rows,
                   force);
    points = pointForces(manifold, up, low, law);
    if (stored.kind != PointKind::penalty) {
      manifold = copyOf(stored);
      readForces(stored, points);
    }
  }
};

// Energy stored in a manifold's springs, Maxwell branches and friction displacements, J.
double energyOf(const Simulation& simulation, const ManifoldNow& now, const ContactLaw& law) {
  const ContactView m = now.manifold;
  const double stiffness = law.stiffnessOf(m.upper, m.lower);
  double energy = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
    const std::size_t lane = laneOf(i);
    const PenaltyRow& row = m.penalty(i);
    const double elastic = now.points.depth[i] - row.restDepth[lane];
    if (m.kind != PointKind::penalty) {
      if (m.kind == PointKind::impulse) energy += strainEnergy(simulation, m, i, now.points.depth[i]);
      continue;
    }
    if (row.touching[lane] == 0.0 || elastic <= 0.0) continue;
    const double lag = elastic - row.maxwellDepth[lane];
    const double across = vectorAt(row.displacement, i).squaredNorm();
    energy += 0.5 * stiffness * row.stiffening[lane] *
              (elastic * elastic + law.maxwellRatio * lag * lag + law.tangentialRatio * across);
  }
  return energy;
}

// Appends the forces of a manifold's active points.
void addContactForces(const Simulation& simulation, const ContactLaw& law, const ContactView& m,
                      std::vector<ContactForce>& forces) {
  if (m.phase == PairPhase::separated) return;
  const ManifoldNow now(simulation, law, m);
  const PointForces& points = now.points;
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
    if (points.normal[i] <= 0.0) continue;
    forces.push_back({static_cast<BlockId>(m.upper), static_cast<BlockId>(m.lower), points.place[i], points.lowerPlace[i],
                      points.direction, points.normal[i],
                      Vec3(points.friction[i][0], points.friction[i][1], points.friction[i][2]), points.depth[i],
                      slipsAt(now.manifold, i)});
  }
}

}  // namespace

ContactLaw contactLaw(const Simulation& simulation) {
  const Settings& settings = simulation.scene.settings;
  ContactLaw law;
  law.stiffness = &simulation.stiffness;
  law.maxwellRatio = settings.maxwellRatio;
  law.maxwellTime_s = settings.maxwellTime * simulation.lengths.fallTime_s;
  law.dampingTime_s = simulation.dampingTime_s;
  law.stiffeningTime_s = tuning::kImpactStiffeningTime * simulation.lengths.fallTime_s;
  law.tangentialRatio = settings.tangentialRatio;
  law.friction = &simulation.friction;
  law.impactPenetration_m = impactDepth_m(settings, simulation.tolerance_m, simulation.lengths.blockHeight_m);
  law.restDepthPerSlip = tuning::kRestDepthPerSlip;
  return law;
}

PointForces forcesNow(const Simulation& simulation, const ContactView& manifold) {
  if (manifold.phase == PairPhase::separated) return {};
  return ManifoldNow(simulation, contactLaw(simulation), manifold).points;
}

ContactWrench contactWrenchOnUpper(const Simulation& simulation, const ContactView& manifold) {
  ContactWrench push;
  if (manifold.phase == PairPhase::separated) return push;
  const PointForces points = forcesNow(simulation, manifold);
  push.direction = points.direction;
  for (std::size_t i = 0; i < static_cast<std::size_t>(manifold.count); ++i) {
    const Vec3 force =
        points.normal[i] * points.direction + Vec3(points.friction[i][0], points.friction[i][1], points.friction[i][2]);
    push.force += force;
    push.torque += points.place[i].cross(force);
  }
  return push;
}

std::vector<ContactForce> contactForces(const Simulation& simulation) {
  std::vector<ContactForce> forces;
  const Engine& engine = *simulation.engine;
  const ContactLaw law = contactLaw(simulation);
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) addContactForces(simulation, law, contactOf(engine, at), forces);
  return forces;
}

std::vector<ContactForce> contactForcesOn(const Simulation& simulation, BlockId block) {
  const auto on = static_cast<std::int32_t>(block);
  std::vector<ContactForce> forces;
  const Engine& engine = *simulation.engine;
  const ContactLaw law = contactLaw(simulation);
  for (std::size_t at = 0; at < engine.pairs.size(); ++at) {
    const ContactView contact = contactOf(engine, at);
    if (contact.upper == on || contact.lower == on) addContactForces(simulation, law, contact, forces);
  }
  return forces;
}

Energy energy(const Simulation& simulation) {
  const BlockModel& model = simulation.model;
  const MotionState& state = simulation.state;
  const Settings& settings = simulation.scene.settings;
  const ContactLaw law = contactLaw(simulation);
  const Vec3 gravity = simulation.scene.gravity.at(simulation.time_s);
  Energy energy;

  // Forces at the present state, for the kinetic energy in the middle of the coming kick.
  ParticleArray force;
  force.resize(model.blockCount());
  std::vector<AffineField> contactForce(model.blockCount());
  std::vector<std::int32_t> all(model.blockCount());
  for (std::size_t b = 0; b < all.size(); ++b) all[b] = static_cast<std::int32_t>(b);
  for (std::size_t at = 0; at < simulation.engine->pairs.size(); ++at) {
    const ContactView contact = contactOf(*simulation.engine, at);
    if (contact.phase == PairPhase::separated) continue;
    const ManifoldNow now(simulation, law, contact);
    energy.contacts += energyOf(simulation, now, law);
    addForce(now.force.upper, contactForce[static_cast<std::size_t>(contact.upper)]);
    if (contact.lower >= 0) addForce(now.force.lower, contactForce[static_cast<std::size_t>(contact.lower)]);
  }
  springForces(model, state, all, contactForce, force);
  const InverseMass inverse = inverseMass(settings.inertia);
  ParticleArray coming = state.velocity;
  ParticleArray change;
  change.resize(model.blockCount());
  for (std::size_t b = 0; b < model.blockCount(); ++b) {
    if (model.isFixed(b)) {
      energy.step_s.push_back(0.0);
      energy.stepShare_j_s2.push_back(0.0);
      continue;
    }
    energy.springs += springEnergy(model, state.position, b);
    energy.gravity -= model.mass[b] * gravity.dot(centre(state.position, b));
    const double kick = traitsOf(settings.method).leapfrog && simulation.asleep[b] == 0
                            ? simulation.engine->memo.blockHistory[b].lastExplicitStep_s
                            : 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double* f = force.values(a, b);
      double* v = coming.values(a, b);
      double* acceleration = change.values(a, b);
      double sum = 0.0;
      for (std::size_t c = 0; c < kCorners; ++c) sum += f[c];
      for (std::size_t c = 0; c < kCorners; ++c) {
        acceleration[c] = (inverse.own * f[c] - inverse.shared * sum) / model.mass[b] + gravity[static_cast<Eigen::Index>(a)];
        v[c] += kick * acceleration[c];
      }
    }
    energy.step_s.push_back(kick);
    energy.stepShare_j_s2.push_back(0.125 * model.mass[b] * massProduct(settings.inertia, change, change, b));
    energy.kinetic += 0.5 * model.mass[b] * massProduct(settings.inertia, state.velocity, coming, b);
  }
  return energy;
}

IslandEnergy islandEnergy(const IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const BlockModel& model = simulation.model;
  const ParticleArray& position = simulation.state.position;
  const ParticleArray& velocity = simulation.state.velocity;
  const Vec3 gravity = simulation.scene.gravity.at(simulation.time_s);
  const auto ofBlocks = [&](std::size_t first, std::size_t last, const auto& energyOfBlock) {
    double energy_j = 0.0;
    for (const std::int32_t block : step.blocks.subspan(first, last - first))
      energy_j += energyOfBlock(static_cast<std::size_t>(block));
    return energy_j;
  };
  const auto kinetic = [&](std::size_t first, std::size_t last) {
    return ofBlocks(first, last, [&](std::size_t b) {
      return 0.5 * model.mass[b] * massProduct(simulation.scene.settings.inertia, velocity, velocity, b);
    });
  };
  const auto potential = [&](std::size_t first, std::size_t last) {
    return ofBlocks(first, last, [&](std::size_t b) {
      return springEnergy(model, position, b) - model.mass[b] * gravity.dot(centre(position, b));
    });
  };
  const auto contacts = [&](std::size_t first, std::size_t last) {
    double energy_j = 0.0;
    for (const std::int32_t pair : step.pairs.subspan(first, last - first)) {
      const auto at = static_cast<std::size_t>(pair);
      if (!step.engine.pairs.touches(at)) continue;
      energy_j += energyOf(simulation, ManifoldNow(simulation, step.law, contactOf(step.engine, at)), step.law);
    }
    return energy_j;
  };
  const double kinetic_j = sumRanges(step.blocks.size(), tuning::kBlockGrain, isWide(step), kinetic);
  return {kinetic_j, kinetic_j + sumRanges(step.blocks.size(), tuning::kBlockGrain, isWide(step), potential) +
                         sumRanges(step.pairs.size(), tuning::kPairGrain, isWide(step), contacts)};
}

double energyRise(const Energy& before, const Energy& after) {
  double rise = after.total() - before.total();
  for (std::size_t b = 0; b < before.step_s.size(); ++b) {
    const double longer = before.step_s[b] * before.step_s[b] - after.step_s[b] * after.step_s[b];
    rise -= longer * before.stepShare_j_s2[b];
  }
  return rise;
}

}  // namespace springtower
