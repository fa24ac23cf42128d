#include "solver/rigid_frame.h"

#include "solver/block_frames.h"
#include "solver/inertia.h"
#include "solver/rigid_contacts.h"
#include "solver/stage_clock.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// Steps of a frame where the user names none: as many as keep the game's tower of 18 rows within the default tolerance.
constexpr int kRigidSubsteps = 64;
// The pivoting method solves its contacts exactly, and slowly.
constexpr int kPivotingSubsteps = 4;
// How often a step is taken again because of contacts found in it.
constexpr int kMostRepeats = 4;

// Principal moments: of a cuboid m (b^2 + c^2) / 12; with the mass in eight corners three times as much.
Vec3 momentOf(const Simulation& simulation, std::size_t block) {
  const Vec3 squares = simulation.model.dimensions[block].cwiseAbs2();
  const double share = 2.0 / inverseMass(simulation.scene.settings.inertia).own;
  return share * simulation.model.mass[block] * (Vec3::Constant(squares.sum()) - squares);
}

void readPoses(IslandStep& step) {
  const Simulation& simulation = step.simulation;
  RigidIsland& island = rigidIslandOf(step);
  island.bodies.resize(step.blocks.size());
  for (std::size_t i = 0; i < step.blocks.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    RigidBody& body = island.bodies[i];
    const RigidMotion motion = rigidMotion(simulation.state, b);
    body.place = motion.centre;
    body.velocity = motion.velocity;
    body.spin = motion.spin;
    body.turn = Eigen::Quaterniond(straightAxes(simulation.state.position, b)).normalized();
    body.moment = momentOf(simulation, b);
    body.inverseMass = 1.0 / simulation.model.mass[b];
    step.engine.nodeOf[b] = static_cast<std::int32_t>(i);
  }
}

Vec3 halfSides(const Simulation& simulation, std::size_t block, std::size_t corner) {
  Vec3 arm;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    arm[axis] = 0.5 * cornerSide(corner, a) * simulation.model.dimensions[block][axis];
  }
  return arm;
}

void writeParticles(IslandStep& step) {
  Simulation& simulation = step.simulation;
  const RigidIsland& island = rigidIslandOf(step);
  for (std::size_t i = 0; i < step.blocks.size(); ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    const RigidBody& body = island.bodies[i];
    const Eigen::Matrix3d axes = body.turn.toRotationMatrix();
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 arm = axes * halfSides(simulation, b, c);
      simulation.state.position.set(b, c, body.place + arm);
      simulation.state.velocity.set(b, c, body.velocity + body.spin.cross(arm));
    }
  }
}

void rememberStart(IslandStep& step) {
  RigidIsland& island = rigidIslandOf(step);
  for (RigidBody& body : island.bodies) {
    body.placeBefore = body.place;
    body.turnBefore = body.turn;
    body.velocityBefore = body.velocity;
    body.spinBefore = body.spin;
  }
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t a = 0; a < 3; ++a)
      std::copy_n(step.simulation.state.position.values(a, b), kCorners, step.engine.previous.values(a, b));
  }
}

void backToStart(IslandStep& step) {
  RigidIsland& island = rigidIslandOf(step);
  for (RigidBody& body : island.bodies) {
    body.place = body.placeBefore;
    body.turn = body.turnBefore;
    body.velocity = body.velocityBefore;
    body.spin = body.spinBefore;
  }
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t a = 0; a < 3; ++a)
      std::copy_n(step.engine.previous.values(a, b), kCorners, step.simulation.state.position.values(a, b));
  }
}

void stepOnce(IslandStep& step) {
  StageClock clock(step.times);
  RigidIsland& island = rigidIslandOf(step);
  for (RigidBody& body : island.bodies) {
    updateInertia(body);
    body.moved.setZero();
    body.turned.setZero();
  }
  computeFrames(step.simulation.state.position, step.blocks, step.engine.frames);
  gatherContacts(step, island);
  clock.lap(Stage::contacts);
  const Method method = step.simulation.scene.settings.method;
  if (method == Method::rigidLcp) {
    stepRigidLcp(step, island);
  } else if (method == Method::xpbd) {
    stepXpbd(step, island);
  } else {
    stepRigidPgs(step, island);
  }
  keepForces(step, island);
  clock.lap(Stage::contacts);
  writeParticles(step);
  clock.lap(Stage::integration);
}

}  // namespace

