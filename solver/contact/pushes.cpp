#include "solver/contact/pushes.h"

#include "core/tuning.h"
#include "solver/law/user_force.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

// All that pushes an island.
struct PushSum {
  Vec3 force = Vec3::Zero();   // N
  Vec3 moment = Vec3::Zero();  // N m, about the centre of the island's first block
  double forces = 0.0;         // N, sizes
  double moments = 0.0;        // N m, sizes
};

PushSum pushesOver(const IslandStep& step, double from_s, double until_s) {
  const ParticleArray& position = step.simulation.state.position;
  const Vec3 middle = centre(position, static_cast<std::size_t>(step.blocks.front()));
  PushSum sum;
  forEachPush(step, from_s, until_s, [&](const UserForce& user, const Load& mean) {
    const Vec3 arm = placeOf(step.simulation.model, position, user) - middle;
    const Vec3 moment = arm.cross(mean.force) + mean.torque;
    sum.force += mean.force;
    sum.moment += moment;
    sum.forces += mean.force.norm();
    sum.moments += moment.norm();
  });
  return sum;
}

bool differs(const Vec3& change, double before, double now) {
  return change.norm() + std::abs(now - before) > tuning::kPushJump * std::max(before, now);
}

}  // namespace

bool pushesJump(const IslandStep& step, double before_s, double step_s) {
  if (step.unforced || (step.simulation.scene.forces.empty() && step.engine.memo.forcesBefore.empty())) return false;
  const PushSum now = pushesOver(step, step.time_s, step.time_s + step_s);
  if (!(before_s > 0.0)) return now.forces > 0.0 || now.moments > 0.0;
  const PushSum before = pushesOver(step, step.time_s - before_s, step.time_s);
  return differs(now.force - before.force, before.forces, now.forces) ||
         differs(now.moment - before.moment, before.moments, now.moments);
}

}  // namespace springtower
