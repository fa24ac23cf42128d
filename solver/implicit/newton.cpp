#include "core/lanes.h"
#include "core/tuning.h"
#include "solver/block/inertia.h"
#include "solver/block/modes.h"
#include "solver/contact/approach.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/contact/slip.h"
#include "solver/implicit/bdf2.h"
#include "solver/implicit/correction.h"
#include "solver/implicit/friction_tangent.h"
#include "solver/implicit/gmres.h"
#include "solver/implicit/run.h"
#include "solver/implicit/search_monitor.h"
#include "solver/implicit/smoothing.h"
#include "solver/implicit/step_count.h"
#include "solver/implicit/system.h"
#include "solver/world/checkpoint.h"
#include "solver/world/driven_blocks.h"
#include "solver/world/over_island.h"
#include "solver/world/stage_clock.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace springtower {

namespace {

// Stopping criteria of Newton's iteration, and what it linearises.
struct NewtonOptions {
  int mostContactIterations;    // while the active set changes: a load front takes one iteration a row
  double enough;                // relative tolerance, of the initial residual
  bool assumesSupport = false;  // in the first iteration all points push and stick
  double leastEnough = tuning::kNewtonTolerance;
  // Goes on while the residual gets less within so many iterations, as it does slowly with the rounded factors of tall towers; 0:
  // while the active set changes.
  int mostStalled = 0;
  double aim = std::numeric_limits<double>::infinity();          // goes on to this residual while it gets less fast
  double mostMoved_m = std::numeric_limits<double>::infinity();  // no corner moves farther: what does is falling
};

// Newton settings in motion. A share of the initial residual may remain, up to tuning::kMaxMotionResidual: a ten-thousandth of a
// weight changes a speed by 4 micrometres a second, and the next step corrects it.
const NewtonOptions kInMotion{tuning::kMaxActiveSetIterations, tuning::kRelativeResidual};
// If finer steps can follow: a step that does not converge in a few iterations converges in fewer with finer steps.
const NewtonOptions kBeforeFiner{tuning::kMaxNewtonIterations, tuning::kRelativeResidual};

NewtonSystem& islandOf(IslandStep& step) {
  return step.engine.memo.newtonSystems.of(step.blocks.front());
}

// What there is to know of the present active set.
struct ActiveSet {
  bool changed = false;  // differs from that in the factors
  bool slides = false;   // whether any point slips
  bool limited = false;  // whether the hand is at a limit of its forces
};

// Finds the present active set, island.active. Before the first iteration nothing has moved yet, so points slip as they did in
// the step before.
ActiveSet findActiveSet(const IslandStep& step, NewtonSystem& island) {
  island.active.resize(island.touching.size());
  const auto inRange = [&](std::size_t first, std::size_t last) {
    ActiveSet set;
    for (std::size_t i = first; i < last; ++i) {
      const ActiveSetBits mask = island.active[i] = activeSetBits(step, island, i);
      set.changed = set.changed || mask != island.mask[i];
      set.slides = set.slides || anySlides(mask);
    }
    return set;
  };
  ActiveSet now = mergeRanges(island.touching.size(), tuning::kPairGrain, isWide(step), ActiveSet{}, inRange,
                              [](const ActiveSet& a, const ActiveSet& b) {
                                return ActiveSet{a.changed || b.changed, a.slides || b.slides};
                              });
  now.limited = isTetherLimited(step);
  now.changed = now.changed || now.limited != island.limited;
  return now;
}

// Factorises for the present active set.
bool refactorise(IslandStep& step, NewtonSystem& island, double effective_s) {
  std::copy(island.active.begin(), island.active.end(), island.mask.begin());
  return assemble(step, island, effective_s);
}

// The residuals of these blocks, in the world's frame; returns the largest in units of kNewtonResidual, infinity where one is not
// finite.
SPRINGTOWER_KERNEL
double findResidualOf(IslandStep& step, NewtonSystem& island, double effective_s, std::size_t first, std::size_t last) {
  const Engine& engine = step.engine;
  const double gravity = std::max(step.simulation.scene.gravity.magnitude, 1.0);
  const double rate = 1.0 / (effective_s * effective_s);
  double worst = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    ModeVectors& residual = island.residual[i];
    residualForces(jacobianOf(island, i), rate, engine.memo.force, engine.scratch.freePosition, step.simulation.state.position, b,
                   residual);
    double largest = 0.0;
    for (const auto& vector : residual) {
      for (const double r : vector) {
        if (!std::isfinite(r)) return std::numeric_limits<double>::infinity();
        largest = std::max(largest, std::abs(r));
      }
    }
    worst =
        std::max(worst, largest / (tuning::kNewtonResidual * step.simulation.model.mass[b] * gravity * engine.roundingFactor[b]));
  }
  return worst;
}

