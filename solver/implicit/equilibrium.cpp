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
#include <limits>
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

// Takes a step from rest and updates the contacts; returns the displacement of the fastest corner over the tolerance, infinity
// where the step fails or the island falls.
double advance(IslandStep& step, double effective_s, StepFromRest kind) {
  constexpr double kFailed = std::numeric_limits<double>::infinity();
  setJacobians(step, effective_s);
  if (!stepFromRest(step, effective_s, kind)) return kFailed;
  const double farthest = stop(step) / step.simulation.tolerance_m;
  const double travel_m = refreshTravel(step.simulation);
  const double most = tuning::kMaxEquilibriumDisplacement * step.simulation.lengths.blockHeight_m / step.simulation.tolerance_m;
  return farthest < most && updateContacts(step, {travel_m, travel_m, travel_m}) ? farthest : kFailed;
}

// Steps with Coulomb's friction that grow from `effective_s`, so that the weight comes to bear little by little.
bool settleByGrowingSteps(IslandStep& step, double effective_s, StepFromRest kind) {
  const double last_s = tuning::kLastEquilibriumStep * step.simulation.lengths.fallTime_s;
  const double growth = kind == StepFromRest::asPlaced ? tuning::kEquilibriumStepGrowth : tuning::kSlipStepGrowth;
  int retries = 0;
  for (int i = 0; i < tuning::kMaxEquilibriumSteps; ++i) {
    const std::uint64_t failures = step.counters.newtonFailures;
    const double farthest = advance(step, effective_s, kind);
    if (step.counters.newtonFailures != failures) {
      if (++retries > tuning::kMaxEquilibriumRetries) return false;
      effective_s /= growth * growth;
      continue;
    }
    retries = 0;
    if (!std::isfinite(farthest)) return false;
    if (effective_s >= last_s && farthest < tuning::kEquilibriumTolerance) return true;
    effective_s = std::min(last_s, growth * effective_s);
  }
  return false;
}

// Steps of full length with Coulomb's friction from an equilibrium nearby, until no corner moves farther than this many
// tolerances.
bool settleInFullSteps(IslandStep& step, double tolerances) {
  const double last_s = tuning::kLastEquilibriumStep * step.simulation.lengths.fallTime_s;
  for (int i = 0; i < tuning::kMaxEquilibriumSteps; ++i) {
    const double farthest = advance(step, last_s, StepFromRest::coulomb);
    if (!std::isfinite(farthest)) return false;
    if (farthest < tolerances) return true;
  }
  return false;
}

double firstStep_s(const IslandStep& step) {
  return tuning::kFirstEquilibriumStep * step.simulation.lengths.fallTime_s;
}

// The weight comes to bear as placed: row by row, from steps in which nothing moves far.
bool settleAsPlaced(IslandStep& step) {
  return settleByGrowingSteps(step, firstStep_s(step), StepFromRest::asPlaced);
}

// All of the weight comes to bear at once, in a step of full length in which nothing slips: from two or three solutions with the
// same factors, the normal forces that it makes. Then friction is cut down to what these allow. False where blocks turn or slip
// far before they rest.
bool settleAtOnce(IslandStep& step) {
  const double last_s = tuning::kLastEquilibriumStep * step.simulation.lengths.fallTime_s;
  if (!std::isfinite(advance(step, last_s, StepFromRest::supported))) return false;
  const bool slips = slipAtRest(step, last_s) > tuning::kSlipResidual;
  return settleByGrowingSteps(step, slips ? firstStep_s(step) : last_s, StepFromRest::coulomb);
}

// The search for an island's equilibrium, at any share of the tilt of gravity.
class EquilibriumSearch {
 public:
  explicit EquilibriumSearch(IslandStep& step) : step_(step), before_(step.counters), gravity_(step.simulation.scene.gravity) {}

  // Moves the island into equilibrium; false, and everything as placed, where none is found. `mayFall`: whether an island that
  // falls under tilted gravity is put into the equilibrium at nearly the largest share of the tilt at which it stands.
  bool find(bool mayFall) {
    if (settles(1.0, settleAtOnce)) return true;
    if (!mayFall) return settles(1.0, settleAsPlaced);
    if (!settles(0.0, settleAtOnce)) {
      if (settles(1.0, settleAsPlaced)) return true;
      level_ = settleAsPlaced;
      if (!settles(0.0, level_)) return false;
    }
    if (raiseTilt()) return true;
    startAgain();
    return false;
  }

