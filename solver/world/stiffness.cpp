#include "solver/world/stiffness.h"

#include "core/elementary.h"
#include "core/tuning.h"

#include <algorithm>
#include <cmath>

namespace springtower {

BlockStiffness stiffnessForTolerance(const LoadEstimate& loads, double tolerance_m) {
  BlockStiffness result;
  for (std::size_t b = 0; b < loads.stackOf.size(); ++b) {
    const StackLoad& stack = loads.of(b);
    const auto stiffness = [&](double load_n) { return std::max(load_n / tolerance_m, stack.sway_n_m); };
    result.stack_n_m.push_back(stiffness(stack.contact_n));
    result.floor_n_m.push_back(stiffness(stack.floor_n));
    result.loadShare.push_back(stack.mean_n > 0.0 ? std::min(1.0, loads.load_n[b] / stack.mean_n) : 1.0);
    result.edge_n_m.push_back(stiffness(stack.edge_n));
  }
  // Of equal blocks each bears at least the mean weight, but for the rounding of the mean.
  constexpr double kAll = 1.0 - 1e-12;
  if (std::all_of(result.loadShare.begin(), result.loadShare.end(), [](double share) { return share >= kAll; }))
    result.loadShare = {};
  return result;
}

namespace {

// The part of a force that can speed its block up, N: with a floor not what presses on it, nor as much as friction under the
// weight of all blocks holds.
double movingForce(const Scene& scene, double weight_n, Vec3 force) {
  if (!scene.floor) return force.norm();
  force.z() = std::max(0.0, force.z());
  return std::max(0.0, force.norm() - scene.staticFriction * weight_n);
}

// By how much the scene's forces may speed up the fastest corner of a block, m/s, if nothing is in its way. A torque turns it
// fastest about its longest side: moment of inertia m s^2 / 12 and corners 0.5 s away, s the diagonal of the two other sides.
double speedByForces(const Scene& scene, double weight_n, std::size_t b) {
  const BlockSpec& block = scene.blocks[b];
  const double diagonal_m = std::sqrt(block.dimensions.squaredNorm() - elementary::square(block.dimensions.maxCoeff()));
  double speed_m_s = 0.0;
  for (const UserForce& user : scene.forces) {
    if (static_cast<std::size_t>(user.block) != b) continue;
    const double time_s = std::max(0.0, std::min(user.end_s, scene.seconds) - user.start_s);
    const auto larger = [](double one, double other) { return std::max(one, other); };
    const double force_n =
        larger(movingForce(scene, weight_n, user.force), movingForce(scene, weight_n, user.forceAtEnd.value_or(user.force)));
    const double torque_n_m = larger(user.torque.norm(), user.torqueAtEnd.value_or(user.torque).norm());
    const double held_n_m = scene.floor ? 0.5 * scene.staticFriction * weight_n * block.dimensions.norm() : 0.0;
    speed_m_s += time_s * (force_n + 6.0 * std::max(0.0, torque_n_m - held_n_m) / diagonal_m) / block.mass;
  }
  return speed_m_s;
}

}  // namespace

void stiffenForMotion(const Scene& scene, double referenceLength_m, std::vector<double>& edge_n_m) {
  double weight_n = 0.0;
  for (const BlockSpec& block : scene.blocks) weight_n += block.fixed ? 0.0 : block.mass * scene.gravity.magnitude;
  double fastest_m_s = 0.0;
  double top_m = 0.0;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const BlockSpec& block = scene.blocks[b];
    const double radius_m = 0.5 * block.dimensions.norm();
    const double own_m_s = block.velocity.norm() + radius_m * block.spin.norm();
    fastest_m_s = std::max(fastest_m_s, own_m_s + speedByForces(scene, weight_n, b));
    top_m = std::max(top_m, block.centre.z());
  }
  const double squared = elementary::square(fastest_m_s) + (scene.floor ? 2.0 * scene.gravity.magnitude * top_m : 0.0);
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const BlockSpec& block = scene.blocks[b];
    const double strained_m = tuning::kMaxMotionStrain * block.dimensions.minCoeff();
    edge_n_m[b] =
        std::max(edge_n_m[b], 0.25 * block.mass * squared / (strained_m * tuning::kMaxMotionStrain * referenceLength_m));
  }
}

double stableStep(Method method, double spectralRadius, double dampingTime_s, double margin) {
  const double limit = 4.0 * margin * margin / spectralRadius;
  const double step = std::sqrt(dampingTime_s * dampingTime_s + limit) - dampingTime_s;
  return method == Method::midpoint ? std::min(step, margin * elementary::cbrt(4.0 * dampingTime_s / spectralRadius)) : step;
}

double stableSpectralRadius(Method method, double step_s, double dampingTime_s, double margin) {
  const double radius = 4.0 * margin * margin / (step_s * (step_s + 2.0 * dampingTime_s));
  const double step = step_s / margin;
  return method == Method::midpoint ? std::min(radius, 4.0 * dampingTime_s / (step * step * step)) : radius;
}

double impactDepth_m(const Settings& settings, double tolerance_m, double blockHeight_m) {
  const double usual_m = kBlockTolerance_m * (blockHeight_m / kBlockHeight_m);
  return settings.impactDepth * std::max(tolerance_m, usual_m);
}

}  // namespace springtower