double findResidual(IslandStep& step, NewtonSystem& island, double effective_s) {
  return mergeRanges(
      step.blocks.size(), tuning::kBlockGrain, isWide(step), 0.0,
      [&](std::size_t first, std::size_t last) { return findResidualOf(step, island, effective_s, first, last); },
      [](double a, double b) { return std::max(a, b); });
}

// A block's velocities at the step's end, and the affine part of its mean velocities over the step.
SPRINGTOWER_INLINE void updateVelocities(IslandStep& step, std::size_t b, double effective_s) {
  Engine& engine = step.engine;
  MotionState& state = step.simulation.state;
  const double rate = 1.0 / effective_s;
  const double stepRate = 1.0 / step.drift_s;
  AffineField& motion = engine.memo.carriedMotion[b];
  for (std::size_t a = 0; a < 3; ++a) {
    const double* x = state.position.values(a, b);
    const double* before = engine.memo.previous.values(a, b);
    const double* history = engine.scratch.pastPosition.values(a, b);
    double* v = state.velocity.values(a, b);
    double carried[kCorners];
    for (std::size_t c = 0; c < kCorners; ++c) {
      v[c] = (x[c] - history[c]) * rate;
      carried[c] = (x[c] - before[c]) * stepRate;
    }
    affineOfComponent(carried, a, motion);
  }
}

void updateAllVelocities(IslandStep& step, double effective_s) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) updateVelocities(step, static_cast<std::size_t>(step.blocks[i]), effective_s);
  });
}

SPRINGTOWER_KERNEL
void applyStepTo(IslandStep& step, const NewtonSystem& island, double share, double effective_s, std::size_t first,
                 std::size_t last) {
  for (std::size_t i = first; i < last; ++i) {
    const auto b = static_cast<std::size_t>(step.blocks[i]);
    ModeVectors part = island.direction[i];
    for (auto& vector : part) {
      for (double& d : vector) d *= share;
    }
    addModes(part, step.simulation.state.position, b);
    updateVelocities(step, b, effective_s);
  }
}

// Moves the blocks by this share of the Newton direction.
void applyStep(IslandStep& step, const NewtonSystem& island, double share, double effective_s) {
  overBlocks(step, [&](std::size_t first, std::size_t last) { applyStepTo(step, island, share, effective_s, first, last); });
}

// `swaps`: the trial points become what the points were.
SPRINGTOWER_KERNEL
void acceptPointsOf(IslandStep& step, std::span<const std::int32_t> touching, bool swaps) {
  Engine& engine = step.engine;
  for (const std::int32_t at : touching) {
    const std::int32_t contact = engine.pairs.contact[static_cast<std::size_t>(at)];
    const PointRows points = engine.contacts.points(contact);
    const PointRows trial = engine.contacts.trial(contact);
    for (std::size_t r = 0; r < kManifoldRows && points[r] != nullptr; ++r) {
      if (swaps) {
        std::swap(*points[r], *trial[r]);
      } else {
        *points[r] = *trial[r];
      }
    }
  }
}

// Of a frame's only step, the trial points hold the frame's start.
void acceptPoints(IslandStep& step, NewtonSystem& island) {
  island.trialLags = holdsFrameStart(step);
  const std::span<const std::int32_t> touching = island.touching;
  forRanges(touching.size(), tuning::kPairGrain, isWide(step), [&](std::size_t first, std::size_t last) {
    acceptPointsOf(step, touching.subspan(first, last - first), island.trialLags);
  });
}

// Where the blocks' steps are now implicit ones of this length (s).
void setLastStep(IslandStep& step, double step_s) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t block : step.blocks.subspan(first, last - first)) {
      BlockHistory& history = step.engine.memo.blockHistory[static_cast<std::size_t>(block)];
      history.lastImplicitStep_s = step_s;
      history.startKnown = true;
      history.explicitLast = false;
    }
  });
}

