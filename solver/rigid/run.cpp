#include "solver/rigid/run.h"

#include "core/lanes.h"
#include "core/rotation_vector.h"
#include "core/tuning.h"
#include "solver/block/affine.h"
#include "solver/block/inertia.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/pushes.h"
#include "solver/contact/rigid_contacts.h"
#include "solver/contact/update.h"
#include "solver/rigid/impact.h"
#include "solver/rigid/list_points.h"
#include "solver/rigid/methods.h"
#include "solver/rigid/rebound.h"
#include "solver/rigid/shapes.h"
#include "solver/rigid/warm_start.h"
#include "solver/world/checkpoint.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/over_island.h"
#include "solver/world/stage_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springtower {

namespace {

// Driven blocks are bodies behind those of the island, of no inverse mass and inertia.
void readDriven(IslandStep& step, RigidIsland& island) {
  for (const BlockPair& driven : step.driven) {
    const auto b = static_cast<std::size_t>(driven.b);
    step.engine.scratch.nodeOf[b] = static_cast<std::int32_t>(island.bodies.size());
    island.bodies.emplace_back().radius_m = 0.5 * step.simulation.model.dimensions[b].norm();
  }
}

// Gives them the poses at a time (s), and the velocities that move them to those at the end of a step (s).
void driveBodies(IslandStep& step, double at_s, double step_s) {
  if (step.driven.empty()) return;
  RigidIsland& island = rigidIslandOf(step);
  for (const BlockPair& driven : step.driven) {
    const auto b = static_cast<std::size_t>(driven.b);
    RigidBody& body = island.bodies[static_cast<std::size_t>(step.engine.scratch.nodeOf[b])];
    const DrivenPose now = poseAt(step.simulation, driven.b, at_s);
    const DrivenPose next = poseAt(step.simulation, driven.b, at_s + step_s);
    body.place = now.centre;
    body.axes = (now.turn * step.simulation.scene.blocks[b].orientation).toRotationMatrix();
    body.velocity = (next.centre - now.centre) / step_s;
    body.spin = rotationVector(next.turn * now.turn.conjugate()) / step_s;
  }
}

void readPoses(IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const bool undeformed = isRigid(simulation.scene.settings.method);
  RigidIsland& island = rigidIslandOf(step);
  island.bodies.clear();
  island.bodies.resize(step.blocks.size());
  for (std::size_t i = 0; i < step.blocks.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    RigidBody& body = island.bodies[i];
    const RigidMotion motion = rigidMotion(simulation.state, b);
    body.place = motion.centre;
    body.velocity = motion.velocity;
    body.spin = motion.spin;
    body.axes = straightAxes(simulation.state.position, b);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 arm = body.axes.transpose() * (simulation.state.position.at(b, c) - motion.centre);
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        body.corner[a][c] = undeformed ? 0.5 * cornerSide(c, a) * simulation.model.dimensions[b][axis] : arm[axis];
      }
    }
    body.inverseMass = 1.0 / simulation.model.mass[b];
    setMoments(simulation.scene.settings.inertia, simulation.model.mass[b], body);
    step.engine.scratch.nodeOf[b] = static_cast<std::int32_t>(i);
  }
  readDriven(step, island);
}

void computeAllFrames(IslandStep& step) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    computeFrames(step.simulation.state.position, step.blocks.subspan(first, last - first), step.engine.memo.frames);
  });
}

SPRINGTOWER_KERNEL
void writePositionsOf(const RigidIsland& island, std::span<const std::int32_t> blocks, std::size_t first, std::size_t last,
                      ParticleArray& position) {
  for (std::size_t i = first; i < last; ++i) {
    const RigidBody& body = island.bodies[i];
    for (std::size_t a = 0; a < 3; ++a) {
      const auto row = static_cast<Eigen::Index>(a);
      double* x = position.values(a, static_cast<std::size_t>(blocks[i]));
      for (std::size_t c = 0; c < kCorners; ++c) {
        x[c] = body.place[row] + (body.axes(row, 0) * body.corner[0][c] + body.axes(row, 1) * body.corner[1][c] +
                                  body.axes(row, 2) * body.corner[2][c]);
      }
    }
  }
}

