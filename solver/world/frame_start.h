#pragma once

#include "core/state.h"
#include "narrowphase/manifold.h"
#include "solver/world/memo.h"
#include "solver/world/page_pool.h"
#include "solver/world/report_state.h"

#include <array>
#include <cstdint>
#include <vector>

namespace springtower {

/// Rows of the pair table as the frame began.
struct SavedPairs {
  Column<Vec3> axis;
  Column<double> clearance;
  Column<double> travelAtCheck;
  Column<PairPhase> phase;
  void prepare(bool /*wide*/) {}
};

/// Blocks as the frame began: their corners' positions (m) and velocities (m/s).
struct SavedBlocks {
  Column<std::array<double, 3 * kCorners>> position;
  Column<std::array<double, 3 * kCorners>> velocity;
  void prepare(bool /*wide*/) {}
};

/// Where the state and the points are with which an island began the frame: in place, as at most a rejected step has touched
/// them; in the only step of the frame, which is accepted and still holds what it began with (memo.previous,
/// memo.previousVelocity, the trial points); or in a copy.
enum class FrameStartIn : std::uint8_t { state, step, copy };

/// The start of a frame, for running it again. An island at rest takes one step a frame and needs no copy of what it began with,
/// which would be most of its working space. Points of contacts are saved in their pool. Written by solver/world/checkpoint. Not
/// in snapshots.
struct FrameStart {
  std::vector<FrameStartIn> in;  ///< [islands]
  int framesWithoutCopy = 0;     ///< runs of frames since an island copied its start, up to tuning::kFramesUntilRelease
  bool returned = false;         ///< whether the memory that the first frame took for copies has been returned
  std::vector<BlockHistory> history;
  std::vector<IslandHistory> islandHistory;
  ParticleArray previousVelocity;        ///< m/s, memo.previousVelocity: at the start of the last implicit step
  std::vector<double> stepTravel;        ///< m, of each block as a rigid step began
  std::vector<std::int32_t> savedBlock;  ///< [blocks]: index of its saved row, where it is copied
  PagePool<SavedBlocks> savedBlocks;
  std::vector<std::int32_t> savedPair;  ///< by position in engine.pairs: index of its saved row, -1 if unchanged
  PagePool<SavedPairs> savedPairs;
  std::vector<std::vector<ReportContact>> reportContacts;  ///< of method `report`
};

}  // namespace springtower