void accept(IslandStep& step, NewtonSystem& island) {
  acceptPoints(step, island);
  if (island.trialLags) setFrameStartHeld(step);
  setLastStep(step, step.drift_s);
  ++step.counters.implicitSteps;
}

void reject(IslandStep& step) {
  restoreStep(step);
  setLastStep(step, 0.0);
  ++step.counters.newtonFailures;
}

// Forces and residual at the present positions.
double evaluateResidual(IslandStep& step, NewtonSystem& island, double effective_s, StageClock& clock) {
  clock.lap(Stage::integration);
  evaluateTrialForces(step);
  clock.skip();  // it times itself
  return findResidual(step, island, effective_s);
}

// The least residual of a solution so far, and when it was.
struct Progress {
  double least;  // residual
  int leastAt = 0;
  int shortInRow = 0;  // iterations in succession that moved by less than kShortLineSearch of their direction
  void note(double residual, int iteration, bool isShort) {
    shortInRow = isShort ? shortInRow + 1 : 0;
    if (!(residual < least)) return;
    least = residual;
    leastAt = iteration;
  }
  // `most`: of NewtonOptions::mostStalled.
  [[nodiscard]] bool isStalled(int iteration, int most) const {
    return most > 0 && (iteration - leastAt >= most || shortInRow >= tuning::kMaxShortIterations);
  }
};

struct LineSearch {
  double residual;  // reached
  double share;     // of the Newton direction
};

// Line search (Nocedal & Wright 2006): shortens the step along the Newton direction until the directional derivative is small.
// Where contacts open or friction reverses on the way, the full step would overshoot, and the next iteration would return.
LineSearch searchLine(IslandStep& step, NewtonSystem& island, double effective_s, double enough, StageClock& clock) {
  const double work = directionalDerivative(step, island);
  island.trialIsAhead = true;
  double share = 1.0;
  applyStep(step, island, 1.0, effective_s);
  double residual = evaluateResidual(step, island, effective_s, clock);
  if (!std::isfinite(residual) || residual <= enough) return {residual, share};
  double far = directionalDerivative(step, island);
  if (far >= -tuning::kCurvatureCondition * work) return {residual, share};
  double least = 0.0;  // shares with a positive and a negative derivative
  double most = 1.0;
  double near = work;
  for (int trial = 0; trial < tuning::kMaxLineSearchSteps; ++trial) {
    const double next = least + (most - least) * std::clamp(near / (near - far), 0.1, 0.9);
    applyStep(step, island, next - share, effective_s);
    share = next;
    residual = evaluateResidual(step, island, effective_s, clock);
    const double here = directionalDerivative(step, island);
    if (std::abs(here) <= tuning::kCurvatureCondition * work || residual <= enough) break;
    (here > 0.0 ? least : most) = share;
    (here > 0.0 ? near : far) = here;
  }
  return {residual, share};
}

// Moves these blocks to the positions extrapolated from velocities and, where `accelerates`, accelerations.
void extrapolate(IslandStep& step, std::span<const std::int32_t> blocks, bool accelerates, double effective_s) {
  Engine& engine = step.engine;
  const double h = step.drift_s;
  const double ofChange = accelerates ? 0.5 : 0.0;
  for (const std::int32_t block : blocks) {
    const auto b = static_cast<std::size_t>(block);
    for (std::size_t a = 0; a < 3; ++a) {
      const double pull = effective_s * effective_s * step.gravity[static_cast<Eigen::Index>(a)];
      const double* v = engine.memo.previousVelocity.values(a, b);
      const double* history = engine.scratch.pastPosition.values(a, b);
      const double* target = engine.scratch.freePosition.values(a, b);
      double* x = step.simulation.state.position.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) {
        const double change = 3.0 * ((target[c] - pull - history[c]) / effective_s - v[c]);  // of velocity, in the last step
        x[c] += h * (v[c] + ofChange * change);
      }
    }
    updateVelocities(step, b, effective_s);
  }
}

// Moves all blocks to their extrapolated positions. Returns the residual there. Accelerations of a step with whose factors the
// points did not agree, as they changed between sticking, sliding and open, are those of blocks that stop or let go: they do not
// last.
double predict(IslandStep& step, NewtonSystem& island, double effective_s, StageClock& clock) {
  const bool accelerates = island.changedIterations <= tuning::kMaxSteadyChanges;
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    extrapolate(step, step.blocks.subspan(first, last - first), accelerates, effective_s);
  });
  island.trialIsAhead = true;
  return evaluateResidual(step, island, effective_s, clock);
}

