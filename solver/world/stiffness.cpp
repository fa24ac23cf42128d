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

void stiffenForMotion(const Scene& scene, double referenceLength_m, std::vector<double>& edge_n_m) {
  double fastest_m_s = 0.0;
  double top_m = 0.0;
  for (const BlockSpec& block : scene.blocks) {
    const double radius_m = 0.5 * block.dimensions.norm();
    fastest_m_s = std::max(fastest_m_s, block.velocity.norm() + radius_m * block.spin.norm());
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
