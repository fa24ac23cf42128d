#pragma once

#include "solver/hand/grip.h"
#include "solver/statics/model.h"
#include "solver/statics/tilt_margin.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace springtower {

// The game (report 3.2): players take turns to draw a block from below the top complete row and to lay it on top; who brings
// down any other block loses. All of it is a function of the blocks' positions and the hand, frame by frame, so a replay plays
// the same game.

/// Where a move stands.
enum class Phase { choose, moving, over };

/// The state of a game. Plain values: a copy is a game that can be gone back to.
struct Game {
  int players = 0;  ///< 1 to 4; 0: no game, any block may be taken
  int player = 0;   ///< whose turn it is, from 0
  int moves = 0;    ///< blocks laid on top so far
  Phase phase = Phase::choose;
  BlockId block = kFloor;             ///< the block of this move once it has been drawn out by half its width, else kFloor
  int topRow = -1;                    ///< the top complete row when the turn began, from 0; -1: none
  double quiet_s = 0.0;               ///< how long the drawn block has lain on top, let go and with the tower at rest
  std::uint64_t turnFrame = 0;        ///< the frame in which this turn began
  std::vector<Vec3> turnCentre;       ///< m, the blocks' centres when it began
  std::vector<int> turnRow;           ///< the row each block was in when it began, or -1
  std::vector<std::uint8_t> onFloor;  ///< 1 where a block may touch the floor: it did when the game began
  BlockId held = kFloor;              ///< the last block that was held in this turn
  BlockId laid = kFloor;              ///< the block that the turn before laid on top; kFloor: the first turn
  BlockId fallen = kFloor;            ///< over: a block that touches the floor
};

/// The row a block lies in, counted from the floor, or -1 when it does not lie flat on the height of a row. Rows are found by the
/// height of the block's centre, to within a third of its height.
int rowOf(const Simulation& simulation, std::size_t block);

/// A new game on the scene as it stands.
Game newGame(const Simulation& simulation, int players, std::uint64_t frame);

/// Whether the game lets the player take hold of a block now: the block already drawn, or before that any block below the top
/// complete row. Always true without a game.
bool mayTake(const Game& game, BlockId block);

/// Follows the game through the frame that has just been stepped. Returns true when a turn ended with it: the next player's turn
/// has begun.
bool followGame(Game& game, const Simulation& simulation, BlockId held, std::uint64_t frame);

/// One line for the players: whose turn it is and what there is to do, or who lost and why. A single player builds as high as
/// may be.
std::string describe(const Game& game);

/// The block that brought the tower down: the last one that was held in the turn; where none was, the one laid on top before,
/// whose player then loses. kFloor where nothing has fallen, or nobody has touched anything.
BlockId causeOf(const Game& game);

/// The same in a sentence; empty where nothing has fallen.
std::string causeInWords(const Game& game);

/// How a block could be taken, judged from the forces.
struct Hint {
  BlockId block = kFloor;
  double drag_n = 0.0;  ///< N, friction that holds it: the coefficient times all normal forces on it
  double load_n = 0.0;  ///< N, what rests on it
  bool loose = false;   ///< as isLoose (solver/statics/loose.h) defines it
};

/// Hints for all blocks, [blocks].
std::vector<Hint> hints(const Simulation& simulation, std::span<const ContactForce> contacts);

/// A hint as the player reads it: how tight the block is, what it takes to pull it, and whether the tower stands without it
/// (empty while that is not found yet).
std::string inWords(const Hint& hint, std::optional<bool> stands);

/// The tower without a block, for statics: the other blocks as they lie and what they touch now.
struct WithoutBlock {
  StaticsModel model;
  Vec3 gravity = -Vec3::UnitZ();  ///< unit
};

/// The question. Blocks that would lean until they touch something else are not looked for: these are the present contacts. With
/// kFloor it is about all blocks. Empty when there is no gravity or no other block.
std::optional<WithoutBlock> withoutBlock(const Simulation& simulation, std::span<const ContactForce> contacts, BlockId block);

/// The answer: by how much gravity may turn towards its worst side before rigid blocks with friction cannot rest on these
/// contacts, to 0.05 degrees; negative when they cannot as it is, empty where no gravity will do. Takes some milliseconds.
std::optional<StabilityMargin> marginOf(const WithoutBlock& question);

/// The same as an angle alone, degrees; -90 where no gravity will do.
double tiltBorne(const WithoutBlock& question);

}  // namespace springtower