// Initial guess when something moves: the extrapolated positions, unless those are far from the solution and the present ones
// nearer, as when contacts have just opened or closed and the history no longer applies. Returns the residual there.
double beginPredicted(IslandStep& step, NewtonSystem& island, double effective_s, StageClock& clock) {
  const double carried = predict(step, island, effective_s, clock);
  if (!(carried > tuning::kFarResidual)) return carried;
  restoreStep(step);
  updateAllVelocities(step, effective_s);
  const double still = evaluateResidual(step, island, effective_s, clock);
  return still < carried ? still : predict(step, island, effective_s, clock);
}

// Whether the step starts from the extrapolated positions without an evaluation at the present ones: all blocks have a history,
// and one moves so fast that its inertia alone exceeds the residual for that.
bool isCarried(const IslandStep& step, double effective_s) {
  const double gravity = std::max(step.simulation.scene.gravity.magnitude, 1.0);
  const double most = tuning::kPredictorResidual * tuning::kNewtonResidual * gravity * effective_s * effective_s / step.drift_s;
  bool moves = false;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    if (!(step.engine.memo.blockHistory[b].lastImplicitStep_s > 0.0)) return false;
    for (std::size_t a = 0; a < 3 && !moves; ++a) {
      const double* v = step.simulation.state.velocity.values(a, b);
      for (std::size_t c = 0; c < kCorners; ++c) moves = moves || std::abs(v[c]) > most;
    }
  }
  return moves;
}

// Keeps the blocks in place. Returns the residual there: in a wide island at rest the rounding of stiff contact forces is nearly
// as large as the tolerance, and no correction would reduce it.
double evaluateInPlace(IslandStep& step, NewtonSystem& island, double effective_s, StageClock& clock) {
  updateAllVelocities(step, effective_s);
  island.trialIsAhead = true;
  return evaluateResidual(step, island, effective_s, clock);
}

// The largest distance of a corner from where the step began, m.
double farthestMoved_m(const IslandStep& step) {
  return largestOfBlocks(step, [&](std::size_t b) {
    double farthest = 0.0;
    for (std::size_t c = 0; c < kCorners; ++c)
      farthest = std::max(farthest, (step.simulation.state.position.at(b, c) - step.engine.memo.previous.at(b, c)).squaredNorm());
    return std::sqrt(farthest);
  });
}

// What Newton's iteration begins with.
enum class Begin {
  resting,  // the present positions, or the extrapolated ones where forces are not in equilibrium
  carried,  // the extrapolated positions
  placed,   // the present positions and velocities, those of another solution of the step
};

// Places the blocks where the iteration begins. Returns the residual there.
double beginStep(IslandStep& step, NewtonSystem& island, double effective_s, Begin begin, StageClock& clock) {
  island.trialIsAhead = begin == Begin::placed;
  if (begin == Begin::placed) return evaluateResidual(step, island, effective_s, clock);
  const double residual = begin == Begin::carried ? 0.0 : findResidual(step, island, effective_s);
  if (begin == Begin::resting && !(residual > tuning::kPredictorResidual)) return residual;
  return beginPredicted(step, island, effective_s, clock);
}