void writePositions(IslandStep& step) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    writePositionsOf(rigidIslandOf(step), step.blocks, first, last, step.simulation.state.position);
  });
}

void writeVelocities(IslandStep& step) {
  const RigidIsland& island = rigidIslandOf(step);
  MotionState& state = step.simulation.state;
  for (std::size_t i = 0; i < step.blocks.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    const RigidBody& body = island.bodies[i];
    for (std::size_t c = 0; c < kCorners; ++c)
      state.velocity.set(b, c, body.velocity + body.spin.cross(state.position.at(b, c) - body.place));
  }
}

// The largest mass of a body over the smallest.
double massRatioOf(const RigidIsland& island) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (const RigidBody& body : island.bodies) {
    if (body.inverseMass == 0.0) continue;  // driven
    least = std::min(least, body.inverseMass);
    most = std::max(most, body.inverseMass);
  }
  return most > 0.0 ? most / least : 1.0;
}

// A step of the LCP or the position-based method.
void stepOnce(IslandStep& step) {
  StageClock clock(step.times);
  RigidIsland& island = rigidIslandOf(step);
  for (RigidBody& body : island.bodies) {
    updateInertia(body);
    body.moved.setZero();
    body.turned.setZero();
  }
  island.energyBefore_j = kineticEnergy(island.bodies);
  gatherContacts(step, island);
  setContactRebounds(step, island);
  clock.lap(Stage::contacts);
  if (step.simulation.scene.settings.method == Method::rigidLcp) {
    stepRigidLcp(step, island);
  } else {
    stepXpbd(step, island);
  }
  addWorkOfForces(step, island);
  applyContactRebounds(step, island);
  storeForces(step, island);
  clock.lap(Stage::contacts);
  writePositions(step);
  clock.lap(Stage::integration);
}

// The same with sequential impulses: substeps over the points that may touch in the step.
void stepThroughSubsteps(IslandStep& step, double begin_s, int substeps, bool again) {
  StageClock clock(step.times);
  RigidIsland& island = rigidIslandOf(step);
  const double step_s = step.drift_s;
  const double substep_s = step_s / substeps;
  const bool sways = step.simulation.scene.gravity.sway_deg != 0.0;
  listPoints(step, island, substep_s, again);
  step.drift_s = substep_s;
  for (int i = 0; i < substeps; ++i) {
    step.time_s = begin_s + i * substep_s;
    if (sways) step.gravity = step.simulation.scene.gravity.at(step.time_s);
    driveBodies(step, step.time_s, substep_s);
    if (i > 0) placeDriven(step, begin_s, step.time_s);
    if (i > 0) addOutrun(step, island, step_s);
    // Both what is listed now and the hand's force follow the positions of the substep.
    if (i > 0 && (!island.fastPairs.empty() || holdsTether(step))) writePositions(step);
    if (!island.fastPairs.empty()) listFastPoints(step, island, i == 0);
    clock.lap(Stage::candidates);
    stepImpulses(step, island);
    clock.lap(Stage::contacts);
  }
  step.drift_s = step_s;
  writePositions(step);
  clock.lap(Stage::integration);
}

// A vector rotated about the direction of `half`, by an angle whose half has the tangent |half| (Cayley).
SPRINGTOWER_INLINE Vec3 turnedVector(const Vec3& half, const Vec3& v) {
  const Vec3 once = half.cross(v);
  return v + 2.0 / (1.0 + half.squaredNorm()) * (once + half.cross(once));
}

}  // namespace

