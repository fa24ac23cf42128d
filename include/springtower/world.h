#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <springtower/scene.h>
#include <string>
#include <string_view>
#include <vector>

namespace springtower::api {

/// Where a block is and how it is turned. Blocks are slightly elastic: this is the rigid block that fits the deformed one.
struct Pose {
  Vec3 centre;             ///< m
  Quaternion orientation;  ///< from its own axes to the world's; unit
};

/// How a block moves as a rigid one. By explicit methods half a step behind its pose.
struct Velocity {
  Vec3 linear_m_s;     ///< of its centre
  Vec3 angular_rad_s;  ///< in the world's axes
};

/// That a simulation has failed: a position is not finite any more, or a block is turned inside out. How often methods do so:
/// docs/random-scenes.md.
struct Divergence {
  int block = kFloor;   ///< the block found first
  double time_s = 0.0;  ///< simulated time
  std::string cause;    ///< one line for people
};

/// How far World::prepare has come.
struct PrepareProgress {
  int blocks = 0;                ///< that may move
  int blocksDone = 0;            ///< of islands whose search has ended
  std::uint64_t iterations = 0;  ///< linear systems solved
  double elapsed_s = 0.0;        ///< s, wall time
};

/// Limits of World::prepare.
struct PrepareOptions {
  /// s, wall time, 0 or more. What has no equilibrium by then starts as placed: how it goes on depends on the machine's speed.
  double budget_s = std::numeric_limits<double>::infinity();
  /// Called at the beginning and about ten times a second, on whatever thread, one call at a time; false ends the search, as the
  /// budget does. May be empty; must not throw, nor call the world.
  std::function<bool(const PrepareProgress&)> goesOn = {};
};

/// How World::prepare has ended.
struct Preparation {
  enum class End { complete, outOfTime, cancelled, diverged };
  End end = End::complete;
  int blocks = 0;           ///< that may move
  int blocksInBalance = 0;  ///< that start in static equilibrium; the others start as placed
  double wall_s = 0.0;      ///< s
};

/// What has happened since a world was made, counted.
struct Counters {
  std::uint64_t frames = 0;
  std::uint64_t steps = 0;                       ///< of each frame the most that an island took, summed
  std::uint64_t replayedFrames = 0;              ///< run again: with a wider search, or with sleepers awake whose supports failed
  std::uint64_t contactsCreated = 0;             ///< contacts found by a continuous test
  std::uint64_t contactsCreatedPenetrating = 0;  ///< of these, found too late; 0 unless settings forbid the tests
  std::uint64_t contactEvaluations = 0;          ///< contact points times evaluations of their forces
  std::uint64_t implicitSteps = 0;               ///< over all islands
  std::uint64_t implicitIterations = 0;          ///< linear systems solved in these
  std::uint64_t factorisations = 0;              ///< of their matrices
  std::uint64_t failedImplicitSteps = 0;         ///< that did not converge: finer ones or rigid ones were taken
  std::uint64_t wakes = 0;                       ///< blocks that woke, for whatever reason
  bool operator==(const Counters&) const = default;
};

// Of the library alone.
struct WorldImpl;
struct WorldAccess;
struct SnapshotData;

/// All that the future of a world depends on, at one time: motion, contacts, sleep, and inputs (forces, gravity, friction, sleep
/// setting, hand). A value that never changes: copies share it, any number of threads may restore from it at once, and it may
/// outlive its world.
class Snapshot {
 public:
  Snapshot() = default;  ///< empty
  [[nodiscard]] bool empty() const { return data_ == nullptr; }
  /// Simulated time when it was taken, s. Throws InputError for an empty one.
  [[nodiscard]] double time_s() const;
  /// As bytes for a file or another process: some ten kilobytes a block, with version and checksum. Throws InputError for an
  /// empty one.
  [[nodiscard]] std::vector<std::byte> bytes() const;
  /// A snapshot from such bytes. A world of the same scene, in any process of the same commit on any x86-64, goes on from it bit
  /// for bit; another commit of the same version takes it too, and may go on with other bits (docs/determinism.md). Throws
  /// InputError for bytes that are cut off, changed, of another version or of another kind.
  [[nodiscard]] static Snapshot fromBytes(std::span<const std::byte> bytes);

