#include "api/convert.h"
#include "api/world_impl.h"
#include "core/byte_stream.h"
#include "core/hash.h"
#include "core/limits.h"
#include "core/scene/scene_fields.h"
#include "core/version.h"
#include "solver/block/inertia.h"
#include "solver/frame/prepare.h"
#include "solver/hand/hand_fields.h"
#include "solver/world/snapshot.h"

#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <numeric>
#include <oneapi/tbb/global_control.h>
#include <springtower/world.h>
#include <utility>

namespace springtower::api {

template <class Stream>
void fieldsOf(Stream& stream, HandLead& lead) {
  auto& [draw, pulls, target, speed_m_s] = lead;
  stream(draw, pulls, target, speed_m_s);
}

namespace {

constexpr Range kThreadRange{1.0, 4096.0, ""};

void mix(Hash& hash, double value) {
  hash.word(std::bit_cast<std::uint64_t>(value));
}

void mix(Hash& hash, const springtower::Vec3& value) {
  for (Eigen::Index a = 0; a < 3; ++a) mix(hash, value[a]);
}

// Of all that the constructor of a simulation reads. What may change while it runs is in snapshots, but has decided stiffness.
std::uint64_t hashOf(const springtower::Scene& scene) {
  Hash hash;
  for (const springtower::BlockSpec& block : scene.blocks) {
    for (const springtower::Vec3& vector : {block.centre, block.dimensions, block.velocity, block.spin}) mix(hash, vector);
    for (Eigen::Index a = 0; a < 4; ++a) mix(hash, block.orientation.coeffs()[a]);
    mix(hash, block.mass);
    mix(hash, block.restitution.value_or(scene.restitution));
    hash.word(block.fixed ? 1 : 0);
    for (std::size_t c = 0; block.strain && c < block.strain->size(); ++c) mix(hash, (*block.strain)[c]);
  }
  for (const springtower::UserForce& force : scene.forces) {
    hash.word(static_cast<std::uint64_t>(force.block));
    hash.word(static_cast<std::uint64_t>(force.corner));
    mix(hash, force.force);
    mix(hash, force.start_s);
    mix(hash, force.end_s);
    mix(hash, force.torque);
    for (const std::optional<springtower::Vec3>& given : {force.point, force.forceAtEnd, force.torqueAtEnd}) {
      hash.word(given ? 1 : 0);
      if (given) mix(hash, *given);
    }
  }
  for (const springtower::Drive& drive : scene.drives) {
    hash.word(static_cast<std::uint64_t>(drive.block));
    for (const springtower::Vec3& vector : {drive.velocity, drive.spin, drive.amplitude}) mix(hash, vector);
    for (const double value : {drive.frequency_hz, drive.start_s, drive.end_s}) mix(hash, value);
  }
  const springtower::Gravity& gravity = scene.gravity;
  for (const double value : {gravity.magnitude, gravity.tilt_deg, gravity.direction_deg, gravity.sway_deg, gravity.sway_hz,
                             scene.staticFriction, scene.kineticFriction, scene.restitution}) {
    mix(hash, value);
  }
  const auto mixFriction = [&](const springtower::Friction& friction) {
    mix(hash, friction.staticFriction);
    mix(hash, friction.kineticFriction);
  };
  if (scene.floorFriction) mixFriction(*scene.floorFriction);
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    if (!scene.blocks[b].friction) continue;
    hash.word(b);
    mixFriction(*scene.blocks[b].friction);
  }
  for (const springtower::FrictionPair& pair : scene.frictionPairs) {
    hash.word(static_cast<std::uint64_t>(pair.a));
    hash.word(static_cast<std::uint64_t>(pair.b));
    mixFriction(pair.friction);
  }
  for (const bool value : {scene.floor, scene.plane}) hash.word(value ? 1 : 0);
  hash.word(static_cast<std::uint64_t>(scene.settings.method));
  hash.word(static_cast<std::uint64_t>(scene.settings.inertia));
  hash.word(static_cast<std::uint64_t>(scene.settings.sleep));
  for (const springtower::SettingRow& row : springtower::settingTable())
    mix(hash, springtower::numberOf(scene.settings, row).value_or(-1.0));
  return hash.value();
}

// Marks a world as failed, without a call to the allocator.
void fail(WorldImpl& impl) {
  impl.unfinished.time_s = impl.simulation.time_s;
  impl.divergence = std::move(impl.unfinished);
}

// Runs a frame with the forces that are to pass with it.
void stepWithPassingForces(WorldImpl& impl) {
  std::vector<springtower::UserForce>& forces = impl.simulation.scene.forces;
  const std::size_t lasting = forces.size();
  forces.insert(forces.end(), impl.passing.begin(), impl.passing.end());
  impl.passing.clear();
  try {
    leadHand(impl);
    stepFrame(impl.simulation);
  } catch (const DivergenceError& error) {
    forces.resize(lasting);
    fail(impl);  // also where there is no memory for the message
    impl.divergence = {error.block, error.time_s, error.what()};
    return;
  } catch (...) {
    forces.resize(lasting);
    fail(impl);
    throw;
  }
  forces.resize(lasting);
}

void requirePrepared(const WorldImpl& impl) {
  if (!isPrepared(impl.simulation)) throw InputError("step: expected a world after prepare(), got one that is not prepared");
}

}  // namespace

