#include "solver/implicit/smoothing.h"

#include "core/tuning.h"
#include "solver/contact/create.h"
#include "solver/contact/update.h"
#include "solver/implicit/run.h"
#include "solver/world/checkpoint.h"

namespace springtower {

namespace {

// Makes contacts of the pairs that the weight may bring together.
void findAhead(IslandStep& step) {
  const double reach_m = tuning::kSmoothingReach * step.simulation.tolerance_m;
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    if (step.engine.pairs.touches(at)) continue;
    savePair(step.engine, at);
    createAhead(step, at, reach_m);
  }
}

// Mean weight of a block, N.
double meanWeight(const IslandStep& step) {
  double mass = 0.0;
  for (const std::int32_t block : step.blocks) mass += step.simulation.model.mass[static_cast<std::size_t>(block)];
  return mass * step.gravity.norm() / static_cast<double>(step.blocks.size());
}

// Contacts as they are: points that smoothed contacts had, and of their forces the friction.
void removeSmoothing(IslandStep& step) {
  step.smoothing_j = 0.0;
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    if (!step.engine.pairs.touches(at)) continue;
    const std::int32_t contact = step.engine.pairs.contact[at];
    const PointRows points = step.engine.contacts.points(contact);
    for (std::size_t r = 0; r < kManifoldRows && points[r] != nullptr; ++r) {
      PenaltyRow& row = points[r]->penalty;
      const double kept = stiffestOf(row);
      for (FourValues& along : row.displacement) {
        for (double& value : along) value *= kept;
      }
      row.stiffening.fill(1.0);
      row.restDepth.fill(0.0);
      row.touching.fill(0.0);
      row.slipRatio.fill(0.0);
    }
  }
}

// Steps that are smoothed from `first` on less and less, to at least `last`.
bool approach(IslandStep& step, double first, double last) {
  const double effective_s = tuning::kLastEquilibriumStep * step.simulation.lengths.fallTime_s;
  const double unit_j = meanWeight(step) * step.simulation.tolerance_m;
  if (!(unit_j > 0.0)) return false;
  setJacobians(step, effective_s);
  bool converged = true;
  for (double smoothing = first; converged && smoothing >= last; smoothing *= tuning::kSmoothingReduction) {
    step.smoothing_j = smoothing * unit_j;
    converged = stepFromRest(step, effective_s, StepFromRest::smoothed);
    if (!converged) break;
    stop(step);
    converged = addTravel(step);
    if (!converged) step.leftBox = true;
  }
  return converged;
}

}  // namespace

bool approachSmoothed(IslandStep& step) {
  if (beginSmoothed(step)) return finishSmoothed(step);
  removeSmoothing(step);
  return false;
}

bool beginSmoothed(IslandStep& step) {
  findAhead(step);
  return approach(step, tuning::kFirstSmoothing, tuning::kFirstSmoothing);
}

bool finishSmoothed(IslandStep& step) {
  const bool converged = approach(step, tuning::kFirstSmoothing * tuning::kSmoothingReduction, tuning::kLastSmoothing);
  removeSmoothing(step);
  return converged;
}

}  // namespace springtower
