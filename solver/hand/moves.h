#pragma once

#include "solver/hand/grip.h"
#include "solver/statics/statics.h"

#include <cstdint>
#include <vector>

namespace springtower {

// A scripted hand executes the moves of a scene, one after the other. It draws a block out along an axis at a given speed, lifts
// it clear of the tower, carries it over its new place, places or drops it, and waits until everything is at rest.

/// Result of one move.
struct MoveResult {
  BlockId block = kFloor;       ///< the block that was moved
  bool done = false;            ///< false if the block did not come free, or did not reach its place, within the time limit
  bool rested = false;          ///< whether everything was at rest at the end; otherwise the time limit of the wait was reached
  double moved_m = 0.0;         ///< largest displacement of the centre of any other block of the tower
  BlockId moved = kFloor;       ///< and that block; kFloor if there is none
  std::vector<double> each_m;   ///< the displacement of every block, [blocks]; 0 for blocks held or put aside
  Rest statics = Rest::stands;  ///< of the new set of blocks, rigid and in their nominal places
  double settlement_m = 0.0;  ///< rigid settlement of the new set beyond that of the set before, largest displacement of a centre
  double slide_m = 0.0;       ///< put: horizontal distance of the block at rest from where it was released
  double force_n = 0.0;       ///< largest force of the hand
  double begin_s = 0.0;       ///< simulated time
  double end_s = 0.0;
};

/// Whether a move succeeded: it was done, came to rest, and displaced no other block by more than its limit beyond rigid
/// settlement.
bool isWithin(const Move& move, const MoveResult& result);

/// Phases of a move.
enum class MovePhase { settle, draw, lift, carry, lower, press, still, rest };

/// A sequence of moves in progress.
struct MoveRun {
  std::vector<MoveResult> results;    ///< of the moves that have ended
  bool finished = false;              ///< the last move has ended, or one could not be done
  std::vector<std::uint8_t> leftOut;  ///< 1 for blocks held or put aside, which do not count for `standing`, [blocks]
  std::vector<std::size_t> laid;      ///< blocks in the order in which they came to rest in a new place

  std::vector<BlockSpec> rigid;  ///< the blocks as rigid ones in their nominal places; row -1 for those not in the tower
  double settled_m = 0.0;        ///< settlement of the set before this move
  MovePhase phase = MovePhase::settle;
  double phase_s = 0.0;      ///< duration of the phase so far
  Draw draw;                 ///< the hand
  Vec3 goal = Vec3::Zero();  ///< m, target of the block's centre
  Eigen::Quaterniond goalTurn = Eigen::Quaterniond::Identity();
  Vec3 place = Vec3::Zero();  ///< m, the nominal place there, level
  Eigen::Quaterniond placeTurn = Eigen::Quaterniond::Identity();
  Vec3 release = Vec3::Zero();  ///< m, position of the release
  ParticleArray before;         ///< m, at the start of the move
  MoveResult now;               ///< result of the move in progress
};

/// The sequence of a simulation's scene, before its first frame.
MoveRun beginMoves(const Simulation& simulation);

/// Before each frame: updates the phase of the move and holds the block in the coming frame.
void guideHand(MoveRun& run, Simulation& simulation);

}  // namespace springtower
