#include "solver/choose_method.h"

#include "solver/stiffness.h"

#include <algorithm>
#include <cmath>

namespace springtower {
namespace {

// A block that comes down askew rocks: it hits again and again, and each hit asks springs for explicit steps that grow with its
// speed. From this stiffening on, against what rest needs, rigid blocks cost less; they take a hit in the step that it falls
// into.
constexpr double kHardImpact = 4.0;
// Rigid blocks sink into one another by what gravity does in a step: this many times g dt^2 for each layer above.
constexpr double kRigidSag = 2.4;

}  // namespace

Settings chooseMethod(const Scene& scene) {
  Settings settings = scene.settings;
  const LoadEstimate loads = estimateLoads(scene);
  const double tolerance_m = toleranceOf(scene);
  const double gravity = scene.gravity.magnitude;
  double mass = 0.0;
  for (const BlockSpec& block : scene.blocks) mass = std::max(mass, block.mass);
  const double depth = settings.impactPenetration * tolerance_m;
  const double stiffness = stiffnessForTolerance(loads, tolerance_m).contact_n_m;
  const double squaredSpeed = 2.0 * gravity * loads.askewFall_m;
  const double stiffening = mass * squaredSpeed / (depth * depth * stiffness);
  if (stiffening < kHardImpact) {
    settings.method = Method::implicit;
    return settings;
  }
  settings.method = Method::rigidPgs;
  if (settings.substeps == 0) {
    const double step_s = std::sqrt(tolerance_m / (kRigidSag * gravity * std::max(1, loads.layers)));
    settings.substeps = static_cast<int>(std::ceil(settings.frame_s / step_s));
  }
  return settings;
}

}  // namespace springtower
