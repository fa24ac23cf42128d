#pragma once

#include "solver/world/island_step.h"

namespace springtower {

/// Adds the path of the step just taken to each block's travel. Returns false when a block has left its swept box, so that the
/// frame has to be run again with a wider one. Throws DivergenceError when a position is not finite or moved too far.
bool addTravel(IslandStep& step);

/// Before the first frame: blocks that touch as they are placed get their contacts at once (cubic tests without motion).
void findTouching(IslandStep& step);

/// Path, m, of both blocks of a pair together after which their manifold is renewed: where no point slides, where one does, and
/// where none does but at most two push, so that one block may roll on the other.
struct RefreshTravel {
  double resting_m;
  double sliding_m;
  double rolling_m;
};
RefreshTravel refreshTravelOfExplicitSteps(const Simulation& simulation);
RefreshTravel refreshTravelOfImplicitSteps(const Simulation& simulation);

/// Looks after the pairs of an island once a step has moved it: finds new contacts by the cubic tests, renews manifolds whose
/// blocks have moved, and lets go of those that parted. Adds the step's path to each block's travel. Returns false when a block
/// has left its swept box, so that the frame has to be run again with a wider one. Throws DivergenceError.
bool updateContacts(IslandStep& step, const RefreshTravel& renewal);

/// The same in two parts, for steps that are taken again with the contacts found in them: what has met, as often as the step is
/// taken; then, once it stands, the manifolds whose blocks have moved.
bool findContacts(IslandStep& step);

/// Call after a rejected step has been rolled back. Clearances that the attempt stored belong to its end pose: they are
/// recomputed at the start pose. Manifolds that it created, of blocks that had passed each other, are flagged for refresh at the
/// end of the accepted step.
void recomputeClearances(IslandStep& step);
void refreshContacts(IslandStep& step, const RefreshTravel& renewal);

}  // namespace springtower
