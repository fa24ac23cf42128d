#pragma once

#include "core/scene/scene.h"
#include "scenarios/recorded/recording.h"

#include <cstddef>
#include <span>
#include <string_view>

namespace springtower {

/// The recorded game (game.jsonl), which record_game.py made with a mouse that moves as a hand does, on the usual tower of 18
/// rows: two loose blocks are drawn out with pauses and ways back, lifted, carried and laid on top; then a tight one is drawn out
/// fast, and the tower falls. It has no hashes, and its tuning never changes.
const Recording& recordedGame();

/// The tower that it begins with, tuned as it was.
Scene recordedTower();

/// A part of it, whose instructions are counted (bench/gate_scenes.cpp): frames from 1, first and last.
struct GamePart {
  std::string_view name;
  std::size_t first;
  std::size_t last;
};

/// The first block is drawn out; it is lifted, carried and laid on top; the first frames of the fall.
std::span<const GamePart> gameParts();

}  // namespace springtower
