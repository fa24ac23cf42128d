#include "solver/contact/rigid_contacts.h"
#include "solver/rigid/methods.h"
#include "solver/rigid/run.h"

#include <algorithm>

namespace springtower {

namespace {

// A position impulse (N s2) on both blocks of a contact: it moves and turns them, and changes their velocities by as much a step.
void applyCorrection(RigidIsland& island, const RigidContact& contact, const Vec3& correction, double step_s) {
  const auto correct = [&](std::int32_t at, const Vec3& arm, double sign) {
    if (at < 0) return;
    RigidBody& body = island.bodies[static_cast<std::size_t>(at)];
    const Vec3 move = sign * body.inverseMass * correction;
    const Vec3 turn = sign * (body.inverseInertia * arm.cross(correction));
    body.moved += move;
    body.turned += turn;
    body.velocity += move / step_s;
    body.spin += turn / step_s;
  };
  correct(contact.upper, contact.armUpper, 1.0);
  correct(contact.lower, contact.armLower, -1.0);
}

// `push` (N s2) is what the contact has pushed in this step, along each direction; `before` its normal part in the last step.
void solvePoint(RigidIsland& island, RigidContact& contact, std::array<double, 3>& push, double before, double step_s) {
  const double gap = contact.gap + contact.direction[0].dot(relativeMove(island, contact));
  const double normal = std::max(0.0, push[0] - contact.mass[0] * gap);
  applyCorrection(island, contact, (normal - push[0]) * contact.direction[0], step_s);
  push[0] = normal;

  // The points of a manifold share the tangential load: each takes its part, or the first to be looked at would take all of it
  // and slip. What is left stays in the anchors and is made up for in the next steps.
  const std::array<double, 2> part = {contact.share * contact.mass[1], contact.share * contact.mass[2]};
  const Vec3 move = relativeMove(island, contact);
  double first = push[1] - part[0] * (contact.anchor_m[0] + move.dot(contact.direction[1]));
  double second = push[2] - part[1] * (contact.anchor_m[1] + move.dot(contact.direction[2]));
  // A point that carries nothing in this pass, but did in the step before, keeps its hold.
  const double load = std::max(normal, before);
  boundFriction(first, second, contact.coefficient * load);
  applyCorrection(island, contact, (first - push[1]) * contact.direction[1] + (second - push[2]) * contact.direction[2], step_s);
  push[1] = first;
  push[2] = second;
}

// An anchor stretches by what the corrections have left over. Where that is more than friction can hold, the point slides and its
// anchor follows. Judged at the step's end: on the way, before the other points have done their part, any point would seem to
// slide.
void dragAnchor(const RigidIsland& island, double kinetic, RigidContact& contact) {
  const Vec3 move = relativeMove(island, contact);
  for (std::size_t k = 0; k < 2; ++k) contact.anchor_m[k] += move.dot(contact.direction[k + 1]);
  const double load = std::max(contact.impulse[0], contact.loadBefore);
  const double part = contact.share * std::min(contact.mass[1], contact.mass[2]);
  contact.sliding = boundFriction(contact.anchor_m[0], contact.anchor_m[1], contact.coefficient * load / part);
  if (contact.sliding) boundFriction(contact.anchor_m[0], contact.anchor_m[1], kinetic * load / part);
}

// Corrections become velocities, but what pushed two blocks apart does not throw them, and an anchor that pulled does not swing:
// no rebound, and no speed across where the point sticks, as far as friction can stop it.
void settleVelocity(RigidIsland& island, const RigidContact& contact) {
  if (contact.impulse[0] <= 0.0) return;
  const Vec3 relative = relativeVelocity(island, contact);
  const double parting = std::max(0.0, relative.dot(contact.direction[0]));
  Vec3 impulse = -contact.mass[0] * parting * contact.direction[0];
  if (!contact.sliding) {
    double first = -contact.share * contact.mass[1] * relative.dot(contact.direction[1]);
    double second = -contact.share * contact.mass[2] * relative.dot(contact.direction[2]);
    boundFriction(first, second, contact.coefficient * contact.impulse[0]);
    impulse += first * contact.direction[1] + second * contact.direction[2];
  }
  applyImpulse(island, contact, impulse);
}

}  // namespace

// Position-based dynamics with small steps (Macklin et al. 2019; rigid bodies as in Mueller et al. 2020), without compliance.
// Rigid blocks rather than particles: 28 springs a block would be 28 more constraints to iterate over, for a compression that
// the passes and not the springs decide. Friction holds on to where a point first stuck: an anchor that is kept from step to step
// and dragged along where the point slides; held against the step's start alone, as published, a tower walks.
void stepXpbd(IslandStep& step, RigidIsland& island) {
  const Scene& scene = step.simulation.scene;
  const double step_s = step.drift_s;
  applyForces(step);
  for (RigidBody& body : island.bodies) moveFreely(body, step_s);
  for (RigidContact& contact : island.contacts) {
    contact.loadBefore = contact.impulse[0] * step_s;
    contact.impulse = {};
  }
  for (int pass = 0; pass < scene.settings.iterations; ++pass) {
    for (RigidContact& contact : island.contacts) solvePoint(island, contact, contact.impulse, contact.loadBefore, step_s);
    step.counters.contactEvaluations += island.contacts.size();
  }
  for (RigidBody& body : island.bodies) {
    body.place = body.before.place + body.moved;
    body.axes = body.before.axes;
    turnAxes(body.turned, body.axes);
  }
  for (RigidContact& contact : island.contacts) {
    dragAnchor(island, scene.kineticFriction, contact);
    for (double& impulse : contact.impulse) impulse /= step_s;
    settleVelocity(island, contact);
  }
}

}  // namespace springtower
