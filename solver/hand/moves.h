#pragma once

#include "solver/hand/grip.h"
#include "solver/statics/statics.h"

#include <cstdint>
#include <vector>

namespace springtower {

// A scripted hand plays the moves of a scene, one after the other. It draws a block out along an axis at a stated speed, lifts it
// clear of the tower, carries it over its new place, lays it down or drops it, and waits until everything is at rest.

/// What came of one move.
struct MoveResult {
  BlockId block = kFloor;       ///< the block that was moved
  bool done = false;            ///< false: it did not come free, or did not come to its place, in a reasonable time
  bool rested = false;          ///< whether everything was at rest at the end; else the wait was given up
  double moved_m = 0.0;         ///< largest distance of the centre of any other block of the tower from where it was
  BlockId moved = kFloor;       ///< and the block it belongs to; kFloor when there is none
  std::vector<double> each_m;   ///< the same for every block, [blocks]; 0 for blocks held or put aside
  Rest statics = Rest::stands;  ///< of the new set of blocks, rigid and in their nominal places
  double settlement_m = 0.0;    ///< by how much more the centre of any of these moves while the set leans than in the set before
  double slide_m = 0.0;         ///< put: how far from where it was let go the block lies, level
  double force_n = 0.0;         ///< largest force of the hand
  double begin_s = 0.0;         ///< simulated time
  double end_s = 0.0;
};

/// Whether nothing is wrong with a move: it was done, came to rest, and shifted no other block by more than it allows beyond
/// rigid settlement.
bool isWithin(const Move& move, const MoveResult& result);

/// What the hand is doing.
enum class MovePhase { settle, draw, lift, carry, lower, press, still, rest };

/// A sequence that is being played.
struct MoveRun {
  std::vector<MoveResult> results;    ///< of the moves that have ended
  bool finished = false;              ///< the last move has ended, or one could not be done
  std::vector<std::uint8_t> leftOut;  ///< 1 for blocks held or put aside, which do not count for `standing`, [blocks]
  std::vector<std::size_t> laid;      ///< blocks in the order in which they came to rest in a new place

  std::vector<BlockSpec> rigid;  ///< the blocks as rigid ones in their nominal places; row -1 for what is not in the tower
  double settled_m = 0.0;        ///< settlement of the set before this move
  MovePhase phase = MovePhase::settle;
  double phase_s = 0.0;      ///< how long it has lasted
  Draw draw;                 ///< the hand
  Vec3 goal = Vec3::Zero();  ///< m, where it takes the block's centre
  Eigen::Quaterniond goalTurn = Eigen::Quaterniond::Identity();
  Vec3 place = Vec3::Zero();  ///< m, the nominal place there, level
  Eigen::Quaterniond placeTurn = Eigen::Quaterniond::Identity();
  Vec3 release = Vec3::Zero();  ///< m, where it let go
  ParticleArray before;         ///< m, when the move began
  MoveResult now;               ///< of the move that is being made
};

/// The sequence of a simulation's scene, before its first frame.
MoveRun beginMoves(const Simulation& simulation);

/// Before each frame: sees how far the move has come and lets the hand hold its block in the coming frame.
void guideHand(MoveRun& run, Simulation& simulation);

}  // namespace springtower
