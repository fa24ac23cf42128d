#include "solver/world/checkpoint.h"

#include "core/tuning.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace springtower {

namespace {

void copyBlock(const ParticleArray& from, std::size_t block, ParticleArray& to) {
  for (std::size_t a = 0; a < 3; ++a) std::copy_n(from.values(a, block), kCorners, to.values(a, block));
}

bool hasHistory(const Simulation& simulation) {
  return isImplicit(simulation.scene.settings.method);
}

FrameStartIn& startOf(Engine& engine, std::int32_t block) {
  return engine.checkpoint.in[static_cast<std::size_t>(engine.memo.islands.islandOf[static_cast<std::size_t>(block)])];
}

// Of the island that a pair belongs to: a sleeping block is in none.
FrameStartIn startOfPair(const Engine& engine, std::size_t at) {
  const BlockPair& key = engine.pairs.key[at];
  const std::int32_t first = engine.memo.islands.islandOf[static_cast<std::size_t>(key.a)];
  const std::int32_t island = first >= 0 ? first : engine.memo.islands.islandOf[static_cast<std::size_t>(key.b)];
  return engine.checkpoint.in[static_cast<std::size_t>(island)];
}

void copyBlock(const ParticleArray& from, std::size_t block, std::array<double, 3 * kCorners>& to) {
  for (std::size_t a = 0; a < 3; ++a) std::copy_n(from.values(a, block), kCorners, to.data() + kCorners * a);
}

void copyBlock(const std::array<double, 3 * kCorners>& from, std::size_t block, ParticleArray& to) {
  for (std::size_t a = 0; a < 3; ++a) std::copy_n(from.data() + kCorners * a, kCorners, to.values(a, block));
}

void rewindBlock(Simulation& simulation, std::size_t b, FrameStartIn in) {
  Engine& engine = *simulation.engine;
  if (in == FrameStartIn::copy) {
    const std::int32_t saved = engine.checkpoint.savedBlock[b];
    const SavedBlocks& page = engine.checkpoint.savedBlocks.page(saved);
    const std::size_t slot = PagePool<SavedBlocks>::slot(saved);
    copyBlock(page.position[slot], b, simulation.state.position);
    copyBlock(page.velocity[slot], b, simulation.state.velocity);
  } else if (in == FrameStartIn::step) {
    copyBlock(engine.memo.previous, b, simulation.state.position);
    copyBlock(engine.memo.previousVelocity, b, simulation.state.velocity);
  }
  engine.memo.blockHistory[b] = engine.checkpoint.history[b];
  engine.memo.islandHistory[b] = engine.checkpoint.islandHistory[b];
  if (!hasHistory(simulation)) return;
  engine.memo.blockHistory[b].startKnown = false;
  copyBlock(engine.checkpoint.previousVelocity, b, engine.memo.previousVelocity);
}

void rewindPair(Engine& engine, std::size_t at, FrameStartIn in) {
  PairTable& pairs = engine.pairs;
  const std::int32_t saved = engine.checkpoint.savedPair[at];
  if (saved >= 0) {
    const SavedPairs& page = engine.checkpoint.savedPairs.page(saved);
    const std::size_t slot = PagePool<SavedPairs>::slot(saved);
    pairs.phase[at] = page.phase[slot];
    pairs.clearance[at] = page.clearance[slot];
    pairs.travelAtCheck[at] = page.travelAtCheck[slot];
    pairs.setAxis(at, page.axis[slot]);
  }
  if (!pairs.touches(at)) return;
  const std::int32_t contact = pairs.contact[at];
  if (saved >= 0) engine.contacts.restoreShape(contact);
  if (saved >= 0 || in == FrameStartIn::copy) {
    engine.contacts.restorePoints(contact);
  } else if (in == FrameStartIn::step) {
    engine.contacts.copyFromTrial(contact);
  }
}

// What elimination orders and factors' layouts were found with.
void releaseOrders(Engine& engine) {
  for (NewtonSystem& island : engine.memo.newtonSystems.all()) {
    releaseSpace(island.order);
    releaseLayoutSpace(island.matrix);
  }
}

void releaseCopies(Engine& engine) {
  engine.checkpoint.savedBlocks = PagePool<SavedBlocks>();
  engine.contacts.releaseSaved();
  releaseOrders(engine);
}

// Copies take as much as most of an island's other working space, and it needs none once it is at rest; nor what its elimination
// order was found with. The first frame makes copies, as it takes several steps where accelerations are not yet known; what it
// copied is returned. Later it is returned where a wide island is: what moves again in a smaller scene is not to allocate.
void releaseUnused(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  FrameStart& start = engine.checkpoint;
  if (!start.returned && !start.in.empty() && simulation.frame > 0) {
    start.returned = true;
    releaseCopies(engine);
  }
  const bool copied = std::any_of(start.in.begin(), start.in.end(), [](FrameStartIn in) { return in == FrameStartIn::copy; });
  if (start.framesWithoutCopy == tuning::kFramesUntilRelease && !copied) return;  // they have been returned
  start.framesWithoutCopy = copied ? 0 : start.framesWithoutCopy + 1;
  if (engine.contacts.isWide() && start.framesWithoutCopy == tuning::kFramesUntilRelease) releaseCopies(engine);
}

}  // namespace

