#include "solver/frame/choose_method.h"

#include "core/tuning.h"
#include "solver/world/stiffness.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace springtower {
namespace {

std::size_t movableBlocks(const Scene& scene) {
  return static_cast<std::size_t>(
      std::count_if(scene.blocks.begin(), scene.blocks.end(), [](const BlockSpec& block) { return !block.fixed; }));
}

// Upper bound of the speed at which blocks may collide, m/s: the largest difference of a block's velocity from the mean of all,
// or its downward speed, or, where a block is fixed, its speed. A single block that slides collides with nothing else.
double meetingSpeed(const Scene& scene) {
  Vec3 mean = Vec3::Zero();
  const std::size_t movable = movableBlocks(scene);
  const bool anyFixed = movable < scene.blocks.size();
  for (const BlockSpec& block : scene.blocks) mean += block.velocity / static_cast<double>(movable);
  double speed = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    if (block.fixed) continue;
    speed = std::max(speed, (block.velocity - mean).norm());
    if (anyFixed) speed = std::max(speed, block.velocity.norm());
    if (scene.floor) speed = std::max(speed, -block.velocity.z());
  }
  double driven = 0.0;
  for (const Drive& drive : scene.drives)
    driven = std::max(driven, drive.mostSpeed_m_s(0.5 * scene.blocks[static_cast<std::size_t>(drive.block)].dimensions.norm()));
  return speed + driven;
}

// Stiffness of the contacts of the softest stack, N/m: an impact on it has the largest stiffening.
double softestContact(const BlockStiffness& of) {
  double least = std::numeric_limits<double>::infinity();
  for (const double stiffness : of.stack_n_m) {
    if (stiffness > 0.0) least = std::min(least, stiffness);  // 0: fixed blocks
  }
  return std::isfinite(least) ? least : 0.0;
}

}  // namespace

Settings chooseMethod(const Scene& scene) {
  Settings settings = scene.settings;
  const LoadEstimate loads = estimateLoads(scene);
  const double tolerance_m = toleranceOf(scene);
  const double gravity = scene.gravity.magnitude;
  double mass = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    if (!block.fixed) mass = std::max(mass, block.mass);
  }
  const double depth = settings.impactDepth * tolerance_m;
  const double stiffness = softestContact(stiffnessForTolerance(loads, tolerance_m));
  const double thrown = meetingSpeed(scene);
  const double squaredSpeed = 2.0 * gravity * loads.askewFall_m + thrown * thrown;
  const double stiffening = mass * squaredSpeed / (depth * depth * stiffness);
  if (stiffening < tuning::kRigidMethodStiffening || movableBlocks(scene) >= tuning::kMinImplicitModeBlocks) {
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
