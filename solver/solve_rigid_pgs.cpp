#include "solver/rigid_contacts.h"
#include "solver/rigid_frame.h"

#include <algorithm>
#include <numbers>

namespace springtower {

namespace {

// Contacts push back like overdamped springs of an eighth of the step's rate: firm enough to hold, and what the passes have not
// yet settled is forgotten little by little rather than kept as jitter.
constexpr double kContactRate = 0.125;  // in steps
constexpr double kDampingRatio = 10.0;  // of the critical
// Speed that blocks are pushed apart with at most, in sqrt(g h).
constexpr double kPushSpeed = 0.86;

// A soft constraint: `rate` of the gap is closed in a second, `mass` and `impulse` are the shares of the rigid answer and of the
// impulse so far.
struct Softness {
  double rate = 0.0;
  double mass = 1.0;
  double impulse = 0.0;
};

Softness softness(double step_s) {
  const double omega = 2.0 * std::numbers::pi * kContactRate / step_s;
  const double a = 2.0 * kDampingRatio + step_s * omega;
  const double b = step_s * omega * a;
  return {omega / a, b / (1.0 + b), 1.0 / (1.0 + b)};
}

// Gap of a contact as the step stands, m.
double gapNow(const RigidIsland& island, const RigidContact& contact) {
  return contact.gap + contact.direction[0].dot(relativeMove(island, contact));
}

void solveFriction(RigidIsland& island, RigidContact& contact, double kinetic) {
  const Vec3 relative = relativeVelocity(island, contact);
  double first = contact.impulse[1] - contact.mass[1] * relative.dot(contact.direction[1]);
  double second = contact.impulse[2] - contact.mass[2] * relative.dot(contact.direction[2]);
  contact.sliding = boundFriction(first, second, contact.coefficient * contact.impulse[0]);
  if (contact.sliding && contact.coefficient != kinetic) boundFriction(first, second, kinetic * contact.impulse[0]);
  const Vec3 change = (first - contact.impulse[1]) * contact.direction[1] + (second - contact.impulse[2]) * contact.direction[2];
  contact.impulse[1] = first;
  contact.impulse[2] = second;
  applyImpulse(island, contact, change);
}

// `least` is the relative velocity that the contact is to have along its normal at least, m/s.
void solveNormal(RigidIsland& island, RigidContact& contact, double least, const Softness& soft) {
  const double missing = least - relativeVelocity(island, contact).dot(contact.direction[0]);
  const double change = contact.mass[0] * soft.mass * missing - soft.impulse * contact.impulse[0];
  const double impulse = std::max(0.0, contact.impulse[0] + change);
  applyImpulse(island, contact, (impulse - contact.impulse[0]) * contact.direction[0]);
  contact.impulse[0] = impulse;
}

}  // namespace

// Sequential impulses (projected Gauss-Seidel on velocities; Catto 2005) with warm starting. Blocks that are apart may come as
// near as the gap in one step; those that overlap are pushed out softly, and a second set of passes takes the push out of the
// velocities again (soft contacts with relaxing, as in Catto's Solver2D, 2024).
void stepRigidPgs(IslandStep& step, RigidIsland& island) {
  const Scene& scene = step.simulation.scene;
  const double step_s = step.drift_s;
  const double most = kPushSpeed * step.simulation.lengths.blockHeight_m / step.simulation.lengths.fallTime_s;
  applyForces(step);
  for (const RigidContact& contact : island.contacts) {
    applyImpulse(island, contact,
                 contact.impulse[0] * contact.direction[0] + contact.impulse[1] * contact.direction[1] +
                     contact.impulse[2] * contact.direction[2]);
  }
  const Softness soft = softness(step_s);
  const Softness rigid;
  const auto passes = [&](bool push) {
    for (int pass = 0; pass < scene.settings.iterations; ++pass) {
      for (RigidContact& contact : island.contacts) {
        const double gap = push ? contact.gap : gapNow(island, contact);
        solveFriction(island, contact, scene.kineticFriction);
        if (gap > 0.0) {
          solveNormal(island, contact, -gap / step_s, rigid);
        } else if (push) {
          solveNormal(island, contact, std::min(-soft.rate * gap, most), soft);
        } else {
          solveNormal(island, contact, 0.0, rigid);
        }
      }
      step.counters.contactEvaluations += island.contacts.size();
    }
  };
  passes(true);
  for (RigidBody& body : island.bodies) moveFreely(body, step_s);
  passes(false);
}

}  // namespace springtower
