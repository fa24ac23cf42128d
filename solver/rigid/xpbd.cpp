#include "solver/contact/rigid_contacts.h"
#include "solver/rigid/methods.h"
#include "solver/rigid/rebound.h"
#include "solver/rigid/run.h"

#include <algorithm>

namespace springtower {

namespace {

// Applies a position impulse (N s2) to both blocks of a contact: it moves and rotates them, and changes their velocities by the
// displacement over the step.
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

// `push` (N s2) is the accumulated position impulse of the contact in this step, along each direction; `before` its normal part
// in the last step.
void solvePoint(RigidIsland& island, RigidContact& contact, std::array<double, 3>& push, double before, double step_s) {
  const double gap = contact.gap + contact.direction[0].dot(relativeMove(island, contact));
  const double normal = std::max(0.0, push[0] - contact.mass[0] * gap);
  applyCorrection(island, contact, (normal - push[0]) * contact.direction[0], step_s);
  push[0] = normal;

  // The points of a manifold share the tangential load in equal parts; otherwise the first point would take all of it and slip.
  // The remainder stays in the anchors and is corrected in the next steps.
  const std::array<double, 2> part = {contact.share * contact.mass[1], contact.share * contact.mass[2]};
  const Vec3 move = relativeMove(island, contact);
  double first = push[1] - part[0] * (contact.anchor_m[0] + move.dot(contact.direction[1]));
  double second = push[2] - part[1] * (contact.anchor_m[1] + move.dot(contact.direction[2]));
  // A point without load in this pass, but with one in the step before, keeps its friction.
  const double load = std::max(normal, before);
  boundFriction(first, second, contact.coefficient * load);
  applyCorrection(island, contact, (first - push[1]) * contact.direction[1] + (second - push[2]) * contact.direction[2], step_s);
  push[1] = first;
  push[2] = second;
}

// The anchor displacement grows by what the corrections have left over. If it exceeds what friction can hold, the point slides
// and its anchor follows. This is decided at the step's end: during the passes, before the other points are corrected, any point
// would appear to slide.
void dragAnchor(const RigidIsland& island, RigidContact& contact) {
  const Vec3 move = relativeMove(island, contact);
  for (std::size_t k = 0; k < 2; ++k) contact.anchor_m[k] += move.dot(contact.direction[k + 1]);
  const double load = std::max(contact.impulse[0], contact.loadBefore);
  const double part = contact.share * std::min(contact.mass[1], contact.mass[2]);
  const double most = contact.coefficient * load / part;
  contact.sliding = boundFriction(contact.anchor_m[0], contact.anchor_m[1], most);
  if (contact.sliding) boundFriction(contact.anchor_m[0], contact.anchor_m[1], most);  // within it in spite of rounding
}

// Speed at which the blocks of a contact parted before the step, m/s; 0 where they came nearer.
double partingBefore(const RigidIsland& island, const RigidContact& contact) {
  Vec3 relative = Vec3::Zero();
  const auto add = [&](std::int32_t at, const Vec3& arm, double sign) {
    if (at < 0) return;
    const RigidPose& before = island.bodies[static_cast<std::size_t>(at)].before;
    relative += sign * (before.velocity + before.spin.cross(arm));
  };
  add(contact.upper, contact.armUpper, 1.0);
  add(contact.lower, contact.armLower, -1.0);
  return std::max(0.0, relative.dot(contact.direction[0]));
}

// Removes velocities that the position corrections have added: the separating velocity along the normal, as far as the blocks did
// not part before, and the tangential velocity of sticking points, as far as friction can stop it.
void settleVelocity(RigidIsland& island, const RigidContact& contact) {
  if (contact.impulse[0] <= 0.0) return;
  const Vec3 relative = relativeVelocity(island, contact);
  const double parting = std::max(0.0, relative.dot(contact.direction[0]) - partingBefore(island, contact));
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
// Rigid blocks rather than particles: 28 springs a block would be 28 more constraints to iterate over, for a compression that the
// number of passes and not the springs would determine. Friction acts on the displacement from the anchor, the place where a
// point first stuck, which is kept from step to step and follows the point where it slides. With friction relative to the step's
// start only, as published, a tower drifts sideways.
void stepXpbd(IslandStep& step, RigidIsland& island) {
  const Scene& scene = step.simulation.scene;
  const double step_s = step.drift_s;
  applyForces(step);
  markTouching(island);
  for (RigidBody& body : island.bodies) moveInStep(step, body);
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
    dragAnchor(island, contact);
    for (double& impulse : contact.impulse) impulse /= step_s;
    settleVelocity(island, contact);
  }
}

}  // namespace springtower