Eigen::Matrix3d straightAxes(const CornerArray& position, std::size_t block) {
  Eigen::Matrix3d axes;
  axes.col(0) = meanEdge(position, block, 0).normalized();
  const Vec3 second = meanEdge(position, block, 1);
  axes.col(1) = (second - second.dot(axes.col(0)) * axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

RigidIsland& rigidIslandOf(IslandStep& step) {
  return step.engine.rigidIslands[static_cast<std::size_t>(step.blocks.front())];
}

void prepareRigid(Simulation& simulation) {
  const std::size_t count = simulation.model.blockCount();
  simulation.engine->rigidIslands.resize(count);
  simulation.engine->nodeOf.assign(count, 0);
}

int rigidSubsteps(const Settings& settings) {
  if (settings.substeps > 0) return settings.substeps;
  return settings.method == Method::rigidLcp ? kPivotingSubsteps : kRigidSubsteps;
}

void updateInertia(RigidBody& body) {
  const Eigen::Matrix3d axes = body.turn.toRotationMatrix();
  body.inverseInertia = axes * body.moment.cwiseInverse().asDiagonal() * axes.transpose();
}

Eigen::Quaterniond turnedBy(const Vec3& angle, const Eigen::Quaterniond& turn) {
  return (rotation(angle) * turn).normalized();
}

// The steps are long for the hand's springs, so they give way as they would at the step's end.
void applyTether(IslandStep& step) {
  Tether tether = step.simulation.tether;
  const std::size_t b = index(tether.block);
  RigidBody& body = rigidIslandOf(step).bodies[static_cast<std::size_t>(step.engine.nodeOf[b])];
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
  body.velocity += h * body.inverseMass * held.force;
  body.spin += h * (body.inverseInertia * held.torque);
}

void applyForces(IslandStep& step) {
  RigidIsland& island = rigidIslandOf(step);
  if (holdsTether(step)) applyTether(step);  // first: its dashpots would brake what gravity has not done yet
  for (RigidBody& body : island.bodies) body.velocity += step.drift_s * step.gravity;
  const std::int32_t own = step.engine.islands.islandOf[static_cast<std::size_t>(step.blocks.front())];
  for (const UserForce& user : step.simulation.scene.forces) {
    if (step.time_s < user.start_s || step.time_s >= user.end_s) continue;
    const auto b = static_cast<std::size_t>(user.block);
    if (step.engine.islands.islandOf[b] != own) continue;
    RigidBody& body = island.bodies[static_cast<std::size_t>(step.engine.nodeOf[b])];
    body.velocity += step.drift_s * body.inverseMass * user.force;
    if (user.corner < 0) continue;
    const Vec3 arm = body.turn * halfSides(step.simulation, b, static_cast<std::size_t>(user.corner));
    body.spin += step.drift_s * (body.inverseInertia * arm.cross(user.force));
  }
}

void moveFreely(RigidBody& body, double step_s) {
  body.place += step_s * body.velocity;
  const auto spinAt = [&](const Eigen::Quaterniond& turn, const Vec3& momentum) {
    return Vec3(turn * body.moment.cwiseInverse().cwiseProduct(turn.conjugate() * momentum));
  };
  const Vec3 momentum = body.turn * body.moment.cwiseProduct(body.turn.conjugate() * body.spin);
  const Vec3 middle = spinAt(rotation(0.5 * step_s * body.spin) * body.turn, momentum);
  body.turn = turnedBy(step_s * middle, body.turn);
  body.spin = spinAt(body.turn, momentum);
  body.moved += step_s * body.velocity;
  body.turned += step_s * middle;
}

IslandOutcome runRigidSteps(IslandStep& step) {
  Simulation& simulation = step.simulation;
  IslandOutcome outcome;
  outcome.substeps = rigidSubsteps(simulation.scene.settings);
  step.drift_s = simulation.scene.settings.frame_s / outcome.substeps;
  step.kick_s = step.advance_s = step.drift_s;
  readPoses(step);
  for (int substep = 0; substep < outcome.substeps && outcome.inside; ++substep) {
    step.time_s = simulation.time_s + substep * step.drift_s;
    step.gravity = simulation.scene.gravity.at(step.time_s);
    rememberStart(step);
    for (int repeat = 0;; ++repeat) {
      const std::uint64_t born = step.counters.contactsBorn;
      stepOnce(step);
      outcome.inside = updateContacts(step, renewalOfExplicitSteps(simulation));
      if (!outcome.inside || born == step.counters.contactsBorn || repeat == kMostRepeats) break;
      backToStart(step);
    }
  }
  for (const std::int32_t block : step.blocks) {
    step.engine.clock[static_cast<std::size_t>(block)].lastDrift_s = step.drift_s;
    step.engine.clock[static_cast<std::size_t>(block)].history_s = 0.0;
  }
  return outcome;
}

}  // namespace springtower
