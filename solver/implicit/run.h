#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Step that the two-step formula puts the end's forces into, in steps.
inline constexpr double kBdf2 = 2.0 / 3.0;

/// The same for either implicit method: implicit Euler puts the end's forces into the whole step.
constexpr double endShare(Method method) {
  return traitsOf(method).twoStep ? kBdf2 : 1.0;
}

/// Sizes what method `implicit` needs: histories, factors, and each block's own matrix.
void prepareImplicit(Simulation& simulation);

/// Steps an island implicitly through the frame, as far as that fits and converges; `reached_s` is the time into the frame it
/// came to. What is left is for explicit steps. `heap`: most of its blocks have fallen, so rigid steps carry it where these do
/// not converge.
IslandOutcome runImplicitSteps(IslandStep& step, bool heap, double& reached_s);

/// One implicit step of step.drift_s. Returns false when it does not converge, or when blocks meet at speed in it; everything is
/// then as before. It gives up soon where `finerFollow`.
bool stepImplicit(IslandStep& step, bool finerFollow);

/// One step of implicit Euler from rest, of `effective_s`; a step towards static equilibrium. The contact memory ages by more
/// than that, as in stepImplicit. Returns false when it does not converge; everything is then as before.
bool stepFromRest(IslandStep& step, double effective_s);

/// The matrices of the island's blocks alone, for steps that put the end's forces into `effective_s`.
void setJacobians(IslandStep& step, double effective_s);

/// Whether implicit steps of `step_s` can follow what the island does in this frame: it touches something, nothing spins fast,
/// and nothing is about to meet at speed.
bool implicitStepsFit(const IslandStep& step, double step_s);

}  // namespace springtower
