#include "solver/frame/choose_method.h"

#include "core/tuning.h"
#include "solver/frame/island_modes.h"
#include "solver/world/stiffness.h"

#include <algorithm>
#include <cmath>

namespace springtower {
namespace {

// Upper bound of the speed at which blocks may collide, m/s: the largest difference of a block's velocity from the mean of all,
// or its downward speed. A single block that slides collides with nothing.
double meetingSpeed(const Scene& scene) {
  Vec3 mean = Vec3::Zero();
  for (const BlockSpec& block : scene.blocks) mean += block.velocity / static_cast<double>(scene.blocks.size());
  double speed = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    speed = std::max(speed, (block.velocity - mean).norm());
    if (scene.floor) speed = std::max(speed, -block.velocity.z());
  }
  return speed;
}

// Stiffness of the contacts of the softest stack, N/m: an impact on it has the largest stiffening.
double softestContact(const BlockStiffness& of) {
  return of.stack_n_m.empty() ? 0.0 : *std::min_element(of.stack_n_m.begin(), of.stack_n_m.end());
}

}  // namespace

Settings chooseMethod(const Scene& scene) {
  Settings settings = scene.settings;
  const LoadEstimate loads = estimateLoads(scene);
  const double tolerance_m = toleranceOf(scene);
  const double gravity = scene.gravity.magnitude;
  double mass = 0.0;
  for (const BlockSpec& block : scene.blocks) mass = std::max(mass, block.mass);
  const double depth = settings.impactDepth * tolerance_m;
  const double stiffness = softestContact(stiffnessForTolerance(loads, tolerance_m));
  const double thrown = meetingSpeed(scene);
  const double squaredSpeed = 2.0 * gravity * loads.askewFall_m + thrown * thrown;
  const double stiffening = mass * squaredSpeed / (depth * depth * stiffness);
  if (stiffening < tuning::kRigidMethodStiffening || mayEnterRigidMode(scene.blocks.size())) {
    settings.method = Method::implicit;
    return settings;
  }
  settings.method = Method::rigidPgs;
  if (settings.substeps == 0) {
    // Without gravity there is no sag; impacts are then resolved as finely as on Earth.
    const double pull = gravity > 0.0 ? gravity : kStandardGravity_m_s2;
    const double step_s = std::sqrt(tolerance_m / (tuning::kRigidSagPerLayer * pull * std::max(1, loads.layers)));
    settings.substeps = static_cast<int>(std::ceil(settings.frame_s / step_s));
  }
  return settings;
}

}  // namespace springtower
