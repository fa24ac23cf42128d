#include "solver/implicit/equilibrium.h"

#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/contact/create.h"
#include "solver/contact/update.h"
#include "solver/implicit/run.h"
#include "solver/world/checkpoint.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace springtower {

namespace {

// Whether all blocks touch something and none moves.
bool mayRest(const IslandStep& step) {
  std::vector<std::uint8_t> touches(step.simulation.model.blockCount(), 0);
  for (const std::int32_t at : step.pairs) {
    const ContactView manifold = contactOf(step.engine, static_cast<std::size_t>(at));
    if (manifold.phase == PairPhase::separated) continue;
    touches[static_cast<std::size_t>(manifold.upper)] = 1;
    if (manifold.lower >= 0) touches[static_cast<std::size_t>(manifold.lower)] = 1;
  }
  const ParticleArray& velocity = step.simulation.state.velocity;
  return std::all_of(step.blocks.begin(), step.blocks.end(), [&](std::int32_t block) {
    const auto b = static_cast<std::size_t>(block);
    bool still = touches[b] != 0;
    for (std::size_t c = 0; c < kCorners; ++c) still = still && velocity.at(b, c) == Vec3::Zero();
    return still;
  });
}

// Sets the velocities to zero; returns the displacement of the fastest corner in the step.
double stop(IslandStep& step) {
  MotionState& state = step.simulation.state;
  double farthest = 0.0;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t c = 0; c < kCorners; ++c) {
      farthest = std::max(farthest, (state.position.at(b, c) - step.engine.memo.previous.at(b, c)).norm());
      state.velocity.set(b, c, Vec3::Zero());
    }
    step.engine.memo.blockHistory[b].lastImplicitStep_s = 0.0;
  }
  return farthest;
}

// Steps until nothing moves any more; false if that does not happen.
bool settle(IslandStep& step) {
  const double tolerance = step.simulation.tolerance_m;
  const double fallTime_s = step.simulation.lengths.fallTime_s;
  const double travel_m = refreshTravel(step.simulation);  // blocks slide by tolerances at most here
  double effective_s = tuning::kFirstEquilibriumStep * fallTime_s;
  int retries = 0;
  for (int i = 0; i < tuning::kMaxEquilibriumSteps; ++i) {
    setJacobians(step, effective_s);
    if (!stepFromRest(step, effective_s)) {
      if (++retries > tuning::kMaxEquilibriumRetries) return false;
      effective_s /= tuning::kEquilibriumStepGrowth * tuning::kEquilibriumStepGrowth;
      continue;
    }
    retries = 0;
    const double farthest = stop(step);
    if (!(farthest < tuning::kMaxEquilibriumDisplacement * tolerance) || !updateContacts(step, {travel_m, travel_m, travel_m}))
      return false;
    if (effective_s >= tuning::kLastEquilibriumStep * fallTime_s && farthest < tuning::kEquilibriumTolerance * tolerance)
      return true;
    effective_s = std::min(tuning::kLastEquilibriumStep * fallTime_s, tuning::kEquilibriumStepGrowth * effective_s);
  }
  return false;
}

}  // namespace

bool startInEquilibrium(IslandStep& step) {
  if (!mayRest(step)) return false;
  const Counters before = step.counters;
  step.maxStiffening = 1.0;
  step.unforced = true;
  const double damping_s = step.law.dampingTime_s;
  step.law.dampingTime_s = std::min(damping_s, tuning::kMaxEquilibriumDamping * step.simulation.lengths.fallTime_s);
  Gravity gravity = step.simulation.scene.gravity;
  const double tilt_deg = gravity.tilt_deg;
  const auto startAgain = [&] {
    step.counters = before;
    restoreIsland(step);
    for (const std::int32_t block : step.blocks) {  // nothing has moved yet
      for (std::size_t a = 0; a < 3; ++a) {
        const auto b = static_cast<std::size_t>(block);
        std::copy_n(step.simulation.state.position.values(a, b), kCorners, step.engine.memo.previous.values(a, b));
      }
    }
    findTouching(step);
  };
  const auto stands = [&](double share) {
    gravity.tilt_deg = share * tilt_deg;
    step.gravity = gravity.at(step.simulation.time_s);
    if (settle(step)) return true;
    startAgain();
    return false;
  };
  bool rests = stands(1.0);
  // An island that falls under tilted gravity is put into the equilibrium at the largest tilt at which it stands. Without that,
  // the impact with which the not yet supported weight reaches the foot of a tower would keep implicit steps from converging. A
  // single block has no such impact, and explicit methods resolve it.
  if (!rests && tilt_deg != 0.0 && step.blocks.size() > 1 && isImplicit(step.simulation.scene.settings.method)) {
    double most = 0.0;
    for (double least = 1.0; least - most > tuning::kTiltBisectionWidth;) {
      const double middle = 0.5 * (least + most);
      if (stands(middle)) {
        most = middle;
        startAgain();
      } else {
        least = middle;
      }
    }
    rests = stands(most);
  }
  step.unforced = false;
  step.law.dampingTime_s = damping_s;
  return rests;
}

}  // namespace springtower
