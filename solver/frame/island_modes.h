#pragma once

#include "solver/world/island_step.h"

#include <cstddef>

namespace springtower {

// An island that falls: its blocks tumble and hit one another, and what a spring stores of that is lost in the next impact
// anyway. Rigid steps with sequential impulses carry it, in the shape that its blocks have, until it is slow.

/// Whether an island of so many blocks may fall: one block that is thrown, or two that meet, rebound, and the steps of very many
/// run on many threads.
bool mayFall(std::size_t blocks);

/// Whether the island falls: three blocks or more move so fast on the mean, square by mass, that they could rise by a tenth of
/// a block's height; or they fell in the last frame and are not slow yet. Not while a hand or a user's force acts, nor where the
/// island is so large that its steps run on many threads.
bool falls(const IslandStep& step);

/// Whether most of the island's blocks have fallen since they slept last: rigid steps carry it where implicit ones do not do.
bool mostlyFallen(const IslandStep& step);

/// Makes the points of the island's contacts remember what rigid steps do, or what springs do, and notes in its blocks' clocks
/// whether they fall. Forces stay as they are, and so does the depth where they hold.
void setFalling(IslandStep& step, bool falling);

/// Carries an island that falls through the frame from `begin_s` on. As `runRigidSteps`.
IslandOutcome runFall(IslandStep& step, double begin_s);

}  // namespace springtower
