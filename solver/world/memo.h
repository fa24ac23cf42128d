#pragma once

#include "broadphase/islands.h"
#include "broadphase/sort_and_sweep.h"
#include "broadphase/swept_boxes.h"
#include "core/scene/user_force.h"
#include "core/state.h"
#include "solver/algebra/eigen_llt.h"
#include "solver/block/affine.h"
#include "solver/law/tether.h"
#include "solver/world/by_island.h"
#include "solver/world/island_history.h"
#include "solver/world/newton_system.h"

#include <cstdint>
#include <vector>

namespace springtower {

/// Integration history of a block; that of its island is in IslandHistory.
struct BlockHistory {
  double lastExplicitStep_s = 0.0;  ///< s; the last explicit step of the block's positions; 0 after an implicit one
  double lastImplicitStep_s = 0.0;  ///< s; the implicit step from memo.previous to the present positions, 0 if there was none
  bool startKnown = false;          ///< whether memo.previous holds its start: not where it has been put back to a frame's start
  bool explicitLast = false;        ///< whether the last step was an explicit or a rigid one
  bool hasFallen = false;           ///< whether it has fallen since it slept last
  double jerk = 0.0;    ///< kg m2/s6; mass times the squared rate of change of its corners' acceleration, mean over some frames
  double motion = 0.0;  ///< kg m2/s2; mass times the squared velocity of its corners, same mean
  double travel = 0.0;  ///< m; path length of the block's fastest corner, monotonic
};

/// What explicit steps of an island found for its contacts, kept with its first block.
struct StepBound {
  double spectralRadius = 0.0;         ///< 1/s2; bound of the largest eigenvalue of its M^-1 K; 0: not yet known
  std::uint64_t contactSignature = 0;  ///< of the contacts for which it was computed
};

/// What a frame depends on beside the state that is hashed: histories, factors, clearances that persist between frames. In
/// snapshots.
struct Memo {
  SortAndSweep sweep;
  SweptBoxes boxes;                   ///< of awake blocks at the last sweep; of sleeping ones, when they fell asleep
  std::vector<double> travelAtSweep;  ///< m, [blocks]
  std::vector<double> sweepMargin;    ///< m, [blocks]: growth of the boxes for motion that contacts add
  bool prepared = false;              ///< whether the search for the equilibrium before the first frame is over
  bool swept = false;                 ///< whether the order of the sweep has been set up
  std::vector<BlockPair> sweptPairs;
  Islands islands;
  bool topologyChanged = true;               ///< whether pairs or islands differ from those of the frame before
  std::vector<std::int32_t> pairStart;       ///< pairs of island i are islandPairs[pairStart[i] .. pairStart[i + 1]]
  std::vector<std::int32_t> islandPairs;     ///< by position in engine.pairs
  std::vector<std::int32_t> blockPairStart;  ///< pairs of block b are blockPairs[blockPairStart[b] .. blockPairStart[b + 1]]
  std::vector<std::int32_t> blockPairs;
  std::vector<BlockHistory> blockHistory;    ///< [blocks]
  std::vector<IslandHistory> islandHistory;  ///< [blocks]: of the island that each block was in last
  std::vector<StepBound> stepBound;          ///< [blocks]; of explicit methods alone
  ParticleArray previous;                    ///< m, positions at the start of the step, [blocks][8]
  ParticleArray previousVelocity;            ///< m/s, at the start of the step; for implicit steps
  ParticleArray carried;                     ///< m/s, mean velocity of the last step of a multi-stage method
  ParticleArray force;                       ///< N, [blocks][8]; where forcesKnown, at the positions now
  std::vector<BlockFrame> frames;          ///< affine parts of the blocks at the stage being evaluated; of sleepers, as they lie
  std::vector<AffineField> motion;         ///< and of their velocities
  std::vector<AffineField> carriedMotion;  ///< and of the velocities that carried them, in implicit and multi-stage methods
  ByIsland<NewtonSystem> newtonSystems;    ///< not of rigid methods and the report's
  ByIsland<SparseFactors> sparseFactors;   ///< of `implicitEigen` alone
  std::vector<UserForce> forcesBefore;     ///< user forces of the frame before
  GripForce tetherForce;                   ///< the hand's, as last evaluated
};

}  // namespace springtower
