#include "solver/rigid/common_motion.h"

#include "solver/rigid/impact.h"
#include "solver/rigid/packs.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace springtower {

namespace {

// Momenta of an island, about its centre of mass.
struct Momenta {
  double mass = 0.0;
  Vec3 centre = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();  // of the centre
  Vec3 angular = Vec3::Zero();
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();  // of inertia
};

Momenta momentaOf(const RigidIsland& island) {
  Momenta sum;
  for (const RigidBody& body : island.bodies) {
    if (body.inverseMass == 0.0) continue;
    sum.mass += 1.0 / body.inverseMass;
    sum.centre += body.place / body.inverseMass;
    sum.velocity += body.velocity / body.inverseMass;
  }
  sum.centre /= sum.mass;
  sum.velocity /= sum.mass;
  for (const RigidBody& body : island.bodies) {
    if (body.inverseMass == 0.0) continue;
    const Vec3 arm = body.place - sum.centre;
    const Eigen::Matrix3d own = body.axes * body.moment * body.axes.transpose();
    sum.angular += own * body.spin + arm.cross(body.velocity - sum.velocity) / body.inverseMass;
    sum.moment += own + (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose()) / body.inverseMass;
  }
  return sum;
}

}  // namespace

bool isIsolated(const RigidIsland& island) {
  const auto moves = [&](std::int32_t at) {
    return at != unmovedBody(island) && island.bodies[static_cast<std::size_t>(at)].inverseMass != 0.0;
  };
  for (const PackedPoints* packed : packsOf(island)) {
    for (const PackedPair& pair : packed->pairs) {
      for (std::size_t lane = 0; lane < kPackedPairs; ++lane) {
        if (pair.group[lane] >= 0 && !(moves(pair.upper[lane]) && moves(pair.lower[lane]))) return false;
      }
    }
  }
  return true;
}

Vec3 angularMomentum(const RigidIsland& island) {
  return momentaOf(island).angular;
}

void restoreAngularMomentum(const Vec3& momentum, RigidIsland& island) {
  const Momenta now = momentaOf(island);
  const Vec3 spin = now.moment.inverse() * (momentum - now.angular);
  for (RigidBody& body : island.bodies) {
    if (body.inverseMass == 0.0) continue;
    body.velocity += spin.cross(body.place - now.centre);
    body.spin += spin;
  }
}

void removeAddedEnergy(double added_j, RigidIsland& island) {
  if (added_j <= 0.0) return;
  const Momenta common = momentaOf(island);
  const Vec3 spin = common.moment.inverse() * common.angular;
  const double relative_j =
      kineticEnergy(island.bodies) - 0.5 * (common.mass * common.velocity.squaredNorm() + spin.dot(common.angular));
  if (!(relative_j > 0.0)) return;
  const double left = std::sqrt(std::max(0.0, 1.0 - added_j / relative_j));
  for (RigidBody& body : island.bodies) {
    if (body.inverseMass == 0.0) continue;
    const Vec3 velocity = common.velocity + spin.cross(body.place - common.centre);
    body.velocity = velocity + left * (body.velocity - velocity);
    body.spin = spin + left * (body.spin - spin);
  }
}

}  // namespace springtower