// Newton's iteration for the state at the step's end, from engine.scratch.freePosition and engine.scratch.pastPosition.
// Precondition: engine.memo.force holds the forces at the present positions, if the step begins `resting`. Returns whether it
// converged.
bool solveStep(IslandStep& step, double effective_s, Begin begin, const NewtonOptions& how) {
  NewtonSystem& island = islandOf(step);
  StageClock clock(step.times);
  layOut(step, island);
  island.trialIsAhead = false;
  if (island.step_s != effective_s || tetherStiffness(step, effective_s) != island.tether) island.factorised = false;
  double residual = island.exceedsFill ? 0.0 : beginStep(step, island, effective_s, begin, clock);
  const double enough = std::clamp(how.enough * residual, how.leastEnough, std::max(how.leastEnough, tuning::kMaxMotionResidual));
  const bool wide = step.blocks.size() > tuning::kNarrowBlocks && !island.exceedsFill;
  if (wide && !island.trialIsAhead) residual = evaluateInPlace(step, island, effective_s, clock);
  bool converged = wide && residual <= std::min(tuning::kNewtonTolerance, how.aim);
  int most = island.exceedsFill || converged ? 0 : tuning::kMaxNewtonIterations;
  bool slow = false;
  Progress progress{residual};
  island.changedIterations = 0;
  for (int iteration = 0; iteration < most && !isStopped(step.monitor); ++iteration) {
    island.isNear = residual < tuning::kFarResidual;
    island.assumesSupport = iteration == 0 && how.assumesSupport;
    if (island.assumesSupport) island.factorised = false;
    const ActiveSet now = findActiveSet(step, island);
    if (now.changed && iteration > 0) ++island.changedIterations;
    if (now.changed || how.mostStalled > 0) most = std::min(how.mostContactIterations, iteration + tuning::kMaxNewtonIterations);
    const bool old =
        iteration == 0 && island.directions >= tuning::kRefactorDirectionShare * static_cast<double>(mostDirections(island));
    const bool stale = ((slow || old) && (now.changed || now.slides || now.limited)) || (step.withoutFill && now.changed);
    const bool renewed =
        stale || !island.factorised || step.smoothing_j > 0.0;  // smoothed contacts are of another stiffness each time
    if (renewed && !refactorise(step, island, effective_s)) break;
    const double before = residual;
    const bool differs = now.changed || now.slides || !island.factorTangents.empty();
    if (!findCorrection(step, island, effective_s, residual, differs) && !renewed && !step.withoutFill) {
      if (!refactorise(step, island, effective_s)) break;
      findCorrection(step, island, effective_s, residual, differs);
    }
    island.assumesSupport = false;
    const LineSearch line = searchLine(step, island, effective_s, enough, clock);
    residual = line.residual;
    // The direction is long where hardly anything resists, and its line soon meets what does (Levenberg 1944; Marquardt 1963).
    if (step.smoothing_j > 0.0 && line.share < tuning::kShortLineSearch && !hasUnlikeLoads(step)) stiffenDiagonal(step);
    slow = residual > tuning::kSlowConvergence * before;
    ++step.counters.implicitIterations;
    if (step.monitor != nullptr) step.monitor->iterationDone();
    converged = residual <= enough;
    const bool isShort = line.share < tuning::kShortLineSearch && step.smoothing_j == 0.0 && !hasUnlikeLoads(step);
    progress.note(residual, iteration, isShort);
    if (std::isfinite(how.mostMoved_m) && farthestMoved_m(step) > how.mostMoved_m) {
      step.falls = true;
      return false;
    }
    if (converged && residual > how.aim && residual < tuning::kFastConvergence * before) continue;
    const bool stalled = progress.isStalled(iteration, how.mostStalled);
    // What the rounded factors of towers of a thousand rows leave is no more than a step in motion may leave. (Between unlike
    // loads, which have an aim, so much of a heavy block is the weight of a light one.)
    converged = converged || (stalled && !std::isfinite(how.aim) && residual <= tuning::kMaxMotionResidual);
    if (converged || stalled || !std::isfinite(residual)) break;
  }
  clock.lap(Stage::integration);
  return converged;
}

// User forces act by their means over the step; where BDF2 carries a step on, so does it their means.
void setPushes(IslandStep& step) {
  step.pushedFrom_s = step.time_s;
  step.pushedUntil_s = step.time_s + step.drift_s;
  step.pushedBefore_s =
      step.twoStep ? step.engine.memo.blockHistory[static_cast<std::size_t>(step.blocks.front())].lastImplicitStep_s : 0.0;
}

// Accepts the state found, or restores the start of the step.
bool finishStep(IslandStep& step, bool taken) {
  StageClock clock(step.times);
  NewtonSystem& island = islandOf(step);
  island.forcesKnown = taken;
  if (taken) {
    accept(step, island);
  } else {
    reject(step);
    placeDriven(step, step.time_s, step.time_s);
  }
  clock.lap(Stage::integration);
  return taken;
}

}  // namespace

