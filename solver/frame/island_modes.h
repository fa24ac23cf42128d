#pragma once

#include "solver/world/island_step.h"

#include <cstddef>
#include <cstdint>

namespace springtower {

// An island that falls: its blocks tumble and hit one another, and what a spring stores of that is lost in the next impact
// anyway. Rigid steps with sequential impulses carry it, in the shape that its blocks have, until it is slow.

/// Whether an island of so many blocks may fall: one block that is thrown, or two that meet, rebound, and the steps of very many
/// run on many threads.
bool mayFall(std::size_t blocks);

/// What carries an island through a frame, or through what is left of one.
enum class IslandMode : std::uint8_t { implicit, rigid, explicitFallback };

/// When that is decided.
enum class ModeChange : std::uint8_t { frameBegins, implicitGaveUp };

/// What it depends on, as the frame begins.
struct IslandFacts {
  std::size_t blocks = 0;
  bool leftAlone = false;     ///< neither a hand nor a user's force acts, and its steps do not run on many threads
  bool rigidBefore = false;   ///< rigid steps carried one of its blocks in the last frame
  bool rigidPinned = false;   ///< they are to carry it for some frames more, as implicit ones failed
  bool mostlyFallen = false;  ///< most of its blocks have fallen since they slept last
  bool fast = false;    ///< root mean square speed, by mass, above 0.45 sqrt(g h): blocks could rise by a tenth of their height
  bool moving = false;  ///< above 0.05 sqrt(g h)
};
IslandFacts islandFacts(const IslandStep& step);

/// The transition table:
///   frame begins: rigid if left alone, of 3 to 255 blocks and fast; stays rigid while it is left alone and pinned or moving;
///                 else implicit.
///   implicit gave up (steps do not fit or do not converge): rigid if left alone and mostly fallen, else explicit fallback.
IslandMode nextMode(ModeChange when, const IslandFacts& facts);

/// The only place where an island's mode is set: contacts change hands between springs and impulses, and its blocks' histories
/// note whether rigid steps carry them. Forces stay as they are, and so does the depth where they hold.
void setMode(IslandStep& step, IslandMode mode);

/// Carries an island that falls through the frame from `begin_s` on. As `runRigidSteps`.
IslandOutcome runFall(IslandStep& step, double begin_s);

}  // namespace springtower