void prepareFrameStart(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  if (engine.checkpoint.history.size() != simulation.model.blockCount()) {
    engine.checkpoint.history.resize(simulation.model.blockCount());
    engine.checkpoint.islandHistory.resize(simulation.model.blockCount());
    engine.checkpoint.stepTravel.resize(simulation.model.blockCount());
    engine.checkpoint.savedBlock.resize(simulation.model.blockCount());
    if (hasHistory(simulation)) engine.checkpoint.previousVelocity.resize(simulation.model.blockCount());
  }
  engine.checkpoint.reportContacts = engine.report.contacts;
  releaseUnused(simulation);
  engine.checkpoint.in.assign(engine.memo.islands.count(), FrameStartIn::state);
  engine.checkpoint.savedBlocks.clear();
  engine.checkpoint.savedBlocks.reserve(0, simulation.model.blockCount(), false);
  engine.checkpoint.savedPair.assign(engine.pairs.size(), -1);
  engine.checkpoint.savedPairs.clear();
  engine.checkpoint.savedPairs.reserve(kPageRows, engine.pairs.size(), false);
}

void saveFrameStart(IslandStep& step) {
  Engine& engine = step.engine;
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t block : step.blocks.subspan(first, last - first)) {
      const auto b = static_cast<std::size_t>(block);
      engine.checkpoint.history[b] = engine.memo.blockHistory[b];
      engine.checkpoint.islandHistory[b] = engine.memo.islandHistory[b];
      if (hasHistory(step.simulation)) copyBlock(engine.memo.previousVelocity, b, engine.checkpoint.previousVelocity);
    }
  });
}

void copyFrameStart(IslandStep& step) {
  Engine& engine = step.engine;
  FrameStartIn& in = startOf(engine, step.blocks.front());
  if (in == FrameStartIn::copy) return;
  assert(in == FrameStartIn::state);
  FrameStart& start = engine.checkpoint;
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t block : step.blocks.subspan(first, last - first)) {
      const auto b = static_cast<std::size_t>(block);
      const std::int32_t saved = start.savedBlocks.take();
      start.savedBlock[b] = saved;
      SavedBlocks& page = start.savedBlocks.page(saved);
      const std::size_t slot = PagePool<SavedBlocks>::slot(saved);
      copyBlock(step.simulation.state.position, b, page.position[slot]);
      copyBlock(step.simulation.state.velocity, b, page.velocity[slot]);
    }
  });
  overPairs(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t pair : step.pairs.subspan(first, last - first)) {
      const auto at = static_cast<std::size_t>(pair);
      if (engine.pairs.touches(at) && start.savedPair[at] < 0) engine.contacts.savePoints(engine.pairs.contact[at]);
    }
  });
  in = FrameStartIn::copy;
}

bool holdsFrameStart(const IslandStep& step) {
  return startOf(step.engine, step.blocks.front()) == FrameStartIn::state;
}

void setFrameStartHeld(IslandStep& step) {
  startOf(step.engine, step.blocks.front()) = FrameStartIn::step;
}

