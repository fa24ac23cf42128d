#include "solver/world/snapshot.h"

#include "core/error.h"
#include "solver/world/engine.h"
#include "solver/world/snapshot_fields.h"

#include <algorithm>
#include <fmt/format.h>

namespace springtower {
namespace {

// What a contact stores, without the row it is stored in.
template <class Stream>
void transferShape(Stream& stream, StoredShape& stored) {
  bool upperIsB = stored.upperIsB;
  bool slips = stored.slips;
  PointKind kind = stored.kind;
  stream(stored.count, stored.incidentFace, stored.referenceFace, upperIsB, slips, kind);
  if constexpr (Stream::kReads) {
    if (stored.count < 0 || stored.count > static_cast<std::int8_t>(kManifoldPoints) || kind > PointKind::anchor)
      stream.refuse("one that cannot be", "a contact as it was written");
    stored.upperIsB = upperIsB;
    stored.slips = slips;
    stored.kind = kind;
  }
}

// Whole rows, as what lies behind the last point is hashed too.
std::size_t rowsOf(const StoredShape& stored) {
  return std::max<std::size_t>(1, rowsFor(stored.count));
}

void writeContacts(const ContactPool& pool, const PairTable& pairs, ByteWriter& writer) {
  writer(pool.isWide());
  for (std::size_t at = 0; at < pairs.size(); ++at) {
    const std::int32_t contact = pairs.contact[at];
    if (contact < 0) continue;
    StoredShape stored = pool.shape(contact);
    transferShape(writer, stored);
    writer(pool.sleepLoad(contact), pool.pose(contact));
    const ContactView view = pool.view(contact, pairs[at]);
    const ConstPointRows trial = pool.trial(contact);
    for (std::size_t r = 0; r < rowsOf(stored); ++r) {
      writer(view.place[r]->u, view.place[r]->v);
      writer.raw(view.points[r], sizeof(PointRow));
      writer.raw(trial[r], sizeof(PointRow));
    }
  }
}

void readContacts(ByteReader& reader, PairTable& pairs, ContactPool& pool) {
  bool isWide = false;
  reader(isWide);
  const auto count =
      static_cast<std::size_t>(std::count_if(pairs.contact.begin(), pairs.contact.end(), [](auto c) { return c >= 0; }));
  pool.reserve(count, isWide);
  for (std::size_t at = 0; at < pairs.size(); ++at) {
    if (pairs.contact[at] < 0) continue;
    StoredShape stored;
    transferShape(reader, stored);
    const std::int32_t contact = pool.take();
    pairs.contact[at] = contact;
    SleepLoad load;
    RelativePose pose;
    reader(load, pose);
    pool.setSleepLoad(contact, load);
    Manifold manifold;
    static_cast<ManifoldShape&>(manifold) = shapeOf(stored, pairs[at]);
    std::array<PointRow, kManifoldRows> trial;
    for (std::size_t r = 0; r < rowsOf(stored); ++r) {
      reader(manifold.place[r].u, manifold.place[r].v);
      reader.raw(&manifold.points[r], sizeof(PointRow));
      reader.raw(&trial[r], sizeof(PointRow));
    }
    pool.store(contact, pairs[at], manifold);
    pool.setPose(contact, pose);
    pool.shape(contact).slips = stored.slips;
    const PointRows trialRows = pool.trial(contact);
    for (std::size_t r = 0; r < rowsOf(stored); ++r) *trialRows[r] = trial[r];
  }
}

// All but the contacts, whose rows are found through the pairs.
template <class Stream>
void transferRest(Stream& stream, Snapshot& snapshot) {
  auto& [gravity, forces, staticFriction, kineticFriction, sleep, tether, state, time_s, frame, asleep, restTime_s, pairs,
         contacts, patches, sleepState, report, memo, substeps, counters, stageTimes, wakes] = snapshot;
  stream(gravity, forces, staticFriction, kineticFriction, sleep, tether, state, time_s, frame, asleep, restTime_s, pairs,
         patches, sleepState, report, memo, substeps, counters, stageTimes, wakes);
}

std::vector<SlipPatch> patchesOf(const Engine& engine) {
  std::vector<SlipPatch> patches(engine.pairs.size());
  for (std::size_t at = 0; at < patches.size(); ++at) {
    const std::int32_t contact = engine.pairs.contact[at];
    if (contact >= 0) patches[at] = engine.contacts.view(contact, engine.pairs[at]).patch;
  }
  return patches;
}

void restorePatches(const std::vector<SlipPatch>& patches, Engine& engine) {
  for (std::size_t at = 0; at < patches.size(); ++at) {
    const std::int32_t contact = engine.pairs.contact[at];
    if (contact >= 0 && engine.contacts.shape(contact).slips) engine.contacts.setSlipping(contact, patches[at]);
  }
}

void checkPairs(const Snapshot& snapshot, const ByteReader& reader) {
  const PairTable& pairs = snapshot.pairs;
  const std::size_t count = pairs.size();
  const auto blocks = static_cast<std::int32_t>(snapshot.state.position.blockCount());
  bool fits = pairs.phase.size() == count && pairs.contact.size() == count && pairs.clearance.size() == count &&
              pairs.travelAtCheck.size() == count && snapshot.patches.size() == count;
  for (const std::vector<double>& axis : pairs.axis) fits = fits && axis.size() == count;
  for (const BlockPair& pair : pairs.key) fits = fits && pair.a >= 0 && pair.a < blocks && pair.b >= -1 && pair.b < blocks;
  for (std::size_t at = 0; fits && at < count; ++at) fits = pairs.phase[at] <= PairPhase::edge;
  if (!fits) reader.refuse("others, which cannot be", "the pairs of blocks that were written");
}

}  // namespace

std::shared_ptr<const Snapshot> takeSnapshot(const Simulation& s) {
  const Engine& e = *s.engine;
  return std::make_shared<const Snapshot>(Snapshot{s.scene.gravity,
                                                   s.scene.forces,
                                                   s.scene.staticFriction,
                                                   s.scene.kineticFriction,
                                                   s.scene.settings.sleep,
                                                   s.tether,
                                                   s.state,
                                                   s.time_s,
                                                   s.frame,
                                                   s.asleep,
                                                   s.restTime_s,
                                                   e.pairs,
                                                   e.contacts,
                                                   patchesOf(e),
                                                   e.sleep,
                                                   e.report,
                                                   e.memo,
                                                   s.substeps,
                                                   s.counters,
                                                   s.stageTimes,
                                                   s.wakes});
}

void restoreSnapshot(Simulation& s, const Snapshot& snapshot) {
  s.scene.gravity = snapshot.gravity;
  s.scene.forces = snapshot.forces;
  s.scene.staticFriction = snapshot.staticFriction;
  s.scene.kineticFriction = snapshot.kineticFriction;
  s.friction = FrictionTable(s.scene);
  s.scene.settings.sleep = snapshot.sleep;
  s.tether = snapshot.tether;
  s.state = snapshot.state;
  s.time_s = snapshot.time_s;
  s.frame = snapshot.frame;
  s.asleep = snapshot.asleep;
  s.restTime_s = snapshot.restTime_s;
  Engine& e = *s.engine;
  e.pairs = snapshot.pairs;
  e.contacts = snapshot.contacts;
  restorePatches(snapshot.patches, e);
  e.sleep = snapshot.sleepState;
  e.report = snapshot.report;
  e.memo = snapshot.memo;
  s.substeps = snapshot.substeps;
  s.counters = snapshot.counters;
  s.stageTimes = snapshot.stageTimes;
  s.wakes = snapshot.wakes;
}

void writeSnapshot(const Snapshot& snapshot, ByteWriter& writer) {
  transferRest(writer, const_cast<Snapshot&>(snapshot));  // which only reads it
  writeContacts(snapshot.contacts, snapshot.pairs, writer);
}

std::shared_ptr<const Snapshot> readSnapshot(ByteReader& reader) {
  auto snapshot = std::make_shared<Snapshot>();
  transferRest(reader, *snapshot);
  checkPairs(*snapshot, reader);
  readContacts(reader, snapshot->pairs, snapshot->contacts);
  return snapshot;
}

void checkFits(const Snapshot& snapshot, const Simulation& simulation, std::string_view source) {
  const std::size_t blocks = simulation.model.blockCount();
  const Memo& memo = snapshot.memo;
  for (const std::size_t found : {snapshot.state.position.blockCount(), snapshot.state.velocity.blockCount(),
                                  snapshot.asleep.size(), snapshot.restTime_s.size(), snapshot.sleepState.windows.size(),
                                  memo.blockHistory.size(), memo.islandHistory.size(), memo.frames.size()}) {
    if (found != blocks)
      throw InputError(fmt::format("{}: expected the state of {} blocks, got that of {}", source, blocks, found));
  }
  const std::size_t bounds = simulation.engine->memo.stepBound.size();
  if (memo.stepBound.size() != bounds)
    throw InputError(
        fmt::format("{}: expected bounds of the steps of {} blocks, got those of {}", source, bounds, memo.stepBound.size()));
}

}  // namespace springtower
