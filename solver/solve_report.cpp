#include "solver/report_collisions.h"
#include "solver/stage_clock.h"

#include <cmath>

namespace springtower {

namespace {

Vec3 pointVelocity(const CornerArray& velocity, std::int32_t block, const std::int8_t* corner, const double* weight,
                   std::int8_t count) {
  Vec3 sum = Vec3::Zero();
  for (std::int8_t i = 0; i < count; ++i) {
    sum += weight[i] * velocity.at(static_cast<std::size_t>(block), static_cast<std::size_t>(corner[i]));
  }
  return sum;
}

void addToCorners(CornerArray& force, std::int32_t block, const std::int8_t* corner, const double* weight, std::int8_t count,
                  const Vec3& total) {
  for (std::int8_t i = 0; i < count; ++i) {
    force.add(static_cast<std::size_t>(block), static_cast<std::size_t>(corner[i]), weight[i] * total);
  }
}

// Dynamic friction from the collisions of the step before (report 4.6 and Eq. 2.18), against the tangential velocity now, and the
// report's drag (5.7.2) for each unit of mass of the lighter particle. There is no static friction: at rest its direction is the
// noise's.
void addFriction(IslandStep& step) {
  const Simulation& simulation = step.simulation;
  const Engine& engine = step.engine;
  const std::int32_t island = engine.islands.islandOf[static_cast<std::size_t>(step.blocks.front())];
  const double drag = simulation.scene.settings.reportFrictionDrag;
  for (const std::int32_t block : step.blocks) {
    for (const ReportContact& contact : engine.report.contacts[static_cast<std::size_t>(block)]) {
      const auto moves = [&](std::int32_t b) { return b >= 0 && simulation.asleep[static_cast<std::size_t>(b)] == 0; };
      const auto elsewhere = [&](std::int32_t b) {
        return moves(b) && engine.islands.islandOf[static_cast<std::size_t>(b)] != island;
      };
      if (elsewhere(contact.first) || elsewhere(contact.second)) continue;  // they have parted since
      const std::int8_t* secondCorner = contact.corner.data() + contact.firstCount;
      const double* secondWeight = contact.weight.data() + contact.firstCount;
      Vec3 relative = pointVelocity(simulation.state.velocity, contact.first, contact.corner.data(), contact.weight.data(),
                                    contact.firstCount) -
                      pointVelocity(simulation.state.velocity, contact.second, secondCorner, secondWeight, contact.secondCount);
      relative -= relative.dot(contact.normal) * contact.normal;
      const double speed = relative.norm();
      if (speed == 0.0) continue;
      double mass = simulation.model.mass[static_cast<std::size_t>(contact.first)];
      if (contact.second >= 0) mass = std::min(mass, simulation.model.mass[static_cast<std::size_t>(contact.second)]);
      const double normalForce = contact.impulse / step.advance_s;
      const double size = simulation.scene.kineticFriction * normalForce + drag * mass / static_cast<double>(kCorners) * speed;
      const Vec3 force = -size / speed * relative;
      if (moves(contact.first)) {
        addToCorners(step.engine.force, contact.first, contact.corner.data(), contact.weight.data(), contact.firstCount, force);
      }
      if (moves(contact.second))
        addToCorners(step.engine.force, contact.second, secondCorner, secondWeight, contact.secondCount, -force);
    }
  }
}

}  // namespace

// The 2003 report's step (its Figure 5.2): springs, gravity and friction give the next velocities (Eq. 4.4), the collision loop
// corrects them, and the next state is accepted whatever is left.
void stepReport(IslandStep& step) {
  MotionState& state = step.simulation.state;
  evaluateForces(step, state, state.velocity, 0.0, false);
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
  resolveCollisions(step);
  clock.lap(Stage::cubicTests);
  moveByVelocities(step);
  clock.lap(Stage::integration);
}

}  // namespace springtower
