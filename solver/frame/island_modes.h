#pragma once

#include "solver/world/island_step.h"

#include <cstdint>

namespace springtower {

// Rigid mode: an island whose blocks fall, fly or collide is stepped as rigid bodies with sequential impulses, in the present
// shape of its blocks, until it is slow. The springs' strain follows from the forces of the last impulses when it returns.

/// The kind of steps that advances an island through a frame, or through the rest of one.
enum class IslandMode : std::uint8_t { implicit, rigid };

/// When that is decided.
enum class ModeChange : std::uint8_t { frameBegins, frameContinues };

/// Inputs of that decision, as the frame begins.
struct IslandFacts {
  bool leftAlone = false;     ///< neither a hand nor a user force acts
  bool rigidBefore = false;   ///< rigid steps advanced one of its blocks in the last frame
  bool staysRigid = false;    ///< more than half of its blocks are to stay in rigid steps: they moved, or implicit ones failed
  bool moves = false;         ///< it is faster than what rests; not looked at where it is left alone and pinned
  bool mostlyFallen = false;  ///< more than half of its blocks have fallen since they slept last
  /// Whether blocks that have more than half of the mass are faster than 0.45 sqrt(g h): they could rise by a tenth of their
  /// height. What stands on something and slides as a whole is not fast, nor is what a hand carries with the block that it holds:
  /// that is smooth.
  bool fast = false;
};
IslandFacts islandFacts(const IslandStep& step);

/// Notes in the histories of blocks which of them are as fast as what falls. Not of the block that a hand holds, which is as fast
/// as the hand.
void noteFallen(const IslandStep& step);

/// Whether an island is a stack that stands and sways, or that a hand leads: mostly not fallen, on something else, and with no
/// pair about to meet so fast that it rebounds; and not so wide that implicit steps in every frame would take seconds. Implicit
/// steps that have failed are then tried again in the next frame: rigid ones do not bring it to rest.
bool stands(const IslandStep& step, bool mostlyFallen);

/// The transition table:
///   frame begins: rigid if fast, or left alone and pinned to rigid steps; else implicit.
///   frame continues, after another part of it: rigid where a block was in the last part, else implicit.
/// Where implicit steps do not fit or do not converge, rigid ones take the rest of the frame.
IslandMode nextMode(ModeChange when, const IslandFacts& facts);

/// The only place where an island's mode is set: converts its contacts between springs and impulses, and notes in its blocks'
/// histories whether rigid steps advance them. Springs become impulses of the same forces at the same depths; these become
/// springs of the strain that rigid steps have kept, as far as their forces explain it: no more energy than there was.
void setMode(IslandStep& step, IslandMode mode);

/// Advances an island in rigid mode through the frame from `begin_s` on. `stands`: implicit steps are tried again in the next
/// frame. Result as of `runRigidSteps`.
IslandOutcome runRigidMode(IslandStep& step, double begin_s, bool stands);

}  // namespace springtower
