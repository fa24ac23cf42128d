#include "solver/implicit/correction.h"

#include "core/lanes.h"
#include "core/tuning.h"
#include "solver/block/modes.h"
#include "solver/implicit/friction_tangent.h"
#include "solver/implicit/gmres.h"
#include "solver/implicit/system.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <limits>

namespace springtower {

namespace {

// Rotates the first `count` vectors into the block's frame, or back.
SPRINGTOWER_INLINE void turn(const std::array<std::array<double, 3>, 3>& axes, bool back, std::size_t count, ModeVectors& modes) {
  for (std::size_t m = 0; m < count; ++m) {
    const std::array<double, 3> from = modes[m];
    for (std::size_t i = 0; i < 3; ++i) {
      modes[m][i] = back ? axes[0][i] * from[0] + axes[1][i] * from[1] + axes[2][i] * from[2]
                         : axes[i][0] * from[0] + axes[i][1] * from[1] + axes[i][2] * from[2];
    }
  }
}

// Reduces the residuals of these nodes to their affine parts, island.affine. They are left in the blocks' frames.
SPRINGTOWER_KERNEL
void reduceResiduals(NewtonSystem& island, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    turn(island.axes[i], false, kCorners, island.residual[i]);
    ModeVectors reduced = island.residual[i];
    eliminateWarps(jacobianOf(island, i), reduced);
    turn(island.axes[i], true, kAffine, reduced);
    for (std::size_t m = 0; m < kAffine; ++m)
      std::copy(reduced[m].begin(), reduced[m].end(), island.affine.data() + kNodeSize * i + 3 * m);
  }
}

// The Newton direction of these nodes from their affine displacements; turns their residuals back into the world's frame.
SPRINGTOWER_KERNEL
void recoverDirections(NewtonSystem& island, std::size_t first, std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    ModeVectors& change = island.direction[i];
    for (std::size_t m = 0; m < kAffine; ++m) std::copy_n(island.affine.data() + kNodeSize * i + 3 * m, 3, change[m].begin());
    turn(island.axes[i], false, kAffine, change);
    recoverWarps(jacobianOf(island, i), island.residual[i], change);
    turn(island.axes[i], true, kCorners, change);
    turn(island.axes[i], true, kCorners, island.residual[i]);
  }
}

// The Newton direction; returns whether it is exact enough.
bool solveForCorrection(IslandStep& step, NewtonSystem& island, const GmresTolerance& tolerance) {
  overBlocks(step, [&](std::size_t first, std::size_t last) { reduceResiduals(island, first, last); });
  const bool reached = solveCoupled(step, island, tolerance);
  overBlocks(step, [&](std::size_t first, std::size_t last) { recoverDirections(island, first, last); });
  return reached;
}

// GMRES ends with the first solution.
constexpr GmresTolerance kPreconditionerAlone{std::numeric_limits<double>::infinity(), 0.0};

double lightest(const IslandStep& step) {
  double mass = std::numeric_limits<double>::infinity();
  for (const std::int32_t block : step.blocks) mass = std::min(mass, step.simulation.model.mass[static_cast<std::size_t>(block)]);
  return mass;
}

// Far from the solution the line search shortens the step, and the active set is another in the next iteration: a rough direction
// is enough there (inexact Newton method, Dembo, Eisenstat & Steihaug 1982).
GmresTolerance toleranceFor(const IslandStep& step, double residual) {
  const double far = tuning::kGmresToleranceGrowth * residual / tuning::kFarResidual;
  const double weight_n = lightest(step) * std::max(step.simulation.scene.gravity.magnitude, 1.0);
  return {std::clamp(far, tuning::kGmresRelativeTolerance, tuning::kMaxGmresTolerance),
          tuning::kGmresAbsoluteTolerance * tuning::kNewtonResidual * weight_n};
}

}  // namespace

double directionalDerivative(const IslandStep& step, const NewtonSystem& island) {
  return sumRanges(step.blocks.size(), tuning::kBlockGrain, isWide(step), [&](std::size_t first, std::size_t last) {
    double work = 0.0;
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t m = 0; m < kCorners; ++m) {
        for (std::size_t k = 0; k < 3; ++k) work += island.residual[i][m][k] * island.direction[i][m][k];
      }
    }
    return work;
  });
}

bool findCorrection(IslandStep& step, NewtonSystem& island, double effective_s, double residual, bool differ) {
  const GmresTolerance tolerance = toleranceFor(step, residual);
  island.tangents.clear();
  if (differ) findTangents(step, island, effective_s);
  const bool reached = solveForCorrection(step, island, tolerance);
  // With the symmetric matrix alone the derivative is always positive: with its exact solution, and with that of the
  // preconditioner where there is no other.
  const bool withoutFill = island.matrix.isWithoutFill;
  if ((!island.tangents.empty() || withoutFill) && !(directionalDerivative(step, island) > 0.0)) {
    island.tangents.clear();
    solveForCorrection(step, island, withoutFill ? kPreconditionerAlone : tolerance);
  }
  return reached;
}

}  // namespace springtower
