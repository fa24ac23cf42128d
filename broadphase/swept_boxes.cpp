#include "broadphase/swept_boxes.h"

#include "core/parallel.h"
#include "core/tuning.h"

#include <Eigen/Core>
#include <cassert>
#include <cmath>

namespace springtower {
namespace {

void sweepBoxes(const MotionState& state, std::span<const std::int32_t> blocks, double gravity, double duration_s, Way way,
                std::span<const double> margin_m, SweptBoxes& boxes, std::span<double> reach) {
  using Corners = Eigen::Map<const Eigen::Array<double, static_cast<int>(kCorners), 1>>;
  const double fall = 0.5 * gravity * duration_s * duration_s;
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    const Corners vx(state.velocity.values(0, b));
    const Corners vy(state.velocity.values(1, b));
    const Corners vz(state.velocity.values(2, b));
    double along[3] = {0.0, 0.0, 0.0};
    if (way == Way::onwards) {
      for (std::size_t a = 0; a < 3; ++a) along[a] = Corners(state.velocity.values(a, b)).mean();
    }
    const double speed = std::sqrt(((vx - along[0]).square() + (vy - along[1]).square() + (vz - along[2]).square()).maxCoeff());
    const Corners px(state.position.values(0, b));
    const Corners py(state.position.values(1, b));
    const Corners pz(state.position.values(2, b));
    // Least and largest of several values may leave out NaN, their sum does not.
    const double zeroOrNan = 0.0 * (px + py + pz + vx + vy + vz).sum();
    reach[b] = speed * duration_s + fall + margin_m[b] + zeroOrNan;
    for (std::size_t a = 0; a < 3; ++a) {
      const Corners x(state.position.values(a, b));
      boxes.lower[a][b] = x.minCoeff() + std::min(0.0, along[a]) * duration_s - reach[b];
      boxes.upper[a][b] = x.maxCoeff() + std::max(0.0, along[a]) * duration_s + reach[b];
    }
  }
}

}  // namespace

void computeSweptBoxes(const MotionState& state, std::span<const std::int32_t> blocks, double gravity, double duration_s, Way way,
                       std::span<const double> margin_m, SweptBoxes& boxes, std::span<double> reach) {
  assert(boxes.blockCount() == state.position.blockCount() && reach.size() == boxes.blockCount() &&
         margin_m.size() == boxes.blockCount());
  forRanges(blocks.size(), tuning::kBlockGrain, blocks.size() >= tuning::kParallelBlocks,
            [&](std::size_t first, std::size_t last) {
              sweepBoxes(state, blocks.subspan(first, last - first), gravity, duration_s, way, margin_m, boxes, reach);
            });
}

}  // namespace springtower
