#include "solver/world/checkpoint.h"

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
  copyBlock(engine.frameStart.position, b, simulation.state.position);
  copyBlock(engine.frameStart.velocity, b, simulation.state.velocity);
  engine.blockHistory[b] = engine.frameStartClock[b];
  if (!hasHistory(simulation)) return;
  copyBlock(engine.frameStartPrevious, b, engine.previous);
  copyBlock(engine.frameStartPreviousVelocity, b, engine.previousVelocity);
}

void rewindPair(Engine& engine, std::size_t at) {
  PairTable& pairs = engine.pairs;
  const std::int32_t saved = engine.savedPair[at];
  if (saved >= 0) {
    const SavedPairs& page = engine.savedPairs.page(saved);
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
  if (engine.frameStart.position.blockCount() != simulation.model.blockCount()) {
    engine.frameStart.resize(simulation.model.blockCount());
    engine.frameStartClock.resize(simulation.model.blockCount());
    if (hasHistory(simulation)) {
      engine.frameStartPrevious.resize(simulation.model.blockCount());
      engine.frameStartPreviousVelocity.resize(simulation.model.blockCount());
    }
  }
  engine.savedPair.assign(engine.pairs.size(), -1);
  engine.savedPairs.clear();
  engine.savedPairs.reserve(kPageRows, engine.pairs.size(), false);
}

void saveFrameStart(IslandStep& step) {
  Engine& engine = step.engine;
  for (const std::int32_t block : step.blocks) {
    const auto b = static_cast<std::size_t>(block);
    copyBlock(step.simulation.state.position, b, engine.frameStart.position);
    copyBlock(step.simulation.state.velocity, b, engine.frameStart.velocity);
    engine.frameStartClock[b] = engine.blockHistory[b];
    if (!hasHistory(step.simulation)) continue;
    copyBlock(engine.previous, b, engine.frameStartPrevious);
    copyBlock(engine.previousVelocity, b, engine.frameStartPreviousVelocity);
  }
  for (const std::int32_t pair : step.pairs) {
    const auto at = static_cast<std::size_t>(pair);
    if (engine.pairs.touches(at)) engine.contacts.savePoints(engine.pairs.contact[at]);
  }
}

void savePair(Engine& engine, std::size_t at) {
  if (engine.savedPair[at] >= 0) return;
  const PairTable& pairs = engine.pairs;
  const std::int32_t saved = engine.savedPairs.take();
  engine.savedPair[at] = saved;
  SavedPairs& page = engine.savedPairs.page(saved);
  const std::size_t slot = PagePool<SavedPairs>::slot(saved);
  page.phase[slot] = pairs.phase[at];
  page.clearance[slot] = pairs.clearance[at];
  page.travelAtCheck[slot] = pairs.travelAtCheck[at];
  page.axis[slot] = pairs.axisOf(at);
  if (pairs.touches(at)) engine.contacts.saveShape(pairs.contact[at]);
}

void restoreFrame(Simulation& simulation) {
  Engine& engine = *simulation.engine;
  for (const std::int32_t block : engine.islands.blocks) rewindBlock(simulation, static_cast<std::size_t>(block));
  for (const std::int32_t at : engine.islandPairs) rewindPair(engine, static_cast<std::size_t>(at));
  for (NewtonSystem& island : engine.newtonSystems) island.forcesKnown = false;
}

void restoreIsland(IslandStep& step) {
  for (const std::int32_t block : step.blocks) rewindBlock(step.simulation, static_cast<std::size_t>(block));
  for (const std::int32_t at : step.pairs) rewindPair(step.engine, static_cast<std::size_t>(at));
}

}  // namespace springtower
