#pragma once

#include "solver/world/island_step.h"

#include <cstddef>
#include <cstdint>

namespace springtower {

// Rigid mode: an island whose blocks fall and collide is stepped as rigid bodies with sequential impulses, in the present shape
// of its blocks, until it is slow. The energy that springs would store is dissipated in the next impact anyway.

/// Whether an island of so many blocks may change to rigid mode: one thrown block or two colliding ones rebound.
bool mayEnterRigidMode(std::size_t blocks);

/// The kind of steps that advances an island through a frame, or through the rest of one.
enum class IslandMode : std::uint8_t { implicit, rigid, explicitFallback };

/// When that is decided.
enum class ModeChange : std::uint8_t { frameBegins, frameContinues, implicitFailed };

/// Inputs of that decision, as the frame begins.
struct IslandFacts {
  std::size_t blocks = 0;
  bool leftAlone = false;     ///< neither a hand nor a user force acts
  bool rigidBefore = false;   ///< rigid steps advanced one of its blocks in the last frame
  bool rigidPinned = false;   ///< rigid steps are to continue for some frames, because implicit ones failed
  bool mostlyFallen = false;  ///< more than half of its blocks have fallen since they slept last
  bool fast = false;    ///< root mean square speed, by mass, above 0.45 sqrt(g h): blocks could rise by a tenth of their height
  bool moving = false;  ///< above 0.05 sqrt(g h)
};
IslandFacts islandFacts(const IslandStep& step);

/// The transition table:
///   frame begins: rigid if left alone, of three blocks or more and fast; stays rigid while it is left alone and pinned or
///   moving;
///                 else implicit.
///   frame continues, after another part of it: rigid where a block was in the last part, else implicit.
///   implicit failed (steps do not fit or do not converge): rigid if left alone and mostly fallen, or so large that explicit
///                 steps would take seconds a frame; else explicit fallback.
IslandMode nextMode(ModeChange when, const IslandFacts& facts);

/// The only place where an island's mode is set: converts its contacts between springs and impulses, and notes in its blocks'
/// histories whether rigid steps advance them. Contact forces are unchanged, and so is the depth at which they act.
void setMode(IslandStep& step, IslandMode mode);

/// Advances an island in rigid mode through the frame from `begin_s` on. Result as of `runRigidSteps`.
IslandOutcome runRigidMode(IslandStep& step, double begin_s);

}  // namespace springtower
