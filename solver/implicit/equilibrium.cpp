#include "solver/implicit/equilibrium.h"

#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/contact/approach.h"
#include "solver/contact/create.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/query.h"
#include "solver/contact/update.h"
#include "solver/implicit/run.h"
#include "solver/implicit/saved_island.h"
#include "solver/implicit/search_monitor.h"
#include "solver/implicit/smoothing.h"
#include "solver/implicit/step_count.h"
#include "solver/world/checkpoint.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace springtower {

namespace {

// Whether all blocks touch something and none moves.
bool mayRest(const IslandStep& step) {
  // By place in the island: an array for all blocks of the scene would be one for each of many islands.
  std::vector<std::uint8_t> touches(step.blocks.size(), 0);
  const auto placeOf = [&](std::int32_t block) {
    return static_cast<std::size_t>(std::lower_bound(step.blocks.begin(), step.blocks.end(), block) - step.blocks.begin());
  };
  const auto touch = [&](std::int32_t block) {
    const std::size_t place = placeOf(block);
    if (place < touches.size() && step.blocks[place] == block) touches[place] = 1;  // none that is fixed
  };
  for (const std::int32_t at : step.pairs) {
    const ContactView manifold = contactOf(step.engine, static_cast<std::size_t>(at));
    if (manifold.phase == PairPhase::separated) continue;
    touch(manifold.upper);
    touch(manifold.lower);
  }
  const ParticleArray& velocity = step.simulation.state.velocity;
  return std::all_of(step.blocks.begin(), step.blocks.end(), [&](std::int32_t block) {
    const auto b = static_cast<std::size_t>(block);
    bool still = touches[placeOf(block)] != 0;
    for (std::size_t c = 0; c < kCorners; ++c) still = still && velocity.at(b, c) == Vec3::Zero();
    return still;
  });
}

// Takes a step from rest and updates the contacts; returns the displacement of the fastest corner over the tolerance, infinity
// where the step fails, as it does where the island falls.
double advance(IslandStep& step, double effective_s, StepFromRest kind) {
  constexpr double kFailed = std::numeric_limits<double>::infinity();
  setJacobians(step, effective_s);
  if (!stepFromRest(step, effective_s, kind)) return kFailed;
  const double farthest = stop(step) / step.simulation.tolerance_m;
  const double travel_m = refreshTravel(step.simulation);
  if (updateContacts(step, {travel_m, travel_m, travel_m})) return farthest;
  step.leftBox = true;
  return kFailed;
}

double lastStep_s(const IslandStep& step) {
  return tuning::kLastEquilibriumStep * step.simulation.lengths.fallTime_s;
}

// Tells a fall from what settles, in steps from rest some of which fail. What settles is slowed by forces that come into balance,
// at the latest when it has pressed its contacts together by some tolerances; what falls goes on over more than that with the
// same acceleration, as it is in the last step before each that fails.
class FallDetector {
 public:
  void stepped(double farthest, double effective_s) {
    acceleration_ = farthest / (effective_s * effective_s);
    way_ += farthest;
  }
  // After a step that failed.
  bool fallsOn() {
    const bool alike = std::abs(acceleration_ - before_) <= tuning::kSameAcceleration * before_;
    if (!alike) way_ = 0.0;
    before_ = acceleration_;
    return way_ > tuning::kFallDistance;
  }

