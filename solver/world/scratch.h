#pragma once

#include "core/counters.h"
#include "core/ids.h"
#include "core/state.h"
#include "solver/block/affine.h"
#include "solver/world/frame_part.h"
#include "solver/world/rigid_island.h"
#include "solver/world/sleep_state.h"
#include "solver/world/support_point.h"
#include "solver/world/work_pool.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// Change of the load that awake neighbours put on a sleeping block since it fell asleep, and the limits of what its other
/// contacts support.
struct LoadChange {
  Vec3 force = Vec3::Zero();   ///< N, change of all their forces
  Vec3 torque = Vec3::Zero();  ///< N m, change of their torque about the block's centre
  Vec3 shear = Vec3::Zero();   ///< N, their friction now
  Vec3 side = Vec3::Zero();    ///< sum of the unit normals of their contacts
  double load_n = 0.0;         ///< N, contact load through the block when it fell asleep
  double hold_n = 0.0;         ///< N, largest friction of its contacts with sleeping blocks and the floor
  bool begunOrLost = false;    ///< whether a contact has begun or ended
};

/// A group of sleeping blocks, by its root, and a pair that may support it.
struct SupportPair {
  std::int32_t group;
  std::int32_t pair;
  auto operator<=>(const SupportPair&) const = default;
};

/// Working space of the support check.
struct SupportCheckScratch {
  std::vector<std::int32_t> start;  ///< pairs in which sleeping block b touches something are pairs[start[b] .. start[b + 1]]
  std::vector<std::int32_t> pairs;
  std::vector<std::int32_t> blocks;  ///< sleeping blocks connected to pushed ones by contacts, from the top down
  std::vector<std::int32_t> parent;  ///< union-find parents of the groups above the level, -1 below it, [blocks]
  std::vector<std::int32_t> open;    ///< pairs across the level
  std::vector<std::int32_t> groups;  ///< groups under a changed load, ascending
  std::vector<SupportPair> beneath;  ///< pairs that may support these groups, ascending
  std::vector<SupportPoint> supports;
};

/// A block near one that drives move, and whether it moves through the frame in parts.
struct NearDriven {
  std::int32_t driven = -1;
  std::uint8_t inParts = 0;
  std::int32_t block = -1;
};

/// Working space of a frame: nothing in it is read before it is written in the same frame. Not in snapshots. Builds with
/// assertions fill it with NaN when a frame begins (solver/world/poison); a test does so in every build.
struct Scratch {
  // Pairs and islands.
  std::vector<std::int32_t> awakeBlocks;   ///< ascending
  std::vector<double> reach;               ///< m, travel up to which a block cannot have left its swept box, [blocks]
  std::vector<BlockPair> mergedKeys;       ///< keys of the new pair table,
  std::vector<std::int32_t> mergedFrom;    ///< previous index of each of them, or -1,
  std::vector<std::byte> mergedColumn;     ///< and space for one column of the table
  std::vector<std::int32_t> cursor;        ///< of counting sorts
  FramePart part;                          ///< that is run now
  std::vector<std::uint8_t> inParts;       ///< 1 where a block moves through the frame in several parts, [blocks]
  std::vector<std::uint8_t> takesPart;     ///< 1 for the islands that are run now, [islands]
  std::vector<std::uint8_t> leftBox;       ///< 1 for blocks whose island left its swept boxes as `prepare` searched it, [blocks]
  std::vector<std::int32_t> byDuration;    ///< awake blocks, those in parts first
  std::vector<BlockPair> islandEdges;      ///< swept pairs of blocks that are at the same time of the frame
  std::vector<std::int32_t> drivenNow;     ///< fixed blocks that drives move in this frame, ascending
  std::vector<std::uint8_t> sweepAsleep;   ///< flags of sleep for the sweep, in which these count as awake, [blocks]
  std::vector<NearDriven> nearDriven;      ///< blocks near them, by driven block
  std::vector<BlockPair> drivenOfIslands;  ///< islands and driven blocks near them, ascending
  ParticleArray drivenMean;                ///< m/s, mean velocities of driven blocks in the last step, [blocks]
  std::vector<std::int32_t> watchedPairs;  ///< active pairs of each island, by position in islandPairs
  std::vector<double> path;                ///< m, path of each block's fastest corner in the last step, [blocks]
  std::vector<double> assumedPath;         ///< m, upper bound of that path for which a list of active pairs is valid, [blocks]
  std::vector<std::uint16_t> newContactCount;  ///< [blocks]: pairs of the block that may make first contact in this frame
  std::vector<std::uint8_t> covered;  ///< not 0 where a pair has constraints in a rigid step, by position in engine.pairs
  std::vector<std::int32_t> nodeOf;   ///< index of each block in its island, for implicit steps and rigid methods

  // Steps.
  std::vector<std::int32_t> firstEqualIsland;      ///< of each island before the first frame: the first that is equal
  std::vector<AffineField> contactForce;           ///< N, contact forces on each block
  std::array<MotionState, 4> stage;                ///< states at the stages of the multi-stage methods; empty for the others
  std::array<ParticleArray, 4> stageAcceleration;  ///< m/s2, of the stages
  ParticleArray pastPosition;                      ///< m, contribution of past steps to the position at an implicit step's end;
                                                   ///< matrices of contacts where explicit steps are chosen
  ParticleArray freePosition;                      ///< m, position at the end of the implicit step without forces
  WorkPool<RigidIsland> rigidWork;                 ///< of rigid steps

  // Sleep.
  std::vector<std::int32_t>
      lostNeighbours;  ///< sleeping blocks whose pair with an awake neighbour the sweep dropped in this frame
  std::vector<WakeRequest> toWake;
  std::vector<std::int32_t> wakeRoots;  ///< blocks from which the search over contacts starts
  std::vector<std::int32_t> pushed;     ///< sleeping blocks with awake neighbours
  std::vector<LoadChange> loadChange;   ///< [blocks]
  SupportCheckScratch support;
  std::vector<BlockPair> touchingEdges;
  std::vector<std::int32_t> restless;
  std::vector<std::int32_t> parent;   ///< of connectedBlocks
  std::vector<std::uint8_t> touched;  ///< 1 where a block is connected to one of toWake by contacts
  std::vector<std::uint8_t> joined;   ///< 1 where a block is connected to a block that is not at rest by contacts

  // Results of islands, before they are summed in order.
  std::vector<Counters> islandCounters;
  std::vector<StageTimes> islandTimes;
  std::vector<int> islandOutcome;  ///< steps of each island, -1 where a block left its swept box
};

}  // namespace springtower
