#pragma once

#include "core/counters.h"
#include "core/ids.h"
#include "core/state.h"
#include "solver/block/affine.h"
#include "solver/world/rigid_island.h"
#include "solver/world/sleep_state.h"
#include "solver/world/support_point.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace springtower {

/// How awake neighbours push a sleeping block otherwise than when it fell asleep, and what it could bear.
struct LoadChange {
  Vec3 force = Vec3::Zero();   ///< N, change of all their forces
  Vec3 torque = Vec3::Zero();  ///< N m, change of their torque about the block's centre
  Vec3 shear = Vec3::Zero();   ///< N, their friction now
  Vec3 side = Vec3::Zero();    ///< unit normals of their contacts, added up
  double load_n = 0.0;         ///< N, what went through the block when it fell asleep
  double hold_n = 0.0;         ///< N, most friction of its contacts with sleepers and the floor
  bool begunOrLost = false;    ///< whether a contact has come or gone
};

/// A group of sleepers, by its root, and a pair on which it may rest.
struct SupportPair {
  std::int32_t group;
  std::int32_t pair;
  auto operator<=>(const SupportPair&) const = default;
};

/// What the search for sleepers whose supports fail works with.
struct SupportCheckScratch {
  std::vector<std::int32_t> start;  ///< pairs in which sleeper b touches something are pairs[start[b] .. start[b + 1]]
  std::vector<std::int32_t> pairs;
  std::vector<std::int32_t> blocks;  ///< sleepers that touch pushed ones, directly or through others, from the top down
  std::vector<std::int32_t> parent;  ///< of groups above the level, -1 below it, [blocks]
  std::vector<std::int32_t> open;    ///< pairs across the level
  std::vector<std::int32_t> groups;  ///< that are pushed, ascending
  std::vector<SupportPair> beneath;  ///< of these groups, ascending
  std::vector<SupportPoint> supports;
};

/// What a frame works with and leaves behind: nothing in it is read before it is written in the same frame. Not in snapshots.
/// Builds with assertions fill it with NaN when a frame begins (solver/world/poison); a test does so in every build.
struct Scratch {
  // Pairs and islands.
  std::vector<std::int32_t> awakeBlocks;   ///< ascending
  std::vector<double> reach;               ///< m a block may travel before it can be out of its swept box, [blocks]
  std::vector<BlockPair> mergedKeys;       ///< pairs there are to be,
  std::vector<std::int32_t> mergedFrom;    ///< where each of them was before, or -1,
  std::vector<std::byte> mergedColumn;     ///< and a column of the table
  std::vector<std::int32_t> cursor;        ///< of counting sorts
  std::vector<std::int32_t> watchedPairs;  ///< by position in islandPairs: those of each island that are watched, from its first
  std::vector<double> path;                ///< m, of each block's fastest corner in the last step, [blocks]
  std::vector<double> foreseenPath;        ///< m, most that is counted on in a step while a list of watched pairs holds, [blocks]
  std::vector<std::int32_t> newContactCount;  ///< [blocks]: pairs of the block that may make first contact in this frame
  std::vector<std::int32_t> nodeOf;           ///< the place of each block in its island, for implicit steps and rigid methods

  // Steps.
  std::vector<AffineField> contactForce;           ///< N, what contacts put on each block
  std::vector<Eigen::Matrix4d> contactMetric;      ///< 1/s2, stiffness of each block's contacts on its affine part, over its mass
  std::array<MotionState, 4> stage;                ///< states inside a step of the multi-stage methods; empty for the others
  std::array<ParticleArray, 4> stageAcceleration;  ///< m/s2, of the stages
  ParticleArray pastPosition;                      ///< m, what past steps give of the position at an implicit step's end
  ParticleArray stepVelocity;                      ///< m/s, mean over the implicit step
  ParticleArray freePosition;                      ///< m, where the implicit step ends without forces
  std::vector<RigidIsland> rigidIslands;           ///< by the island's smallest block; of rigid methods, and of what falls

  // Sleep.
  std::vector<std::int32_t> lostPartners;  ///< sleeping blocks whose awake neighbour went out of reach in this frame
  std::vector<WakeRequest> toWake;
  std::vector<std::int32_t> wakeRoots;  ///< blocks from which others are reached
  std::vector<std::int32_t> pushed;     ///< sleeping blocks with awake neighbours
  std::vector<LoadChange> loadChange;   ///< [blocks]
  SupportCheckScratch support;
  std::vector<BlockPair> touchingEdges;
  std::vector<std::int32_t> restless;
  std::vector<std::int32_t> parent;   ///< of connectedBlocks
  std::vector<std::uint8_t> touched;  ///< 1 where a block touches one of toWake, directly or through others
  std::vector<std::uint8_t> joined;   ///< 1 where a block touches a restless one, directly or through others

  // Results of islands and of ranges of pairs inside a large one, before they are added up in order.
  std::vector<Counters> chunkCounters;
  std::vector<StageTimes> chunkTimes;  ///< s of one thread each
  std::vector<Counters> islandCounters;
  std::vector<StageTimes> islandTimes;
  std::vector<int> islandOutcome;  ///< steps of each island, -1 where a block left its swept box
};

}  // namespace springtower
