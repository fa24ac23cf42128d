#pragma once

#include "core/state.h"
#include "narrowphase/manifold.h"
#include "solver/world/memo.h"
#include "solver/world/page_pool.h"
#include "solver/world/report_state.h"

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

/// The start of a frame, for running it again; the points of contacts are saved in their pool. Written by
/// solver/world/checkpoint. Not in snapshots.
struct FrameStart {
  MotionState state;
  std::vector<BlockHistory> history;
  std::vector<IslandHistory> islandHistory;
  ParticleArray previous;               ///< m, memo.previous: start positions of the last implicit step
  ParticleArray previousVelocity;       ///< m/s
  std::vector<double> stepTravel;       ///< m, of each block as a rigid step began
  std::vector<std::int32_t> savedPair;  ///< by position in engine.pairs: index of its saved row, -1 if unchanged
  PagePool<SavedPairs> savedPairs;
  std::vector<std::vector<ReportContact>> reportContacts;  ///< of method `report`
};

}  // namespace springtower