 private:
  double acceleration_ = 0.0;  // tolerances/s2, of the fastest corner
  double before_ = 0.0;        // likewise, before the step that failed last
  double way_ = 0.0;           // tolerances, since they are alike
};

// Steps with Coulomb's friction, from `effective_s` on longer and longer, until nothing moves in one of full length. `most`: how
// many of them may fail to converge, each of which is tried again shorter.
bool settleWithFriction(IslandStep& step, double effective_s, int most) {
  const double last_s = lastStep_s(step);
  int retries = 0;
  FallDetector detector;
  for (int i = 0; i < tuning::kMaxEquilibriumSteps && !isStopped(step.monitor); ++i) {
    const std::uint64_t failures = step.counters.newtonFailures;
    const double farthest = advance(step, effective_s, StepFromRest::coulomb);
    if (step.counters.newtonFailures != failures) {
      // What falls would with every retry come nearer to a place where it lies.
      if (++retries > (step.falls ? std::min(most, tuning::kMaxFallRetries) : most) || detector.fallsOn()) return false;
      effective_s /= tuning::kSlipStepGrowth * tuning::kSlipStepGrowth;
      continue;
    }
    if (!std::isfinite(farthest)) return false;
    detector.stepped(farthest, effective_s);
    if (effective_s >= last_s && farthest < tuning::kEquilibriumTolerance) return true;
    effective_s = std::min(last_s, tuning::kSlipStepGrowth * effective_s);
  }
  return false;
}

bool settleWithFriction(IslandStep& step, double effective_s) {
  return settleWithFriction(step, effective_s, tuning::kMaxFrictionRetries);
}

// Whether more would slip at rest than a step of full length resolves.
bool slipsMuch(IslandStep& step) {
  return slipAtRest(step, lastStep_s(step)) > tuning::kSlipResidual;
}

// All of the weight comes to bear at once, in a step of full length in which nothing slips: from two or three solutions with the
// same factors, the normal forces that it makes. False where blocks turn or slip far before they rest.
bool bearWeight(IslandStep& step) {
  return std::isfinite(advance(step, lastStep_s(step), StepFromRest::supported));
}

// Then friction is cut down to what these forces allow, unless much slips.
bool settleBorne(IslandStep& step) {
  return !slipsMuch(step) && settleWithFriction(step, lastStep_s(step));
}
bool settleAtOnce(IslandStep& step) {
  return bearWeight(step) && settleBorne(step);
}

double firstStep_s(const IslandStep& step) {
  return tuning::kFirstEquilibriumStep * step.simulation.lengths.fallTime_s;
}

// The same where much slips then, which is followed in short steps.
bool settleSlowly(IslandStep& step) {
  return bearWeight(step) && settleWithFriction(step, firstStep_s(step));
}

// From steps with smoothed contacts that are smoothed less and less, to steps with friction.
bool settleAfterSmoothing(IslandStep& step) {
  return settleWithFriction(step, slipsMuch(step) ? firstStep_s(step) : lastStep_s(step));
}
bool settleSmoothed(IslandStep& step) {
  return approachSmoothed(step) && settleAfterSmoothing(step);
}

// The search for an island's equilibrium, at any share of the tilt of gravity.
class EquilibriumSearch {
 public:
  explicit EquilibriumSearch(IslandStep& step) : step_(step), before_(step.counters), gravity_(step.simulation.scene.gravity) {}

  // Moves the island into equilibrium; false, and everything as placed, where none is found. `mayFall`: whether an island that
  // falls under tilted gravity is put into an equilibrium at nearly the largest share of the tilt at which it stands.
  bool find(bool mayFall) {
    tiltTo(1.0);
    const bool found = mayFall ? findTilted() : findUntilted();
    if (found && !isStopped(step_.monitor)) return true;
    startAgain();
    return false;
  }

 private:
  // A share of the tilt with an equilibrium near the present state.
  struct Standing {
    double share;
    SavedIsland state;
  };

  // At once, or else with smoothed contacts. These do not converge for some masses of 1 : 10,000: a light block high up sways by
  // more than the depth of its contacts while a heavy one finds its place. Without smoothing both are in place from the first
  // step.
  bool findUntilted() {
    bool bears = false;
    const auto atOnce = [&](IslandStep& step) {
      bears = bearWeight(step);
      return bears && settleBorne(step);
    };
    return settles(atOnce) || settles(settleSmoothed) || (bears && hasUnlikeLoads(step_) && settles(settleSlowly));
  }

  // From level ground, where contacts stay smoothed unless all of the weight at once does, to gravity that is tilted as far as
  // the island stands: at once, or else by halving the rise.
  bool findTilted() {
    tiltTo(0.0);
    const bool level = settles(settleAtOnce);
    if (!level && (isStopped(step_.monitor) || !beginSmoothed(step_))) return false;
    std::vector<Standing> path;
    path.push_back({0.0, SavedIsland(step_)});
    tiltTo(1.0);
    if (settleSmoothed(step_)) return true;
    path.back().state.restore(step_);
    double falls = 1.0;  // the least share at which it was found to fall
    for (int failed = 0; !isStopped(step_.monitor); ++failed) {
      if (failed <= tuning::kMaxEquilibriumRetries) halveRise(path, falls);
      const bool isLevel = path.size() == 1;
      tiltTo(path.back().share);
      if ((isLevel && level) || (finishSmoothed(step_) && settleAfterSmoothing(step_))) return true;
      if (isLevel) return false;
      falls = path.back().share;
      path.pop_back();
      path.back().state.restore(step_);
    }
    return false;
  }

