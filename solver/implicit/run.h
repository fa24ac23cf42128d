#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Factor of the step that multiplies the forces at the end in BDF2.
inline constexpr double kBdf2 = 2.0 / 3.0;

/// The same for either kind of implicit steps: for implicit Euler it is the whole step.
constexpr double endShare(bool twoStep) {
  return twoStep ? kBdf2 : 1.0;
}

/// Sizes what method `implicit` needs: histories, factors, and each block's own matrix.
void prepareImplicit(Simulation& simulation);

/// Advances an island by implicit steps through the frame, as far as they fit and converge; `reached_s` is the time reached in
/// the frame. The rest is left to rigid steps. `mostlyFallen`: whether most of its blocks have fallen, so that rigid
/// steps follow if these do not converge.
IslandOutcome runImplicitSteps(IslandStep& step, bool mostlyFallen, double& reached_s);

/// One implicit step of step.drift_s, of step.twoStep. Returns false if it does not converge, or if blocks collide at speed in
/// it; the state is then restored. With `canRetryFiner` it stops after fewer iterations.
bool stepImplicit(IslandStep& step, bool canRetryFiner);

/// Sets the velocities to zero after a step from rest; returns the displacement of the fastest corner in it, m.
double stop(IslandStep& step);

/// How a step from rest is solved. supported: nothing slips, and the solution begins as if all points pushed. coulomb: friction
/// is bounded by the normal forces at the end. smoothed: nothing slips in the step, with the contacts of step.smoothing_j;
/// friction is cut down to its bounds before it.
enum class StepFromRest { supported, coulomb, smoothed };

/// One step of implicit Euler from rest, of `effective_s`, towards static equilibrium. Contact points advance by more than that,
/// as in stepImplicit. Returns false if it does not converge; the state is then restored.
bool stepFromRest(IslandStep& step, double effective_s, StepFromRest kind);

/// Lets points slip where they are, down to Coulomb's bound; returns the residual that this leaves in a step from rest of
/// `effective_s`, in units of tuning::kNewtonResidual. Precondition: a step from rest has ended here.
double slipAtRest(IslandStep& step, double effective_s);

/// Computes the own matrices of the island's blocks, for steps whose end forces are multiplied by `effective_s`.
void setJacobians(IslandStep& step, double effective_s);

/// Whether implicit steps of `step_s` can follow the motion of the island in this frame: it touches something, no block rotates
/// fast, and no blocks are about to collide at speed.
bool implicitStepsFit(const IslandStep& step, double step_s);

}  // namespace springtower