Eigen::Matrix3d straightAxes(const ParticleArray& position, std::size_t block) {
  Eigen::Matrix3d axes;
  axes.col(0) = meanEdge(position, block, 0).normalized();
  const Vec3 second = meanEdge(position, block, 1);
  axes.col(1) = (second - second.dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

RigidIsland& rigidIslandOf(IslandStep& step) {
  return *step.rigid;
}

void prepareRigid(Simulation& simulation) {
  simulation.engine->scratch.nodeOf.assign(simulation.model.blockCount(), 0);
}

int rigidSubsteps(const Settings& settings) {
  if (settings.substeps > 0) return settings.substeps;
  return settings.method == Method::rigidLcp ? tuning::kLcpSubsteps : tuning::kRigidSubsteps;
}

double freePushOut(const Simulation& simulation, double mass_kg) {
  return tuning::kFreePushOut * mass_kg * simulation.scene.gravity.magnitude * simulation.lengths.blockHeight_m;
}

void turnAxes(const Vec3& angle, Eigen::Matrix3d& axes) {
  for (Eigen::Index k = 0; k < 3; ++k) axes.col(k) = turnedVector(0.5 * angle, axes.col(k));
}

void updateInertia(RigidBody& body) {
  body.inverseInertia = body.axes * body.inverseMoment * body.axes.transpose();
}

namespace {

RigidBody& bodyOf(const IslandStep& step, std::size_t block, RigidIsland& island) {
  return island.bodies[static_cast<std::size_t>(step.engine.scratch.nodeOf[block])];
}

// Where a user's force acts, m from the block's centre.
Vec3 armOf(const UserForce& user, const RigidBody& body) {
  if (user.corner >= 0) {
    const auto c = static_cast<std::size_t>(user.corner);
    return body.axes * Vec3(body.corner[0][c], body.corner[1][c], body.corner[2][c]);
  }
  return user.point ? Vec3(body.axes * *user.point) : Vec3(Vec3::Zero());
}

// The steps are long for the hand's springs, so their forces are those at the step's end (implicit).
void applyTether(IslandStep& step, RigidIsland& island) {
  Tether tether = step.simulation.tether;
  const std::size_t b = index(tether.block);
  RigidBody& body = bodyOf(step, b, island);
  const double h = step.drift_s;
  const double cornerInverseMass = inverseMass(step.simulation.scene.settings.inertia).own * body.inverseMass;
  const double centre = 1.0 + h * body.inverseMass * (tether.damping_n_s_m + h * tether.stiffness_n_m);
  const double level = 1.0 + h * cornerInverseMass * (tether.cornerDamping_n_s_m + h * tether.cornerStiffness_n_m);
  const double tilt = 1.0 + h * cornerInverseMass * (tether.tiltDamping_n_s_m + h * tether.tiltStiffness_n_m);
  tether.stiffness_n_m /= centre;
  tether.damping_n_s_m /= centre;
  tether.cornerStiffness_n_m /= level;
  tether.cornerDamping_n_s_m /= level;
  tether.tiltStiffness_n_m /= tilt;
  tether.tiltDamping_n_s_m /= tilt;
  MotionState& state = step.simulation.state;
  for (std::size_t c = 0; c < kCorners; ++c)
    state.velocity.set(b, c, body.velocity + body.spin.cross(state.position.at(b, c) - body.place));
  std::array<Vec3, kCorners> corner;
  const GripForce held = tetherForces(tether, step.simulation.model, state, step.time_s, corner);
  island.handForce = held.force;
  island.handTorque = held.torque;
  body.velocity += h * body.inverseMass * held.force;
  body.spin += h * (body.inverseInertia * held.torque);
}

}  // namespace

void applyForces(IslandStep& step) {
  RigidIsland& island = rigidIslandOf(step);
  // First, as its dashpots would otherwise act against the velocity that gravity adds in this step.
  if (holdsTether(step)) applyTether(step, island);
  for (RigidBody& body : island.bodies) {
    if (body.inverseMass > 0.0) body.velocity += step.drift_s * step.gravity;
  }
  forEachPush(step, step.time_s, step.time_s + step.drift_s, [&](const UserForce& user, const Load& mean) {
    RigidBody& body = bodyOf(step, static_cast<std::size_t>(user.block), island);
    body.velocity += step.drift_s * body.inverseMass * mean.force;
    const Vec3 moment = mean.torque + armOf(user, body).cross(mean.force);
    if (!moment.isZero(0.0)) body.spin += step.drift_s * (body.inverseInertia * moment);
  });
}

void addWorkOfForces(const IslandStep& step, RigidIsland& island) {
  for (const RigidBody& body : island.bodies) {
    if (body.inverseMass > 0.0) island.energyBefore_j += body.moved.dot(step.gravity) / body.inverseMass;
  }
  if (holdsTether(step)) {
    const RigidBody& body = bodyOf(step, index(step.simulation.tether.block), island);
    island.energyBefore_j += island.handForce.dot(body.moved) + island.handTorque.dot(body.turned);
  }
  forEachPush(step, step.time_s, step.time_s + step.drift_s, [&](const UserForce& user, const Load& mean) {
    const RigidBody& body = bodyOf(step, static_cast<std::size_t>(user.block), island);
    const Vec3 armNow = armOf(user, body);
    const Vec3 armThen = armNow - body.turned.cross(armNow);  // by which it has acted
    const Vec3 moment = mean.torque + armThen.cross(mean.force);
    island.energyBefore_j += mean.force.dot(body.moved) + moment.dot(body.turned);
  });
}

void moveFreely(RigidBody& body, double step_s) {
  body.place += step_s * body.velocity;
  body.moved += step_s * body.velocity;
  if (body.inverseMass == 0.0) {  // driven: its spin is given, and stays
    turnAxes(step_s * body.spin, body.axes);
    body.turned += step_s * body.spin;
    return;
  }
  const auto spinOf = [&](const Vec3& momentum) {
    return Vec3(body.axes * (body.inverseMoment * (body.axes.transpose() * momentum)));
  };
  const Vec3 momentum = body.axes * (body.moment * (body.axes.transpose() * body.spin));
  // What spins fast turns in parts of the step: the error of the energy is of second order in the angle.
  const double parts = std::ceil(body.spin.norm() * step_s / tuning::kMaxTurnAtOnce);
  const int count = static_cast<int>(std::clamp(parts, 1.0, static_cast<double>(tuning::kMaxTurns)));
  const double part_s = step_s / count;
  for (int i = 0; i < count; ++i) {
    const Vec3 quarter = 0.25 * part_s * body.spin;
    const Vec3 middle = turnedVector(quarter, spinOf(turnedVector(-quarter, momentum)));
    turnAxes(part_s * middle, body.axes);
    body.spin = spinOf(momentum);
    body.turned += part_s * middle;
  }
}

void moveInStep(const IslandStep& step, RigidBody& body) {
  moveFreely(body, step.drift_s);
  if (body.pushed || body.inverseMass == 0.0 || holdsTether(step)) return;
  const Vec3 lag = 0.5 * step.drift_s * step.drift_s * step.gravity;
  body.place -= lag;
  body.moved -= lag;
}

namespace {

// Substeps of sequential impulses in a step, of so many in all: the most up to tuning::kSubstepsPerStep that divide them evenly.
int substepsOf(int all) {
  int substeps = tuning::kSubstepsPerStep;
  while (all % substeps != 0) --substeps;
  return substeps;
}

// Runs `steps`, of `substeps` each (0: the method has none); returns whether all blocks have stayed in their swept boxes. A step
// in which a pair meets that was not listed is repeated with its contact, so that its blocks stop at the surface.
bool runSteps(IslandStep& step, int steps, int substeps, double begin_s) {
  const Simulation& simulation = step.simulation;
  RigidIsland& island = rigidIslandOf(step);
  const bool sequential = substeps > 0;
  bool inside = true;
  for (int i = 0; i < steps && inside; ++i) {
    const double at_s = simulation.time_s + begin_s + i * step.drift_s;
    step.time_s = at_s;
    step.gravity = simulation.scene.gravity.at(at_s);
    driveBodies(step, at_s, sequential ? step.drift_s / substeps : step.drift_s);
    saveStep(step);
    const double gained_j = island.gained_j;
    for (int repeat = 0;; ++repeat) {
      const std::uint64_t born = step.counters.contactsCreated;
      placeDriven(step, at_s, at_s);
      if (sequential) {
        stepThroughSubsteps(step, at_s, substeps, repeat > 0);
      } else {
        stepOnce(step);
      }
      placeDriven(step, at_s, at_s + step.drift_s);
      inside = findContacts(step);
      const bool met = sequential ? hasUncoveredContact(step) : born != step.counters.contactsCreated;
      if (!inside || !met || repeat == tuning::kMaxRigidStepRepeats) break;
      restoreStep(step);
      island.gained_j = gained_j;
      recomputeClearances(step);
    }
    computeAllFrames(step);
    if (sequential && inside) keepPoints(step, island);
    if (!sequential && inside) refreshContacts(step, refreshTravelOfExplicitSteps(simulation));
  }
  return inside;
}

// Blocks deform as the frame ends. `contacts_j`: energy of the contacts' springs as it began.
void takeShapes(IslandStep& step, double time_s, double contacts_j, RigidIsland& island) {
  const double most_j = isWorkedOn(step) ? std::numeric_limits<double>::infinity() : contacts_j - island.gained_j;
  const double stored_j = boundStrainOfContacts(step, most_j);
  relaxShapes(step, time_s, contacts_j - stored_j - island.gained_j, island);
  writePositions(step);
  computeAllFrames(step);
}

}  // namespace

IslandOutcome runRigidSteps(IslandStep& step, int steps, double begin_s) {
  Simulation& simulation = step.simulation;
  copyFrameStart(step);
  const Method method = simulation.scene.settings.method;
  step.pointKind = method == Method::xpbd ? PointKind::anchor : PointKind::impulse;
  const bool sequential = method != Method::rigidLcp && method != Method::xpbd;
  const int substeps = sequential ? substepsOf(steps) : 0;
  const int count = sequential ? steps / substeps : steps;
  IslandOutcome outcome;
  outcome.substeps = steps;
  step.drift_s = (step.part.end_s - begin_s) / count;
  step.kick_s = step.advance_s = step.drift_s;
  const auto taken = step.engine.scratch.rigidWork.take();
  RigidIsland& island = taken.record();
  step.rigid = &island;
  readPoses(step);
  computeAllFrames(step);
  step.usesActiveList = true;
  step.activeListSteps = 0;
  forgetPoints(island);
  island.rebounds = false;
  island.stands = !isMostlyFallen(step);
  island.massRatio = massRatioOf(island);
  island.gained_j = 0.0;
  const double contacts_j = isRigid(method) ? 0.0 : strainEnergyOfContacts(step);
  outcome.inside = runSteps(step, count, substeps, begin_s);
  if (sequential && outcome.inside) {
    writeVelocities(step);  // which manifold a pair has depends on how its blocks move
    storeInManifolds(step, island, step.drift_s / substeps);
    if (!isRigid(method)) takeShapes(step, step.part.end_s - begin_s, contacts_j, island);
  }
  equaliseMemory(island);
  writeVelocities(step);
  outcome.rebounds = island.rebounds;
  step.rigid = nullptr;
  for (const std::int32_t block : step.blocks) {
    step.engine.memo.blockHistory[static_cast<std::size_t>(block)].lastExplicitStep_s = step.drift_s;
    step.engine.memo.blockHistory[static_cast<std::size_t>(block)].lastImplicitStep_s = 0.0;
  }
  return outcome;
}

}  // namespace springtower
