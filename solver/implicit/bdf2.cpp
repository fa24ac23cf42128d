#include "solver/implicit/bdf2.h"

#include "core/lanes.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/world/checkpoint.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

constexpr double kThird = 1.0 / 3.0;

SPRINGTOWER_KERNEL
void predictBdf2Of(IslandStep& step, std::span<const std::int32_t> blocks, double effective_s) {
  Engine& engine = step.engine;
  MotionState& state = step.simulation.state;
  const double h = step.drift_s;
  const double mostAcceleration = 2.0 * std::max(step.simulation.scene.gravity.magnitude, 1.0);
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    // The step before may have had another length, or its start is no longer known: its mean acceleration gives the change of
    // velocity in a step of this length.
    const double past_s = engine.memo.blockHistory[b].lastImplicitStep_s;
    const bool known = past_s > 0.0;
    const bool repeats = past_s == h && engine.memo.blockHistory[b].startKnown;
    const double share = known ? h / past_s : 0.0;
    double start[3][kCorners] = {};
    if (!known) {
      accelerate(step, b, start);
      double most = 0.0;
      for (const auto& row : start) {
        for (const double a : row) most = std::max(most, std::abs(a));
      }
      if (!(most < mostAcceleration)) std::fill_n(&start[0][0], 3 * kCorners, 0.0);
    }
    for (std::size_t a = 0; a < 3; ++a) {
      const double pull = effective_s * effective_s * step.gravity[static_cast<Eigen::Index>(a)];
      double* x = state.position.values(a, b);
      double* v = state.velocity.values(a, b);
      double* xBefore = engine.memo.previous.values(a, b);
      double* vBefore = engine.memo.previousVelocity.values(a, b);
      double* history = engine.scratch.pastPosition.values(a, b);
      double* target = engine.scratch.freePosition.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) {
        const double dv = known ? share * (v[c] - vBefore[c]) : h * start[a][c];
        const double dx = repeats ? x[c] - xBefore[c] : h * v[c] - 0.5 * h * dv;
        history[c] = x[c] + kThird * dx;
        target[c] = history[c] + effective_s * (v[c] + kThird * dv) + pull;
        xBefore[c] = x[c];
        vBefore[c] = v[c];
      }
    }
  }
}

void predictEulerOf(IslandStep& step, std::span<const std::int32_t> blocks, double effective_s) {
  Engine& engine = step.engine;
  const MotionState& state = step.simulation.state;
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t a = 0; a < 3; ++a) {
      const double pull = effective_s * effective_s * step.gravity[static_cast<Eigen::Index>(a)];
      const double* x = state.position.values(a, b);
      const double* v = state.velocity.values(a, b);
      double* target = engine.scratch.freePosition.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) target[c] = x[c] + effective_s * v[c] + pull;
      std::copy_n(x, kCorners, engine.scratch.pastPosition.values(a, b));
      std::copy_n(x, kCorners, engine.memo.previous.values(a, b));
      std::copy_n(v, kCorners, engine.memo.previousVelocity.values(a, b));
    }
  }
}

}  // namespace

void predictBdf2(IslandStep& step, double effective_s) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    predictBdf2Of(step, step.blocks.subspan(first, last - first), effective_s);
  });
}

void predictEuler(IslandStep& step, double effective_s) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    predictEulerOf(step, step.blocks.subspan(first, last - first), effective_s);
  });
}

}  // namespace springtower
