#pragma once

#include "broadphase/islands.h"
#include "broadphase/sort_and_sweep.h"
#include "broadphase/swept_boxes.h"
#include "core/counters.h"
#include "core/state.h"
#include "solver/algebra/eigen_llt.h"
#include "solver/law/contact_force.h"
#include "solver/world/newton_system.h"
#include "solver/world/pair_table.h"
#include "solver/world/report_state.h"
#include "solver/world/rigid_island.h"
#include "solver/world/simulation.h"
#include "solver/world/support_point.h"
#include "solver/world/wake_reason.h"

#include <array>
#include <cstdint>
#include <vector>

namespace springtower {

/// Per-block integration history. `explicitFrames`, `implicitSteps`, `forced`, `spectralRadius` and `contactSignature` belong to
/// the island and are read from the entry of its lowest-numbered block: when islands merge or split, that block's values survive.
struct BlockHistory {
  double lastExplicitStep_s = 0.0;  ///< s; the explicit step in which the block's positions last moved; 0 after an implicit one
  double lastImplicitStep_s = 0.0;  ///< s; the implicit step that led here from engine.previous, 0 where it was none
  std::int32_t explicitFrames = 0;  ///< frames that the block's island is still to be stepped explicitly
  std::int32_t implicitSteps = 0;   ///< steps of a frame that its ringing asked for last
  bool forced = false;              ///< whether a user's force or the hand acts on its island, as of the last frame begun
  bool explicitLast = false;        ///< whether explicit steps brought it where it is
  bool falls = false;               ///< whether its island fell in the last frame begun
  bool hasFallen = false;           ///< whether it has since it slept last
  double jerk = 0.0;            ///< kg m2/s6; mass by the square of its corners' change of acceleration, mean over some frames
  double motion = 0.0;          ///< kg m2/s2; mass by the square of its corners' velocity, alike
  double travel = 0.0;          ///< m; path length of the block's fastest corner, ever growing
  double spectralRadius = 0.0;  ///< 1/s2; bound of the largest eigenvalue of M^-1 K of the block's island
  std::uint64_t contactSignature = 0;  ///< what that bound was computed for
};

/// What is known of a block's rest: its rigid motion when the window that is running began.
struct SleepWindow {
  Vec3 centre = Vec3::Zero();    ///< m
  Vec3 velocity = Vec3::Zero();  ///< m/s
  Vec3 spin = Vec3::Zero();      ///< rad/s
  double age_s = 0.0;            ///< s since
};

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

/// How a sleeping block was pushed when all sleepers stayed.
struct CheckedLoad {
  std::int32_t block = -1;
  Vec3 force = Vec3::Zero();   ///< N, change
  Vec3 torque = Vec3::Zero();  ///< N m, about the block's centre
};

/// A sleeping block that is to wake.
struct WakeRequest {
  std::int32_t block = -1;
  WakeReason reason = WakeReason::loadChange;
};

/// A group of sleepers, by its root, and a pair on which it may rest.
struct SupportPair {
  std::int32_t group;
  std::int32_t pair;
  auto operator<=>(const SupportPair&) const = default;
};

/// What looks for sleepers that give way: working space, and what it last found to stay.
struct SupportCheckScratch {
  std::vector<std::int32_t> start;  ///< pairs in which sleeper b touches something are pairs[start[b] .. start[b + 1]]
  std::vector<std::int32_t> pairs;
  std::vector<std::int32_t> blocks;  ///< sleepers that touch pushed ones, directly or through others, from the top down
  std::vector<std::int32_t> parent;  ///< of groups above the level, -1 below it, [blocks]
  std::vector<std::int32_t> open;    ///< pairs across the level
  std::vector<std::int32_t> groups;  ///< that are pushed, ascending
  std::vector<SupportPair> beneath;  ///< of these groups, ascending
  std::vector<CheckedLoad> known;    ///< of all pushed blocks, in their order; none where some supports failed
  std::vector<SupportPoint> supports;
};

/// Islands of at least this many blocks run their kernels on many threads; smaller ones fit one core's cache.
inline constexpr std::size_t kParallelBlocks = 256;

/// Rows of the pair table as the frame began.
struct SavedPairs {
  Column<Vec3> axis;
  Column<double> clearance;
  Column<double> travelAtCheck;
  Column<PairPhase> phase;
  void prepare(bool /*wide*/) {}
};

/// The engine's working data. All plain vectors, sized once a scene is loaded and grown only when new pairs appear.
struct Engine {
  SortAndSweep sweep;
  SweptBoxes boxes;
  std::vector<double> reach;          ///< m a block may travel before it can be out of its swept box, [blocks]
  std::vector<double> travelAtSweep;  ///< m, [blocks]
  bool swept = false;                 ///< whether the order of the sweep has been set up
  std::vector<BlockPair> sweptPairs;
  std::vector<std::int32_t> awakeBlocks;  ///< ascending
  std::size_t awakeCount = 0;
  PairTable pairs;
  ContactPool contacts;
  std::vector<BlockPair> mergedKeys;       ///< working space of the merge of pairs: those there are to be,
  std::vector<std::int32_t> mergedFrom;    ///< where each of them was before, or -1,
  std::vector<std::byte> mergedColumn;       ///< and a column of the table
  Islands islands;
  bool topologyChanged = true;          ///< whether pairs or islands are others than in the frame before
  std::vector<std::int32_t> pairStart;  ///< pairs of island i are islandPairs[pairStart[i] .. pairStart[i + 1]]
  std::vector<std::int32_t> islandPairs;
  std::vector<std::int32_t> watchedPairs;  ///< by position in islandPairs: those of each island that are watched, from its first
  std::vector<double> path;                ///< m, of each block's fastest corner in the last step, [blocks]
  std::vector<double> foreseenPath;        ///< m, most that is counted on in a step while a list of watched pairs holds, [blocks]
  std::vector<std::int32_t> blockPairStart;  ///< pairs of block b are blockPairs[blockPairStart[b] .. blockPairStart[b + 1]]
  std::vector<std::int32_t> blockPairs;
  std::vector<std::int32_t> cursor;  ///< working space of counting sorts
  std::vector<BlockPair> touchingEdges;
  ParticleArray force;                     ///< N, [blocks][8]
  std::vector<BlockFrame> frames;          ///< affine parts of the blocks at the stage being evaluated; of sleepers, as they lie
  std::vector<AffineField> motion;         ///< and of their velocities
  std::vector<AffineField> carriedMotion;  ///< and of the velocities that carried them, in the multi-stage methods
  std::vector<AffineField> contactForce;   ///< N, what contacts put on each block
  std::vector<double> springRadius;        ///< 1/s2, largest eigenvalue of M^-1 K of each block alone
  std::vector<Eigen::Matrix4d>
      contactMetric;       ///< 1/s2, working space: stiffness of each block's contacts on its affine part, over its mass
  ParticleArray previous;  ///< m, positions at the start of the step, [blocks][8]
  std::array<MotionState, 4> stage;                ///< states inside a step of the multi-stage methods; empty for the others
  std::array<ParticleArray, 4> stageAcceleration;  ///< m/s2, of the stages
  ParticleArray carried;                           ///< m/s, mean velocity of the last step of a multi-stage method
  ParticleArray previousVelocity;  ///< m/s, at the start of the step; for implicit steps
  std::vector<NewtonSystem> newtonSystems;   ///< by the island's smallest block; empty for other methods
  std::vector<SparseFactors> sparseFactors;  ///< by the island's smallest block; of `implicitEigen` alone
  std::vector<RigidIsland> rigidIslands;     ///< by the island's smallest block; of rigid methods, and of what falls
  ParticleArray history;             ///< m, what past steps give of the position at an implicit step's end
  ParticleArray stepVelocity;        ///< m/s, mean over the implicit step
  ParticleArray target;              ///< m, where the implicit step ends without forces
  GripForce tetherNow;               ///< the hand's, as last evaluated
  std::vector<std::int32_t> nodeOf;  ///< the place of each block in its island, for implicit steps and rigid methods
  std::vector<BlockHistory> blockHistory;     ///< [blocks]
  std::vector<std::int32_t> lostPartner;      ///< sleeping blocks whose awake neighbour went out of reach in this frame
  std::vector<std::int32_t> newContactCount;  ///< scratch, [blocks]: pairs of the block that may make first contact in this frame
  std::vector<WakeRequest> toWake;            ///< working space: sleeping blocks that are to wake, and why
  std::vector<std::int32_t> wakeRoots;        ///< working space: blocks from which others are reached
  std::vector<std::int32_t> pushed;           ///< working space: sleeping blocks with awake neighbours
  std::vector<LoadChange> change;             ///< working space, [blocks]
  SupportCheckScratch loadPath;
  std::vector<std::int32_t> restless;  ///< working space
  std::vector<std::int32_t> parent;    ///< working space of connectedBlocks
  std::vector<std::uint8_t> touched;   ///< working space: 1 where a block touches one of toWake, directly or through others
  std::vector<std::uint8_t> joined;    ///< working space: 1 where a block touches a restless one, directly or through others
  std::vector<SleepWindow> rest;       ///< [blocks]
  Vec3 gravitySlept = Vec3::Zero();    ///< m/s2, gravity when the last block fell asleep
  ReportState report;                  ///< of method `report`; empty for the others
  MotionState frameStart;              ///< what a frame that has to be run again starts from
  std::vector<BlockHistory> frameStartClock;
  std::vector<std::int32_t> savedPair;       ///< by position in `pairs`: where it is saved as the frame began, -1 if unchanged
  PagePool<SavedPairs> savedPairs;
  ParticleArray frameStartPrevious;          ///< m, and for implicit steps what they started from
  ParticleArray frameStartPreviousVelocity;  ///< m/s
  std::vector<Counters> chunkCounters;       ///< of ranges of pairs inside a large island
  std::vector<StageTimes> chunkTimes;        ///< and their times, s of one thread each
  std::vector<Counters> islandCounters;
  std::vector<StageTimes> islandTimes;
  std::vector<int> islandOutcome;  ///< steps of each island, -1 where a block left its swept box
};

/// How far both blocks of a pair have travelled, m; it only ever grows but where a step or a frame is taken again.
inline double travelOf(const Engine& engine, std::size_t pair) {
  const BlockPair& key = engine.pairs.key[pair];
  const double first = engine.blockHistory[static_cast<std::size_t>(key.a)].travel;
  return key.b < 0 ? first : first + engine.blockHistory[static_cast<std::size_t>(key.b)].travel;
}

/// The contact of a pair as it lies; without points where the pair is separated.
inline ContactView contactOf(const Engine& engine, std::size_t pair) {
  return engine.pairs.touches(pair) ? engine.contacts.view(engine.pairs.contact[pair], engine.pairs[pair]) : ContactView{};
}

/// Which features of a touching pair touch. Precondition: the pair touches.
inline ManifoldShape shapeOf(const Engine& engine, std::size_t pair) {
  return shapeOf(engine.contacts.shape(engine.pairs.contact[pair]), engine.pairs[pair]);
}

/// The same with its points as they are at the end of an implicit step not yet taken. Precondition: the pair touches.
inline ContactView trialOf(const Engine& engine, std::size_t pair, const ContactView& contact) {
  ContactView trial = contact;
  trial.points = engine.contacts.trial(engine.pairs.contact[pair]);
  return trial;
}

/// What a pair's contact did when the first of its blocks fell asleep; zeros where none has been.
inline SleepLoad sleepLoadOf(const Engine& engine, std::size_t pair) {
  const std::int32_t contact = engine.pairs.contact[pair];
  return contact < 0 ? SleepLoad{} : engine.contacts.sleepLoad(contact);
}

/// The velocities that carried the positions during the last step: those of the state, or the mean over the stages of a
/// multi-stage method.
const ParticleArray& carriedVelocities(const Simulation& simulation);

}  // namespace springtower
