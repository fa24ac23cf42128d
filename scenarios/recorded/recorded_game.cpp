#include "scenarios/recorded/recorded_game.h"

#include <string_view>

namespace springtower {
namespace {

// The lines of game.jsonl, as the build writes them: programs have the game with them wherever they are.
constexpr std::string_view kLines[] = {
#include "scenarios/recorded/game_lines.inc"
};

// Each ends with a frame whose hash is pinned (tests/pinned). Later frames of the fall would take callgrind minutes.
constexpr GamePart kParts[] = {{"game-draw", 91, 210}, {"game-lay", 211, 520}, {"game-fall", 1094, 1100}};

}  // namespace

const Recording& recordedGame() {
  static const Recording recording = recordingOf(kLines, "the recorded game");
  return recording;
}

Scene recordedTower() {
  const Recording& game = recordedGame();
  return withTuning(sceneOf(game.choice), game.frames.front().input.tuning);
}

std::span<const GamePart> gameParts() {
  return kParts;
}

}  // namespace springtower
