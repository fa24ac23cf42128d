#include "solver/contact/query.h"

#include "solver/block/inertia.h"
#include "solver/block/springs.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/world/island_step.h"
#include "solver/world/stiffness.h"

#include <algorithm>

namespace springtower {

namespace {

// In which the stiffening of a contact that is hit fades, in sqrt(h / g); lowering a stiffness only takes energy out.
constexpr double kStiffeningTime = 0.2322;

// Whether explicit steps of this method have velocities half a step behind.
bool isLeapfrog(Method method) {
  return method == Method::semiImplicitEuler || isImplicit(method);
}

// A manifold as it stands at the positions now: frames of its blocks, and its memory brought up to date on a copy.
struct ManifoldNow {
  Manifold manifold;
  PointForces points;
  PairForce force;

  ManifoldNow(const Simulation& simulation, const Manifold& stored) : manifold(stored) {
    const auto upper = static_cast<std::size_t>(stored.upper);
    const auto lower = static_cast<std::size_t>(std::max(stored.lower, 0));
    const ParticleArray& carried = carriedVelocities(simulation);
    const BlockFrame frames[2] = {blockFrame(simulation.state.position, upper), blockFrame(simulation.state.position, lower)};
    const AffineField motion[2] = {affineField(simulation.state.velocity, upper), affineField(simulation.state.velocity, lower)};
    const AffineField carriedBy[2] = {affineField(carried, upper), affineField(carried, lower)};
    const ContactSide up{&frames[0], &motion[0], &carriedBy[0]};
    const ContactSide low{&frames[1], &motion[1], &carriedBy[1]};
    const ContactLaw law = contactLaw(simulation);
    const double behind = simulation.engine->blockHistory[upper].lastExplicitStep_s;
    const double kick = isLeapfrog(simulation.scene.settings.method) ? behind : 0.0;
    manifoldForces(manifold, up, low, law, {behind, 1.0, 1.0, kick}, reducedMass(simulation.model, stored), &manifold, force);
    points = pointForces(manifold, up, low, law);
    if (stored.rigid) {
      manifold = stored;
      readForces(stored, simulation.scene.settings.method, points);
    }
  }
};

// Stored in a manifold's springs, branches and anchors, J.
double energyOf(const Simulation& simulation, const ManifoldNow& now, const ContactLaw& law) {
  const Manifold& m = now.manifold;
  const double stiffness = m.lower < 0 ? law.floorStiffness_n_m : law.stiffness_n_m;
  double energy = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
    const double elastic = now.points.depth[i] - m.offset[i];
    if (m.rigid) {
      const double pressed = std::clamp(elastic, 0.0, pressedDepth(simulation, m, i));
      energy += 0.5 * stiffness * pressed * pressed;
      continue;
    }
    if (m.live[i] == 0.0 || elastic <= 0.0) continue;
    const double lag = elastic - m.relaxed[i];
    const double stretch = Vec3(m.stretchX[i], m.stretchY[i], m.stretchZ[i]).squaredNorm();
    energy += 0.5 * stiffness * m.scale[i] * (elastic * elastic + law.relaxingRatio * lag * lag + law.tangentialRatio * stretch);
  }
  return energy;
}

// Appends what the points of a manifold that push do.
void addContactForces(const Simulation& simulation, const Manifold& m, std::vector<ContactForce>& forces) {
  if (m.touch == PairPhase::separated) return;
  const ManifoldNow now(simulation, m);
  const PointForces& points = now.points;
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
    if (points.normal[i] <= 0.0) continue;
    forces.push_back({static_cast<BlockId>(m.upper), static_cast<BlockId>(m.lower), points.place[i], points.lowerPlace[i],
                      points.direction, points.normal[i],
                      Vec3(points.friction[i][0], points.friction[i][1], points.friction[i][2]), points.depth[i],
                      now.manifold.sliding[i] != 0.0});
  }
}

}  // namespace

ContactLaw contactLaw(const Simulation& simulation) {
  const Settings& settings = simulation.scene.settings;
  ContactLaw law;
  law.stiffness_n_m = simulation.contactStiffness_n_m;
  law.floorStiffness_n_m = simulation.floorStiffness_n_m;
  law.relaxingRatio = settings.viscoelasticRatio;
  law.relaxingTime_s = settings.viscoelasticTime * simulation.lengths.fallTime_s;
  law.dampingTime_s = simulation.dampingTime_s;
  law.scaleTime_s = kStiffeningTime * simulation.lengths.fallTime_s;
  law.tangentialRatio = settings.tangentialRatio;
  law.staticFriction = simulation.scene.staticFriction;
  law.kineticFriction = simulation.scene.kineticFriction;
  law.impactPenetration_m = impactDepth_m(settings, simulation.tolerance_m, simulation.lengths.blockHeight_m);
  law.offsetPerSlip = 0.1 * simulation.scene.kineticFriction;
  return law;
}

PointForces forcesNow(const Simulation& simulation, const Manifold& manifold) {
  if (manifold.touch == PairPhase::separated) return {};
  return ManifoldNow(simulation, manifold).points;
}

ContactWrench contactWrenchOnUpper(const Simulation& simulation, const Manifold& manifold) {
  ContactWrench push;
  if (manifold.touch == PairPhase::separated) return push;
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
  for (const NearPair& pair : simulation.engine->pairs) addContactForces(simulation, pair.manifold, forces);
  return forces;
}

std::vector<ContactForce> contactForcesOn(const Simulation& simulation, BlockId block) {
  const auto on = static_cast<std::int32_t>(block);
  std::vector<ContactForce> forces;
  for (const NearPair& pair : simulation.engine->pairs) {
    if (pair.manifold.upper == on || pair.manifold.lower == on) addContactForces(simulation, pair.manifold, forces);
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

  // The forces now, for the kinetic energy in the middle of the coming kick.
  ParticleArray force;
  force.resize(model.blockCount());
  std::vector<AffineField> contactForce(model.blockCount());
  std::vector<std::int32_t> all(model.blockCount());
  for (std::size_t b = 0; b < all.size(); ++b) all[b] = static_cast<std::int32_t>(b);
  for (const NearPair& pair : simulation.engine->pairs) {
    if (pair.manifold.touch == PairPhase::separated) continue;
    const ManifoldNow now(simulation, pair.manifold);
    energy.contacts += energyOf(simulation, now, law);
    addForce(now.force.upper, contactForce[static_cast<std::size_t>(pair.manifold.upper)]);
    if (pair.manifold.lower >= 0) addForce(now.force.lower, contactForce[static_cast<std::size_t>(pair.manifold.lower)]);
  }
  springForces(model, state, all, contactForce, force);
  const InverseMass inverse = inverseMass(settings.inertia);
  ParticleArray coming = state.velocity;
  ParticleArray change;
  change.resize(model.blockCount());
  for (std::size_t b = 0; b < model.blockCount(); ++b) {
    energy.springs += springEnergy(model, state.position, b);
    energy.gravity -= model.mass[b] * gravity.dot(centre(state.position, b));
    const double kick =
        isLeapfrog(settings.method) && simulation.asleep[b] == 0 ? simulation.engine->blockHistory[b].lastExplicitStep_s : 0.0;
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

double energyRise(const Energy& before, const Energy& after) {
  double rise = after.total() - before.total();
  for (std::size_t b = 0; b < before.step_s.size(); ++b) {
    const double longer = before.step_s[b] * before.step_s[b] - after.step_s[b] * after.step_s[b];
    rise -= longer * before.stepShare_j_s2[b];
  }
  return rise;
}

}  // namespace springtower