  // Extends the path by shares at which the island stands, while more than tuning::kTiltGap lies between them and `falls`.
  void halveRise(std::vector<Standing>& path, double& falls) {
    while (falls - path.back().share > tuning::kTiltGap && !isStopped(step_.monitor)) {
      const double next = 0.5 * (path.back().share + falls);
      tiltTo(next);
      if (beginSmoothed(step_)) {
        path.push_back({next, SavedIsland(step_)});
      } else {
        falls = next;
        path.back().state.restore(step_);
      }
    }
  }

  void startAgain() {
    step_.smoothing_j = 0.0;
    step_.diagonalShare = 0.0F;
    restoreIsland(step_);
    for (const std::int32_t block : step_.blocks) {  // nothing has moved yet
      for (std::size_t a = 0; a < 3; ++a) {
        const auto b = static_cast<std::size_t>(block);
        std::copy_n(step_.simulation.state.position.values(a, b), kCorners, step_.engine.memo.previous.values(a, b));
      }
    }
    findTouching(step_);
    step_.counters = before_;  // they have the contacts that are found here
  }

  void tiltTo(double share) {
    Gravity gravity = gravity_;
    gravity.tilt_deg *= share;
    step_.gravity = gravity.at(step_.simulation.time_s);
  }

  // Whether the island, as placed, settles; it is left as placed where not.
  template <class Settle>
  bool settles(const Settle& settle) {
    if (!isStopped(step_.monitor) && settle(step_)) return true;
    startAgain();
    return false;
  }

  IslandStep& step_;
  Counters before_;
  Gravity gravity_;
};

// Largest distance of the island's corners from where they were placed, m.
double movedFromStart_m(const IslandStep& step) {
  double squared = 0.0;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 start = frameStartPosition(step.simulation, b, c);
      squared = std::max(squared, (step.simulation.state.position.at(b, c) - start).squaredNorm());
    }
  }
  return std::sqrt(squared);
}

// Puts the corners back to where they were placed; contacts keep what they store.
void putBack(IslandStep& step) {
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 start = frameStartPosition(step.simulation, b, c);
      step.simulation.state.position.set(b, c, start);
      step.engine.memo.previous.set(b, c, start);
    }
  }
}

bool isStrained(const IslandStep& step) {
  return std::any_of(step.blocks.begin(), step.blocks.end(), [&](std::int32_t block) {
    return step.simulation.scene.blocks[static_cast<std::size_t>(block)].strain != nullptr;
  });
}

// Whether blocks start inside one another or the floor by more than rounding.
bool overlaps(const IslandStep& step) {
  return std::any_of(step.pairs.begin(), step.pairs.end(), [&](std::int32_t pair) {
    const auto at = static_cast<std::size_t>(pair);
    if (!step.engine.pairs.touches(at)) return false;
    const ContactView manifold = contactOf(step.engine, at);
    const PointForces points = forcesNow(step.simulation, manifold);
    return std::any_of(points.depth.begin(), points.depth.begin() + manifold.count,
                       [&](double depth_m) { return depth_m > step.simulation.lengths.contactError_m; });
  });
}

// Blocks that start with the strain of a rest state lie in equilibrium, but for friction, which is not saved with them: without
// it they spread until it has come up again. From where they were placed with the friction that the last search left, the next
// one moves them by less. Stops when they hardly move, or no longer less.
void recoverFriction(IslandStep& step) {
  double moved_m = movedFromStart_m(step);
  for (int i = 0; i < tuning::kMaxEquilibriumSteps && moved_m > tuning::kEquilibriumTolerance * step.simulation.tolerance_m;
       ++i) {
    const SavedIsland found(step);
    putBack(step);
    const bool settled = settleWithFriction(step, lastStep_s(step));
    const double now_m = movedFromStart_m(step);
    if (!settled || now_m >= moved_m) {
      found.restore(step);
      return;
    }
    moved_m = now_m;
  }
}

