#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Adds the path of the step just taken to each block's travel. Returns false if a block has left its swept box, so that the
/// frame has to be run again with a larger one. Throws DivergenceError when a position is not finite or moved too far.
bool addTravel(IslandStep& step);

/// Before the first frame: creates the contacts of blocks that touch as placed (cubic tests without motion).
void findTouching(IslandStep& step);

/// Travel, m, of both blocks of a pair after which their manifold is refreshed if they have moved against each other: where no
/// point slips, where one does, and where none does but only one or two touch, so that one block may roll on the other.
struct RefreshTravel {
  double resting_m;
  double sliding_m;
  double rolling_m;
};
RefreshTravel refreshTravelOfExplicitSteps(const Simulation& simulation);
RefreshTravel refreshTravelOfImplicitSteps(const Simulation& simulation);

/// Updates the pairs of an island after a step: finds new contacts by the cubic tests, refreshes manifolds whose blocks have
/// moved, and releases pairs that have parted. Adds the step's path to each block's travel. Returns false if a block has left its
/// swept box, so that the frame has to be run again with a larger one. Throws DivergenceError.
bool updateContacts(IslandStep& step, const RefreshTravel& renewal);

/// The same in two parts, for steps that are repeated with the contacts found in them: findContacts after every attempt;
/// refreshContacts, for the manifolds whose blocks have moved, after the accepted one.
bool findContacts(IslandStep& step);

/// Call after a rejected step has been rolled back. Clearances that the attempt stored belong to its end pose: they are
/// recomputed at the start pose. Manifolds that it created, of blocks that had passed each other, are flagged for refresh at the
/// end of the accepted step.
void recomputeClearances(IslandStep& step);
void refreshContacts(IslandStep& step, const RefreshTravel& renewal);

}  // namespace springtower