 private:
  using Settle = bool (*)(IslandStep&);

  // From the equilibrium on level ground, under gravity that is tilted further and further, in steps that get shorter where one
  // fails.
  bool raiseTilt() {
    std::vector<double> path;
    double share = 0.0;
    for (double rise = tuning::kFirstTiltRise; rise > tuning::kLeastTiltRise; rise *= tuning::kTiltRiseShortening) {
      while (share < 1.0 && follows(std::min(1.0, share + rise))) {
        share = std::min(1.0, share + rise);
        path.push_back(share);
      }
      if (share == 1.0) break;
      if (!isIntact_ && !repeats(path)) return false;
    }
    tiltTo(share);
    while (!settleInFullSteps(step_, tuning::kEquilibriumTolerance)) {
      if (path.empty()) return false;
      path.pop_back();
      if (!repeats(path)) return false;
    }
    return true;
  }

  void startAgain() {
    step_.counters = before_;
    restoreIsland(step_);
    for (const std::int32_t block : step_.blocks) {  // nothing has moved yet
      for (std::size_t a = 0; a < 3; ++a) {
        const auto b = static_cast<std::size_t>(block);
        std::copy_n(step_.simulation.state.position.values(a, b), kCorners, step_.engine.memo.previous.values(a, b));
      }
    }
    findTouching(step_);
  }

  void tiltTo(double share) {
    Gravity gravity = gravity_;
    gravity.tilt_deg *= share;
    step_.gravity = gravity.at(step_.simulation.time_s);
  }

  // Whether the equilibrium at this share of the tilt is found from the present one. isIntact_: or the present one is left as it
  // was, which is so where the first step fails.
  bool follows(double share) {
    tiltTo(share);
    const Counters before = step_.counters;
    const bool found = settleInFullSteps(step_, tuning::kTiltTolerance);
    isIntact_ = found || (step_.counters.implicitSteps == before.implicitSteps &&
                          step_.counters.newtonFailures == before.newtonFailures + 1);
    return found;
  }

  // Goes to the last of these shares of the tilt again, from the blocks as placed.
  bool repeats(const std::vector<double>& path) {
    startAgain();
    return settles(0.0, level_) && std::all_of(path.begin(), path.end(), [&](double share) { return follows(share); });
  }

  // Whether the island, as placed, settles at this share of the tilt; it is left as placed where not.
  bool settles(double share, Settle settle) {
    tiltTo(share);
    if (settle(step_)) return true;
    startAgain();
    return false;
  }

  IslandStep& step_;
  Counters before_;
  Gravity gravity_;
  bool isIntact_ = true;
  Settle level_ = settleAtOnce;  // what finds the equilibrium on level ground
};

// The contact law of what does not move: without dashpots and Maxwell branches, which only delay convergence. The branches follow
// at once, so that they are without force in the equilibrium.
ContactLaw staticLaw(ContactLaw law) {
  law.dampingTime_s = 0.0;
  law.maxwellRatio = 0.0;
  law.maxwellTime_s = std::numeric_limits<double>::min();
  return law;
}

}  // namespace

bool startInEquilibrium(IslandStep& step) {
  if (!mayRest(step)) return false;
  step.maxStiffening = 1.0;
  step.unforced = true;
  const ContactLaw law = step.law;
  step.law = staticLaw(law);
  // Without the search at less than all of the tilt, the impact with which the not yet supported weight reaches the foot of a
  // tower would keep implicit steps from converging. A single block has no such impact, and explicit methods resolve it.
  const bool mayFall = step.simulation.scene.gravity.tilt_deg != 0.0 && step.blocks.size() > 1 &&
                       isImplicit(step.simulation.scene.settings.method);
  const bool rests = EquilibriumSearch(step).find(mayFall);
  step.unforced = false;
  step.law = law;
  return rests;
}

}  // namespace springtower