// The contact law of what does not move: without dashpots and Maxwell branches, which only delay convergence. The branches follow
// at once, so that they are without force in the equilibrium.
ContactLaw staticLaw(ContactLaw law) {
  law.dampingTime_s = 0.0;
  law.maxwellRatio = 0.0;
  law.maxwellTime_s = std::numeric_limits<double>::min();
  return law;
}

// Separates pairs that smoothed contacts joined across a gap and that have stayed apart: as contacts without points that touch,
// they would count as hit when the blocks come near in a later step.
void dropOpenContacts(IslandStep& step) {
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    if (!step.engine.pairs.touches(at) || anyPointTouches(contactOf(step.engine, at))) continue;
    savePair(step.engine, at);
    refreshManifold(step, at, step.counters);
  }
}

// Times that differ by less than this share of a frame are the same: the end of a frame is rounded.
constexpr double kSameTime = 1e-6;

// Whether a constant force begins to act on the island at the frame's start, and all that act are constant and go on through it.
bool forcesBegin(const IslandStep& step) {
  const double frame_s = step.simulation.scene.settings.frame_s;
  const std::vector<std::int32_t>& islandOf = step.engine.memo.islands.islandOf;
  const std::int32_t own = islandOf[static_cast<std::size_t>(step.blocks.front())];
  bool begin = false;
  for (const UserForce& user : step.simulation.scene.forces) {
    if (islandOf[static_cast<std::size_t>(user.block)] != own || !user.actsWithin(step.time_s, step.time_s + frame_s)) continue;
    if (user.start_s > step.time_s || user.end_s < step.time_s + (1.0 - kSameTime) * frame_s || user.forceAtEnd ||
        user.torqueAtEnd)
      return false;
    begin = begin || user.start_s > step.time_s - 0.5 * frame_s;
  }
  return begin;
}

// Whether no corner is faster than what counts as motion.
bool isStill(const IslandStep& step) {
  const double most = quiescentSpeed(step.simulation);
  return everyBlock(step, [&](std::size_t b) { return fastestCorner(step.simulation.state.velocity, b, Vec3::Zero()) <= most; });
}

// The farthest that a corner is from where the frame began, m.
double farthestInFrame_m(const IslandStep& step) {
  return largestOfBlocks(step, [&](std::size_t b) {
    double farthest = 0.0;
    for (std::size_t c = 0; c < kCorners; ++c) {
      const Vec3 moved = step.simulation.state.position.at(b, c) - frameStartPosition(step.simulation, b, c);
      farthest = std::max(farthest, moved.norm());
    }
    return farthest;
  });
}

}  // namespace

bool followNewForces(IslandStep& step) {
  step.time_s = step.simulation.time_s;
  step.gravity = step.simulation.scene.gravity.at(step.time_s);
  if (step.modeChanged || !forcesBegin(step) || holdsTether(step) || !isStill(step)) return false;
  copyFrameStart(step);
  step.pushedFrom_s = step.time_s;
  step.pushedUntil_s = step.time_s + step.simulation.scene.settings.frame_s;
  step.pushedBefore_s = 0.0;
  const Counters before = step.counters;
  const ContactLaw law = step.law;
  step.law = staticLaw(law);
  step.maxStiffening = 1.0;
  const bool rests = settleWithFriction(step, lastStep_s(step), tuning::kMaxFallRetries) &&
                     farthestInFrame_m(step) <= tuning::kMaxForceStrain * step.simulation.tolerance_m;
  step.law = law;
  if (rests) return true;
  step.counters = before;
  restoreIsland(step);
  return false;
}

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
  EquilibriumSearch search(step);
  const bool strained = isStrained(step);
  // What lies as it did at rest is in equilibrium under all of the tilt.
  const bool restsThere = (strained || overlaps(step)) && search.find(false);
  const bool rests = restsThere || search.find(mayFall);
  if (restsThere && strained) recoverFriction(step);
  dropOpenContacts(step);
  step.diagonalShare = 0.0F;
  step.unforced = false;
  step.law = law;
  return rests;
}

}  // namespace springtower
