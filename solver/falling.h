#pragma once

#include "solver/island_step.h"

namespace springtower {

// An island that falls. A tolerance is of what stands; what moves by millimetres in a frame asks for no hundredth of one.
// Contacts are as soft there as a coarse tolerance has them, and in explicit steps blocks keep the shape they have: what limits
// those steps is then an impact alone.

/// Whether the island falls: its blocks move so fast on the mean, square by mass, that they could rise by an eighth of a block's
/// height. Not while a hand or a user's force acts.
bool fallsNow(const IslandStep& step);

/// Whether an island that fell in the last frame falls on: until it is half as fast.
bool fallsOn(const IslandStep& step);

/// Makes the island's contacts those of a fall, or of a stand, and notes it in its blocks' clocks. Forces stay as they are where
/// contacts become stiff; where they become soft, depths do. Neither adds energy.
void setFalling(IslandStep& step, bool falling);

/// Reads the island's blocks from their particles. Returns the steps of a frame that they ask for as they fly and turn.
int beginFall(IslandStep& step);

/// One explicit step, semi-implicit Euler as leapfrog: contacts of the law in use, moments by the angular momentum.
void stepFall(IslandStep& step);

/// Writes the velocities of the particles.
void endFall(IslandStep& step);

/// After explicit steps of a fall: brings velocities and contact memory up to the positions, as long as the blocks keep their
/// shape. Springs that were let go over a long step would throw them.
void synchroniseFall(IslandStep& step);

/// What a fall's contacts have of the stiffness of those at rest.
double fallingScale(const Simulation& simulation);

}  // namespace springtower