WorldImpl& WorldAccess::impl(World& world) {
  if (world.impl_ == nullptr) throw InputError("world: expected one that holds a scene, got one that has been moved from");
  return *world.impl_;
}

const WorldImpl& WorldAccess::impl(const World& world) {
  return impl(const_cast<World&>(world));
}

WorldImpl& WorldAccess::running(World& world) {
  WorldImpl& inside = impl(world);
  if (inside.divergence) {
    throw InputError(
        fmt::format("world: expected one that runs, got one that has failed ({}): restore a snapshot", inside.divergence->cause));
  }
  return inside;
}

const WorldImpl& WorldAccess::running(const World& world) {
  return running(const_cast<World&>(world));
}

std::size_t checkedBlock(int block, std::size_t count, const char* what) {
  if (block < 0 || static_cast<std::size_t>(block) >= count)
    throw InputError(fmt::format("{}: expected 0 to {}, got {}", what, count - 1, block));
  return static_cast<std::size_t>(block);
}

double Snapshot::time_s() const {
  if (empty()) throw InputError("snapshot: expected one that a world has taken, got an empty one");
  return data_->time_s;
}

std::vector<std::byte> Snapshot::bytes() const {
  if (empty()) throw InputError("snapshot: expected one that a world has taken, got an empty one");
  ByteWriter writer;
  const SnapshotData& data = *data_;
  writer(data.sceneHash, data.time_s, data.lead, data.passing);
  writeSnapshot(*data.simulation, writer);
  const std::string text = sealed(SealKind::world, writer.bytes());
  std::vector<std::byte> result(text.size());
  std::memcpy(result.data(), text.data(), text.size());
  return result;
}

Snapshot Snapshot::fromBytes(std::span<const std::byte> bytes) {
  return withPublicErrors([&] {
    constexpr std::string_view kSource = "snapshot";
    const Unsealed opened =
        unsealed(SealKind::world, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), kSource);
    ByteReader reader(opened.payload, kSource);
    SnapshotData data;
    reader(data.sceneHash, data.time_s, data.lead, data.passing);
    data.simulation = readSnapshot(reader);
    reader.end();
    Snapshot snapshot;
    snapshot.data_ = std::make_shared<const SnapshotData>(std::move(data));
    return snapshot;
  });
}

World::World(const Scene& scene) {
  withPublicErrors([&] {
    springtower::Scene given = toEngine(scene);
    given.name = sourceOf(scene);
    impl_ = std::make_unique<WorldImpl>(given);
    impl_->sceneHash = hashOf(given);
  });
}

Preparation World::prepare(const PrepareOptions& options) {
  WorldImpl& impl = WorldAccess::running(*this);
  if (isPrepared(impl.simulation)) throw InputError("prepare: expected a world that is not prepared, got one that is");
  springtower::PrepareOptions how;
  how.budget_s = options.budget_s;
  if (options.goesOn) {
    how.goesOn = [&](const springtower::PrepareProgress& now) {
      return options.goesOn({static_cast<int>(now.blocks), static_cast<int>(now.blocksDone), now.iterations, now.elapsed_s});
    };
  }
  Preparation done;
  withPublicErrors([&] {
    try {
      const springtower::PrepareResult result = springtower::prepare(impl.simulation, how);
      done = {static_cast<Preparation::End>(result.end), static_cast<int>(result.blocks),
              static_cast<int>(result.blocksInBalance), result.wall_s};
    } catch (const DivergenceError& error) {
      fail(impl);  // also where there is no memory for the message
      impl.divergence = {error.block, error.time_s, error.what()};
      done.end = Preparation::End::diverged;
    }
  });
  return done;
}

World::~World() = default;
World::World(World&& other) noexcept = default;
World& World::operator=(World&& other) noexcept = default;

std::optional<Divergence> World::step() {
  WorldImpl& impl = WorldAccess::impl(*this);
  requirePrepared(impl);
  if (!impl.divergence) stepWithPassingForces(impl);
  return impl.divergence;
}

std::optional<Divergence> World::step(int frames) {
  if (frames < 0) throw InputError(fmt::format("step: expected 0 or more frames, got {}", frames));
  WorldImpl& impl = WorldAccess::impl(*this);
  requirePrepared(impl);
  for (int done = 0; done < frames && !impl.divergence; ++done) stepWithPassingForces(impl);
  return impl.divergence;
}

const std::optional<Divergence>& World::divergence() const {
  return WorldAccess::impl(*this).divergence;
}
double World::time_s() const {
  return WorldAccess::impl(*this).simulation.time_s;
}
std::uint64_t World::frame() const {
  return WorldAccess::impl(*this).simulation.frame;
}
double World::frame_s() const {
  return WorldAccess::impl(*this).simulation.scene.settings.frame_s;
}
double World::tolerance_m() const {
  return WorldAccess::impl(*this).simulation.tolerance_m;
}
Method World::method() const {
  return toPublic(WorldAccess::impl(*this).simulation.scene.settings.method);
}
int World::blockCount() const {
  return static_cast<int>(WorldAccess::impl(*this).simulation.model.blockCount());
}

