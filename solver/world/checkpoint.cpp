#include "solver/world/checkpoint.h"

#include "solver/world/over_island.h"

#include <algorithm>

namespace springtower {

namespace {

void copyBlock(const ParticleArray& from, std::size_t block, ParticleArray& to) {
  for (std::size_t a = 0; a < 3; ++a) std::copy_n(from.values(a, block), kCorners, to.values(a, block));
}

bool hasHistory(const Simulation& simulation) {
  return isImplicit(simulation.scene.settings.method);
}

void rewindBlock(Simulation& simulation, std::size_t b) {
  Engine& engine = *simulation.engine;
  copyBlock(engine.checkpoint.state.position, b, simulation.state.position);
  copyBlock(engine.checkpoint.state.velocity, b, simulation.state.velocity);
  engine.memo.blockHistory[b] = engine.checkpoint.history[b];
  engine.memo.islandHistory[b] = engine.checkpoint.islandHistory[b];
  if (!hasHistory(simulation)) return;
  copyBlock(engine.checkpoint.previous, b, engine.memo.previous);
  copyBlock(engine.checkpoint.previousVelocity, b, engine.memo.previousVelocity);
}

void rewindPair(Engine& engine, std::size_t at) {
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
  if (saved >= 0) engine.contacts.restoreShape(pairs.contact[at]);
  engine.contacts.restorePoints(pairs.contact[at]);
}

}  // namespace

void prepareFrameStart(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  if (engine.checkpoint.state.position.blockCount() != simulation.model.blockCount()) {
    engine.checkpoint.state.resize(simulation.model.blockCount());
    engine.checkpoint.history.resize(simulation.model.blockCount());
    engine.checkpoint.islandHistory.resize(simulation.model.blockCount());
    engine.checkpoint.stepTravel.resize(simulation.model.blockCount());
    if (hasHistory(simulation)) {
      engine.checkpoint.previous.resize(simulation.model.blockCount());
      engine.checkpoint.previousVelocity.resize(simulation.model.blockCount());
    }
  }
  engine.checkpoint.reportContacts = engine.report.contacts;
  engine.checkpoint.savedPair.assign(engine.pairs.size(), -1);
  engine.checkpoint.savedPairs.clear();
  engine.checkpoint.savedPairs.reserve(kPageRows, engine.pairs.size(), false);
}

void saveFrameStart(IslandStep& step) {
  Engine& engine = step.engine;
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t block : step.blocks.subspan(first, last - first)) {
      const auto b = static_cast<std::size_t>(block);
      copyBlock(step.simulation.state.position, b, engine.checkpoint.state.position);
      copyBlock(step.simulation.state.velocity, b, engine.checkpoint.state.velocity);
      engine.checkpoint.history[b] = engine.memo.blockHistory[b];
      engine.checkpoint.islandHistory[b] = engine.memo.islandHistory[b];
      if (!hasHistory(step.simulation)) continue;
      copyBlock(engine.memo.previous, b, engine.checkpoint.previous);
      copyBlock(engine.memo.previousVelocity, b, engine.checkpoint.previousVelocity);
    }
  });
  overPairs(step, [&](std::size_t first, std::size_t last) {
    for (const std::int32_t pair : step.pairs.subspan(first, last - first)) {
      const auto at = static_cast<std::size_t>(pair);
      if (engine.pairs.touches(at)) engine.contacts.savePoints(engine.pairs.contact[at]);
    }
  });
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
  if (pairs.touches(at)) engine.contacts.saveShape(pairs.contact[at]);
}

void restoreFrame(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  for (const std::int32_t block : engine.memo.islands.blocks) rewindBlock(simulation, static_cast<std::size_t>(block));
  for (const std::int32_t at : engine.memo.islandPairs) rewindPair(engine, static_cast<std::size_t>(at));
  for (NewtonSystem& island : engine.memo.newtonSystems.all()) island.forcesKnown = false;
  engine.report.contacts = engine.checkpoint.reportContacts;
}

void restoreIsland(IslandStep& step) {
  for (const std::int32_t block : step.blocks) rewindBlock(step.simulation, static_cast<std::size_t>(block));
  for (const std::int32_t at : step.pairs) rewindPair(step.engine, static_cast<std::size_t>(at));
}

void saveStep(IslandStep& step) {
  Engine& engine = step.engine;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    copyBlock(step.simulation.state.position, b, engine.memo.previous);
    engine.checkpoint.stepTravel[b] = engine.memo.blockHistory[b].travel;
  }
  if (step.pointKind == PointKind::penalty) return;
  for (RigidBody& body : engine.scratch.rigidIslands.of(step.blocks.front()).bodies) body.before = body;
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
  for (RigidBody& body : engine.scratch.rigidIslands.of(step.blocks.front()).bodies) static_cast<RigidPose&>(body) = body.before;
}

}  // namespace springtower