bool stepImplicit(IslandStep& step, bool canRetryFiner) {
  const double effective_s = endShare(step.twoStep) * step.drift_s;
  // With a driven block the step begins with the extrapolated state: forces at its start are not those that the block's motion
  // makes by its end.
  const bool drives = !step.driven.empty();
  const double end_s = step.time_s + step.drift_s;
  placeDriven(step, step.time_s, step.time_s);
  if (drives) islandOf(step).forcesKnown = false;
  setPushes(step);
  if (findSlippingContacts(step)) islandOf(step).forcesKnown = islandOf(step).factorised = false;
  const bool carried = !islandOf(step).forcesKnown && isCarried(step, effective_s);
  if (!islandOf(step).forcesKnown && !carried)
    evaluateForces(step, step.simulation.state, step.simulation.state.velocity, 0.0, PointUpdate::trial);
  step.twoStep ? predictBdf2(step, effective_s) : predictEuler(step, effective_s);
  const NewtonOptions& how = canRetryFiner ? kBeforeFiner : kInMotion;
  placeDriven(step, step.time_s, end_s);
  bool converged = solveStep(step, effective_s, carried || drives ? Begin::carried : Begin::resting, how);
  for (int trial = 0; converged && trial < tuning::kMaxNewContactSolves; ++trial) {
    StageClock clock(step.times);
    const FirstContact met = findFirstContacts(step);
    clock.lap(Stage::candidates);
    if (met == FirstContact::impact) return finishStep(step, false);
    if (met == FirstContact::none) break;
    // Only what the new contacts push away is wrong in what has been found.
    converged = solveStep(step, effective_s, Begin::placed, how);
  }
  // At the start of a frame a force or the hand may jump; that is no vibration.
  const bool jumps = step.engine.memo.islandHistory[static_cast<std::size_t>(step.blocks.front())].forced &&
                     step.time_s == step.simulation.time_s;
  if (converged && !jumps && step.twoStep) updateFrequencyEstimate(step, effective_s);
  return finishStep(step, converged);
}

bool stepFromRest(IslandStep& step, double effective_s, StepFromRest kind) {
  step.drift_s = effective_s / kBdf2;
  step.falls = false;
  if (kind == StepFromRest::smoothed)
    evaluateForces(step, step.simulation.state, step.simulation.state.velocity, 0.0, PointUpdate::store);
  step.sticks = kind == StepFromRest::supported || kind == StepFromRest::smoothed;
  evaluateForces(step, step.simulation.state, step.simulation.state.velocity, 0.0, PointUpdate::trial);
  predictEuler(step, effective_s);
  // Where nothing slips, what the rounded factors of tall towers leave gets less only slowly.
  NewtonOptions how{kind == StepFromRest::supported
                        ? std::max(tuning::kMaxActiveSetIterations, static_cast<int>(step.blocks.size()))
                        : tuning::kMaxActiveSetIterations,
                    0.0};
  // Smoothed contacts have an energy, which should get less in each iteration; the residual need not, so these have all
  // iterations.
  how.mostStalled = kind == StepFromRest::smoothed ? how.mostContactIterations : tuning::kMaxStalledIterations;
  how.mostMoved_m = tuning::kMaxEquilibriumDisplacement * step.simulation.lengths.blockHeight_m;
  how.assumesSupport = kind == StepFromRest::supported;
  // A light block rests on a heavy one by less than the tolerance of the heavy one's residual.
  if (kind == StepFromRest::coulomb && hasUnlikeLoads(step)) how.aim = tuning::kUnlikeMassesResidual;
  if (kind == StepFromRest::supported) how.leastEnough = tuning::kStickingResidual;
  if (kind == StepFromRest::smoothed) how.leastEnough = tuning::kSmoothedResidual;
  const bool converged = solveStep(step, effective_s, Begin::resting, how);
  step.sticks = false;
  return finishStep(step, converged);
}

double stop(IslandStep& step) {
  const double farthest_m = farthestMoved_m(step);
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t block : step.blocks.subspan(first, last - first)) {
      const auto b = static_cast<std::size_t>(block);
      for (std::size_t c = 0; c < kCorners; ++c) step.simulation.state.velocity.set(b, c, Vec3::Zero());
      step.engine.memo.blockHistory[b].lastImplicitStep_s = 0.0;
    }
  });
  return farthest_m;
}

double slipAtRest(IslandStep& step, double effective_s) {
  evaluateForces(step, step.simulation.state, step.simulation.state.velocity, 0.0, PointUpdate::trial);
  predictEuler(step, effective_s);
  NewtonSystem& island = islandOf(step);
  layOut(step, island);  // contacts may have been created since the step ended
  const double residual = findResidual(step, island, effective_s);
  acceptPoints(step, island);
  return residual;
}

}  // namespace springtower
