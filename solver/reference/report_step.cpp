#include "solver/reference/report_step.h"

#include "solver/contact/evaluate_forces.h"
#include "solver/reference/report_collisions.h"
#include "solver/reference/report_response.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/stage_clock.h"

#include <algorithm>
#include <limits>

namespace springtower {

namespace {

void addToCorners(ParticleArray& force, const ReportSide& side, const Vec3& total) {
  for (std::size_t i = 0; i < side.corner.size(); ++i) {
    force.add(static_cast<std::size_t>(side.block), static_cast<std::size_t>(side.corner[i]), side.weight[i] * total);
  }
}

double particleMass(const BlockModel& model, const ReportContact& contact) {
  double mass = std::numeric_limits<double>::infinity();
  for (const std::int32_t block : {contact.first, contact.second}) {
    if (block >= 0 && !model.isFixed(static_cast<std::size_t>(block)))
      mass = std::min(mass, model.mass[static_cast<std::size_t>(block)]);
  }
  return mass / static_cast<double>(kCorners);
}

// Dynamic friction from the collisions of the step before (report 4.6 and Eq. 2.18), against the present tangential velocity, and
// the report's drag (5.7.2) for each unit of mass of the lighter particle. There is no static friction: at rest its direction is
// that of numerical noise.
void addFriction(IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const Engine& engine = step.engine;
  const std::int32_t island = engine.memo.islands.islandOf[static_cast<std::size_t>(step.blocks.front())];
  for (const std::int32_t block : step.blocks) {
    for (const ReportContact& contact : engine.report.contacts[static_cast<std::size_t>(block)]) {
      const ReportSide first = firstSide(contact);
      const ReportSide second = secondSide(contact);
      const auto elsewhere = [&](const ReportSide& side) {
        return moves(step, side) && engine.memo.islands.islandOf[static_cast<std::size_t>(side.block)] != island;
      };
      if (elsewhere(first) || elsewhere(second)) continue;  // they have separated since
      Vec3 relative = velocityOf(step, first) - velocityOf(step, second);
      relative -= relative.dot(contact.normal) * contact.normal;
      const double speed = relative.norm();
      if (speed == 0.0) continue;
      const double normalForce = contact.impulse / step.advance_s;
      const double size = simulation.friction.of(first.block, second.block).kineticFriction * normalForce +
                          simulation.scene.settings.reportFrictionDrag * particleMass(simulation.model, contact) * speed;
      const Vec3 force = -size / speed * relative;
      if (moves(step, first)) addToCorners(step.engine.memo.force, first, force);
      if (moves(step, second)) addToCorners(step.engine.memo.force, second, -force);
    }
  }
}

// The mean velocities of driven blocks in the step that comes, from where they are.
void startDrivenPaths(IslandStep& step) {
  if (step.driven.empty()) return;
  placeDriven(step, step.time_s, step.time_s + step.drift_s, DrivenVelocity::mean);
  for (const BlockPair& driven : step.driven) {
    const auto b = static_cast<std::size_t>(driven.b);
    for (std::size_t a = 0; a < 3; ++a)
      std::copy_n(step.engine.memo.previous.values(a, b), kCorners, step.simulation.state.position.values(a, b));
  }
}

}  // namespace

// The 2003 report's step (its Figure 5.2): springs, gravity and friction give the next velocities (Eq. 4.4), the collision loop
// corrects them, and the next state is accepted with any collisions left.
void stepReport(IslandStep& step) {
  MotionState& state = step.simulation.state;
  evaluateForces(step, state, state.velocity, 0.0, PointUpdate::discard);
  StageClock clock(step.times);
  addFriction(step);
  for (const std::int32_t block : step.blocks) step.engine.report.contacts[static_cast<std::size_t>(block)].clear();
  clock.lap(Stage::contacts);
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    double acceleration[3][kCorners];
    accelerate(step, b, acceleration);
    for (std::size_t a = 0; a < 3; ++a) {
      double* v = state.velocity.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) v[c] += step.drift_s * acceleration[a][c];
    }
  }
  clock.lap(Stage::integration);
  startDrivenPaths(step);
  resolveCollisions(step);
  clock.lap(Stage::cubicTests);
  moveByVelocities(step);
  clock.lap(Stage::integration);
}

}  // namespace springtower
