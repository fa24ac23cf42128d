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
struct RenewalTravel {
  double resting_m;
  double sliding_m;
  double rolling_m;
};
RenewalTravel renewalOfExplicitSteps(const Simulation& simulation);
RenewalTravel renewalOfImplicitSteps(const Simulation& simulation);

/// Looks after the pairs of an island once a step has moved it: finds new contacts by the cubic tests, renews manifolds whose
/// blocks have moved, and lets go of those that parted. Adds the step's path to each block's travel. Returns false when a block
/// has left its swept box, so that the frame has to be run again with a wider one. Throws DivergenceError.
bool updateContacts(IslandStep& step, const RenewalTravel& renewal);

/// The same in two parts, for steps that are taken again with the contacts found in them: what has met, as often as the step is
/// taken; then, once it stands, the manifolds whose blocks have moved.
bool findContacts(IslandStep& step);

/// Between two such attempts, when blocks and their travel are back where the step began: margins that the attempt has measured,
/// at its end, are measured again, and manifolds that it has begun, of blocks that had passed each other, are renewed where the
/// step ends.
void measureAgain(IslandStep& step);
void renewContacts(IslandStep& step, const RenewalTravel& renewal);

}  // namespace springtower