Vec3 frameStartPosition(const Simulation& simulation, std::size_t block, std::size_t corner) {
  const Engine& engine = *simulation.engine;
  const auto island = static_cast<std::size_t>(engine.memo.islands.islandOf[block]);
  const FrameStartIn in = engine.checkpoint.in[island];
  if (in == FrameStartIn::state) return simulation.state.position.at(block, corner);
  if (in == FrameStartIn::step) return engine.memo.previous.at(block, corner);
  const std::int32_t saved = engine.checkpoint.savedBlock[block];
  const std::array<double, 3 * kCorners>& position =
      engine.checkpoint.savedBlocks.page(saved).position[PagePool<SavedBlocks>::slot(saved)];
  return {position[corner], position[kCorners + corner], position[2 * kCorners + corner]};
}

void releaseFrameStart(Engine& engine) {
  engine.checkpoint.savedPairs = PagePool<SavedPairs>();
  engine.checkpoint.in.clear();
  engine.checkpoint.returned = false;
  releaseCopies(engine);
}

void savePair(Engine& engine, std::size_t at) {
  if (engine.checkpoint.savedPair[at] >= 0) return;
  const PairTable& pairs = engine.pairs;
  const std::int32_t saved = engine.checkpoint.savedPairs.take();
  engine.checkpoint.savedPair[at] = saved;
  SavedPairs& page = engine.checkpoint.savedPairs.page(saved);
  const std::size_t slot = PagePool<SavedPairs>::slot(saved);
  page.phase[slot] = pairs.phase[at];
  page.clearance[slot] = pairs.clearance[at];
  page.travelAtCheck[slot] = pairs.travelAtCheck[at];
  page.axis[slot] = pairs.axisOf(at);
  if (!pairs.touches(at)) return;
  const std::int32_t contact = pairs.contact[at];
  engine.contacts.saveShape(contact);
  const FrameStartIn in = startOfPair(engine, at);
  if (in == FrameStartIn::state) engine.contacts.savePoints(contact);
  if (in == FrameStartIn::step) engine.contacts.saveTrial(contact);
}

void restoreFrame(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  for (std::size_t i = 0; i < engine.memo.islands.count(); ++i) {
    if (engine.scratch.takesPart[i] == 0) continue;
    const FrameStartIn in = engine.checkpoint.in[i];
    for (const std::int32_t block : engine.memo.islands.island(i)) rewindBlock(simulation, static_cast<std::size_t>(block), in);
    for (std::int32_t k = engine.memo.pairStart[i]; k < engine.memo.pairStart[i + 1]; ++k)
      rewindPair(engine, static_cast<std::size_t>(engine.memo.islandPairs[static_cast<std::size_t>(k)]), in);
  }
  for (NewtonSystem& island : engine.memo.newtonSystems.all()) island.forcesKnown = false;
  engine.report.contacts = engine.checkpoint.reportContacts;
}

void restoreIsland(IslandStep& step) {
  FrameStartIn& in = startOf(step.engine, step.blocks.front());
  for (const std::int32_t block : step.blocks) rewindBlock(step.simulation, static_cast<std::size_t>(block), in);
  for (const std::int32_t at : step.pairs) rewindPair(step.engine, static_cast<std::size_t>(at), in);
  if (in == FrameStartIn::step) in = FrameStartIn::state;  // what the step held has been put back
}

void saveStep(IslandStep& step) {
  Engine& engine = step.engine;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    copyBlock(step.simulation.state.position, b, engine.memo.previous);
    engine.checkpoint.stepTravel[b] = engine.memo.blockHistory[b].travel;
  }
  if (step.pointKind == PointKind::penalty) return;
  for (RigidBody& body : step.rigid->bodies) body.before = body;
}

void restoreStep(IslandStep& step) {
  Engine& engine = step.engine;
  const bool rigid = step.pointKind != PointKind::penalty;
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t block : step.blocks.subspan(first, last - first)) {
      const auto b = static_cast<std::size_t>(block);
      copyBlock(engine.memo.previous, b, step.simulation.state.position);
      if (rigid) {
        engine.memo.blockHistory[b].travel = engine.checkpoint.stepTravel[b];
      } else {
        copyBlock(engine.memo.previousVelocity, b, step.simulation.state.velocity);
      }
    }
  });
  if (!rigid) return;
  for (RigidBody& body : step.rigid->bodies) static_cast<RigidPose&>(body) = body.before;
}

}  // namespace springtower