 private:
  friend class World;
  std::shared_ptr<const SnapshotData> data_;
};

/// A running scene.
///
/// Threads: a world uses all processors by itself (see ThreadLimit). One thread at a time may change it; while none does, any
/// number may read it, that is, call const functions and those of query.h. Different worlds may be used on different threads at
/// the same time.
///
/// Determinism: the same scene, the same calls between the same steps and the same version give the same bits, on any number of
/// threads, x86-64 processor and C library, whether gcc or clang has compiled it, with AVX2 and FMA or without (but for
/// -ffast-math and its like, and -ffp-contract, which the build sets).
///
/// Errors: bad arguments throw InputError and change nothing. A simulation that fails is no exception but a value (Divergence);
/// what that leaves is of no use: until an older snapshot is restored, functions that read the state throw InputError.
///
/// Memory: step() allocates only where more blocks come near or touch than ever before, and in frames with a hand. Functions that
/// return containers or strings, snapshot(), restore() and what adds forces may allocate. Nothing else does. Running out of
/// memory (std::bad_alloc) in step() or restore() leaves the world as a divergence does.
class World {
 public:
  /// Makes a world of a scene, which is copied. Throws InputError where checkScene does, and for a tolerance that does not fit
  /// the substeps. Costs a sort of the blocks.
  explicit World(const Scene& scene);
  ~World();
  World(World&& other) noexcept;             ///< `other` may only be destroyed or assigned to afterwards
  World& operator=(World&& other) noexcept;  ///< likewise
  World(const World&) = delete;              ///< a copy is another world of the same scene that restores a snapshot
  World& operator=(const World&) = delete;

  /// Lays what touches and does not move into the static equilibrium next to its placement, where there is one: blocks as placed
  /// carry no forces, and would drop by about the tolerance. To be called once, before the first step; from milliseconds for a
  /// tower to seconds for thousands of blocks. Throws InputError for a negative budget and after the first call.
  Preparation prepare(const PrepareOptions& options = {});

  /// Advances by one frame of frame_s(). Returns nothing where all is well, else how it failed; a world that has failed stays as
  /// it is and returns the same again. Throws InputError before prepare().
  [[nodiscard]] std::optional<Divergence> step();
  /// Advances by so many frames, or until it fails. Throws InputError for a negative number, and before prepare().
  [[nodiscard]] std::optional<Divergence> step(int frames);
  /// How it has failed, if it has.
  [[nodiscard]] const std::optional<Divergence>& divergence() const;

  [[nodiscard]] double time_s() const;        ///< simulated time, s: frame() times frame_s(), with one rounding
  [[nodiscard]] std::uint64_t frame() const;  ///< frames done
  [[nodiscard]] double frame_s() const;       ///< what a frame simulates, s
  [[nodiscard]] double tolerance_m() const;   ///< the tolerance in force: as set, or what the set substeps allow
  [[nodiscard]] Method method() const;        ///< the method in force; never `automatic`
  [[nodiscard]] int blockCount() const;       ///< blocks are numbered from 0 to this less one
  [[nodiscard]] Counters counters() const;    ///< since the world was made; a snapshot brings back those of its time

  /// Where a block is. Throws InputError for a number that is no block's.
  [[nodiscard]] Pose pose(int block) const;
  /// How it moves. Throws InputError for a number that is no block's.
  [[nodiscard]] Velocity velocity(int block) const;
  /// Its eight corners as they are, deformed, m, by number: bit 0, 1, 2 set on the positive side of its x, y, z axis. Throws
  /// InputError for a number that is no block's.
  [[nodiscard]] std::array<Vec3, 8> corners(int block) const;
  /// Its undeformed size along its own axes, m, and its mass. Throw InputError for a number that is no block's.
  [[nodiscard]] Vec3 dimensions(int block) const;
  [[nodiscard]] double mass_kg(int block) const;
  /// The poses of all blocks at once, [blockCount()]. Throws InputError for a span of another length.
  void poses(std::span<Pose> into) const;

  /// A copy of the present. Costs some kilobytes a block.
  [[nodiscard]] Snapshot snapshot() const;
  /// Goes to where a snapshot was taken: from there on the same calls give the same bits. It may be another world's, if that was
  /// made of the same scene (names and `seconds` may differ). Throws InputError for an empty one or that of another scene.
  void restore(const Snapshot& snapshot);
  /// A hash (FNV-1a, 64 bit) of positions, velocities, sleep and contacts: worlds that are in the same state have the same.
  [[nodiscard]] std::uint64_t stateHash() const;

 private:
  friend struct WorldAccess;
  std::unique_ptr<WorldImpl> impl_;
};

/// While it lives, worlds use at most so many threads, whatever thread steps them; the least of all that live counts. Results do
/// not depend on it.
class ThreadLimit {
 public:
  /// Throws InputError unless it is 1 to 4096.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What a hash or a time has to be quoted with.
struct BuildInfo {
  std::string_view version;    ///< of the library
  std::string_view commit;     ///< the first twelve digits, then -dirty if changed; "unknown" outside a git clone
  std::string_view compiler;   ///< name and version
  std::string_view flags;      ///< that it was compiled with
  std::string_view buildType;  ///< as CMake names it
};
BuildInfo buildInfo();

}  // namespace springtower::api
