#include "solver/metrics/balance.h"

#include "solver/law/user_force.h"

#include <algorithm>

namespace springtower {

std::vector<UserPush> userPushes(const Simulation& simulation) {
  std::vector<UserPush> pushes;
  const ParticleArray& position = simulation.state.position;
  for (const UserForce& user : simulation.scene.forces) {
    if (user.start_s >= simulation.time_s || user.end_s < simulation.time_s) continue;
    const Load now = user.at(simulation.time_s);
    const Vec3 place = placeOf(simulation.model, position, user);
    pushes.push_back({static_cast<std::size_t>(user.block), place, now.force, now.torque});
  }
  return pushes;
}

std::vector<Imbalance> imbalances(const Simulation& simulation, std::span<const ContactForce> contacts) {
  const BlockModel& model = simulation.model;
  const Vec3 gravity = simulation.scene.gravity.at(simulation.time_s);
  std::vector<Imbalance> left(model.blockCount());
  if (gravity.isZero(0.0)) return left;

  std::vector<Vec3> force;
  std::vector<Vec3> torque(model.blockCount(), Vec3::Zero());
  for (const double mass : model.mass) force.push_back(mass * gravity);
  const auto push = [&](std::size_t block, const Vec3& by, const Vec3& place) {
    force[block] += by;
    torque[block] += (place - centre(simulation.state.position, block)).cross(by);
  };
  for (const UserPush& user : userPushes(simulation)) {
    push(user.block, user.force, user.place);
    torque[user.block] += user.torque;
  }
  for (const ContactForce& contact : contacts) {
    const Vec3 by = contact.normalForce * contact.normal + contact.frictionForce;
    push(index(contact.upper), by, contact.point);
    if (contact.lower != kFloor) push(index(contact.lower), -by, contact.lowerPoint);
  }
  for (std::size_t b = 0; b < left.size(); ++b) {
    if (model.isFixed(b)) continue;
    const double weight = model.mass[b] * gravity.norm();
    left[b] = {force[b].norm() / weight, torque[b].norm() / (weight * model.dimensions[b].minCoeff())};
  }
  return left;
}

Imbalance largestImbalance(std::span<const Imbalance> imbalances) {
  Imbalance largest;
  for (const Imbalance& one : imbalances) largest = {std::max(largest.force, one.force), std::max(largest.torque, one.torque)};
  return largest;
}

double farthestOutsideCone(const Simulation& simulation, std::span<const ContactForce> contacts) {
  double farthest = 0.0;
  for (const ContactForce& contact : contacts)
    farthest = std::max(farthest, contact.frictionForce.norm() - staticFrictionOf(simulation, contact) * contact.normalForce);
  return farthest;
}

}  // namespace springtower