Counters World::counters() const {
  const springtower::Simulation& simulation = WorldAccess::impl(*this).simulation;
  const springtower::Counters& from = simulation.counters;
  Counters counters;
  counters.frames = from.frames;
  counters.steps = from.steps;
  counters.replayedFrames = from.replayedFrames;
  counters.contactsCreated = from.contactsCreated;
  counters.contactsCreatedPenetrating = from.contactsCreatedPenetrating;
  counters.contactEvaluations = from.contactEvaluations;
  counters.implicitSteps = from.implicitSteps;
  counters.implicitIterations = from.implicitIterations;
  counters.factorisations = from.factorisations;
  counters.failedImplicitSteps = from.newtonFailures;
  counters.wakes = std::accumulate(simulation.wakes.begin(), simulation.wakes.end(), std::uint64_t{0});
  return counters;
}

Pose World::pose(int block) const {
  const springtower::Simulation& simulation = WorldAccess::running(*this).simulation;
  const std::size_t b = checkedBlock(block, simulation.model.blockCount());
  return {toPublic(centre(simulation.state.position, b)), toPublic(orientationOf(simulation.state.position, b))};
}

Velocity World::velocity(int block) const {
  const springtower::Simulation& simulation = WorldAccess::running(*this).simulation;
  const RigidMotion motion = rigidMotion(simulation.state, checkedBlock(block, simulation.model.blockCount()));
  return {toPublic(motion.velocity), toPublic(motion.spin)};
}

std::array<Vec3, 8> World::corners(int block) const {
  const springtower::Simulation& simulation = WorldAccess::running(*this).simulation;
  const std::size_t b = checkedBlock(block, simulation.model.blockCount());
  std::array<Vec3, 8> corners;
  for (std::size_t c = 0; c < kCorners; ++c) corners[c] = toPublic(simulation.state.position.at(b, c));
  return corners;
}

Vec3 World::dimensions(int block) const {
  const BlockModel& model = WorldAccess::impl(*this).simulation.model;
  return toPublic(model.dimensions[checkedBlock(block, model.blockCount())]);
}

double World::mass_kg(int block) const {
  const BlockModel& model = WorldAccess::impl(*this).simulation.model;
  return model.mass[checkedBlock(block, model.blockCount())];
}

void World::poses(std::span<Pose> into) const {
  const springtower::Simulation& simulation = WorldAccess::running(*this).simulation;
  const std::size_t count = simulation.model.blockCount();
  if (into.size() != count) throw InputError(fmt::format("poses: expected room for {}, got room for {}", count, into.size()));
  for (std::size_t b = 0; b < count; ++b)
    into[b] = {toPublic(centre(simulation.state.position, b)), toPublic(orientationOf(simulation.state.position, b))};
}

Snapshot World::snapshot() const {
  const WorldImpl& impl = WorldAccess::running(*this);
  Snapshot snapshot;
  snapshot.data_ = std::make_shared<const SnapshotData>(
      SnapshotData{takeSnapshot(impl.simulation), impl.lead, impl.passing, impl.sceneHash, impl.simulation.time_s});
  return snapshot;
}

void World::restore(const Snapshot& snapshot) {
  WorldImpl& impl = WorldAccess::impl(*this);
  if (snapshot.empty()) throw InputError("restore: expected a snapshot that a world has taken, got an empty one");
  const SnapshotData& data = *snapshot.data_;
  if (data.sceneHash != impl.sceneHash)
    throw InputError("restore: expected a snapshot of a world made of the same scene, got one of another scene");
  withPublicErrors([&] { checkFits(*data.simulation, impl.simulation, "restore"); });
  // Until all is there.
  impl.divergence = {kFloor, data.time_s, "a snapshot could not be restored"};
  restoreSnapshot(impl.simulation, *data.simulation);
  impl.lead = data.lead;
  impl.passing = data.passing;
  impl.unfinished = unfinishedFrame();
  impl.divergence.reset();
}

std::uint64_t World::stateHash() const {
  return springtower::stateHash(WorldAccess::running(*this).simulation);
}

struct ThreadLimit::Impl {
  explicit Impl(std::size_t threads) : control(tbb::global_control::max_allowed_parallelism, threads) {}
  tbb::global_control control;  // its copies would not count
};

ThreadLimit::ThreadLimit(int threads) {
  withPublicErrors([&] { requireInRange(threads, kThreadRange, "threads"); });
  impl_ = std::make_unique<Impl>(static_cast<std::size_t>(threads));
}

ThreadLimit::~ThreadLimit() = default;

BuildInfo buildInfo() {
  return {kVersion, kGitCommit, kCompiler, kCompilerFlags, kBuildType};
}

}  // namespace springtower::api
