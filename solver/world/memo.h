#pragma once

#include "broadphase/islands.h"
#include "broadphase/sort_and_sweep.h"
#include "broadphase/swept_boxes.h"
#include "core/state.h"
#include "solver/algebra/eigen_llt.h"
#include "solver/block/affine.h"
#include "solver/law/tether.h"
#include "solver/world/newton_system.h"

#include <cstdint>
#include <vector>

namespace springtower {

/// Per-block integration history. `explicitFrames`, `implicitSteps`, `forced`, `spectralRadius` and `contactSignature` belong to
/// the island and are read from the entry of its lowest-numbered block: when islands merge or split, that block's values survive.
struct BlockHistory {
  double lastExplicitStep_s = 0.0;  ///< s; the last explicit step of the block's positions; 0 after an implicit one
  double lastImplicitStep_s = 0.0;  ///< s; the implicit step from memo.previous to the present positions, 0 if there was none
  std::int32_t explicitFrames = 0;  ///< frames for which the block's island is still stepped explicitly
  std::int32_t implicitSteps = 0;   ///< steps a frame that its vibration required last
  bool forced = false;              ///< whether a user's force or the hand acts on its island, as of the last frame begun
  bool explicitLast = false;        ///< whether the last step was explicit
  bool falls = false;               ///< whether its island fell in the last frame begun
  bool hasFallen = false;           ///< whether it has fallen since it slept last
  double jerk = 0.0;    ///< kg m2/s6; mass times the squared rate of change of its corners' acceleration, mean over some frames
  double motion = 0.0;  ///< kg m2/s2; mass times the squared velocity of its corners, same mean
  double travel = 0.0;  ///< m; path length of the block's fastest corner, monotonic
  double spectralRadius = 0.0;         ///< 1/s2; bound of the largest eigenvalue of M^-1 K of the block's island
  std::uint64_t contactSignature = 0;  ///< of the contacts for which that bound was computed
};

/// What a frame depends on beside the state that is hashed: histories, factors, clearances that persist between frames. In
/// snapshots.
struct Memo {
  SortAndSweep sweep;
  SweptBoxes boxes;                   ///< of awake blocks at the last sweep; of sleeping ones, when they fell asleep
  std::vector<double> travelAtSweep;  ///< m, [blocks]
  bool swept = false;                 ///< whether the order of the sweep has been set up
  std::vector<BlockPair> sweptPairs;
  Islands islands;
  bool topologyChanged = true;               ///< whether pairs or islands differ from those of the frame before
  std::vector<std::int32_t> pairStart;       ///< pairs of island i are islandPairs[pairStart[i] .. pairStart[i + 1]]
  std::vector<std::int32_t> islandPairs;     ///< by position in engine.pairs
  std::vector<std::int32_t> blockPairStart;  ///< pairs of block b are blockPairs[blockPairStart[b] .. blockPairStart[b + 1]]
  std::vector<std::int32_t> blockPairs;
  std::vector<BlockHistory> blockHistory;  ///< [blocks]
  ParticleArray previous;                  ///< m, positions at the start of the step, [blocks][8]
  ParticleArray previousVelocity;          ///< m/s, at the start of the step; for implicit steps
  ParticleArray carried;                   ///< m/s, mean velocity of the last step of a multi-stage method
  ParticleArray force;                     ///< N, [blocks][8]; where forcesKnown, at the positions now
  std::vector<BlockFrame> frames;          ///< affine parts of the blocks at the stage being evaluated; of sleeping ones, at rest
  std::vector<AffineField> motion;         ///< and of their velocities
  std::vector<AffineField> carriedMotion;  ///< and of the velocities that carried them, in the multi-stage methods
  std::vector<NewtonSystem> newtonSystems;   ///< by the island's smallest block; empty for other methods
  std::vector<SparseFactors> sparseFactors;  ///< by the island's smallest block; of method `implicitEigen` only
  GripForce tetherForce;                     ///< the hand's, as last evaluated
};

}  // namespace springtower
