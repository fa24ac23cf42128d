#include "solver/world/checkpoint.h"

#include <algorithm>

namespace springtower {

namespace {

void copyBlock(const ParticleArray& from, std::size_t block, ParticleArray& to) {
  for (std::size_t a = 0; a < 3; ++a) std::copy_n(from.values(a, block), kCorners, to.values(a, block));
}

// Points that the short record of a pair holds; more are kept with the whole pair.
constexpr std::int32_t kFew = 4;

// Calls with each part of the memory of points and its place in the short record.
template <class Memory, class Visit>
void forEachPart(Memory& points, const Visit& visit) {
  std::size_t part = 0;
  for (auto* values : {&points.stretchX, &points.stretchY, &points.stretchZ, &points.relaxed, &points.offset, &points.scale,
                       &points.live, &points.sliding}) {
    visit(*values, part++);
  }
}

void keepPoints(const PointMemory& points, FewPoints& few) {
  forEachPart(points, [&](const auto& values, std::size_t part) { std::copy_n(values.begin(), kFew, few.memory[part].begin()); });
}

void restorePoints(const FewPoints& few, PointMemory& points) {
  points = PointMemory{};
  forEachPart(points, [&](auto& values, std::size_t part) { std::copy_n(few.memory[part].begin(), kFew, values.begin()); });
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
  NearPair& pair = engine.pairs[at];
  if (engine.pairKept[at] != 0) pair = engine.pairsBefore[at];
  if (at < engine.pose.size()) engine.pose[at] = engine.frameStartPose[at];
  if (pair.manifold.touch == PairPhase::separated || pair.manifold.count > kFew) return;
  restorePoints(engine.frameStartPoints[at], pair.manifold);
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
  engine.pairsBefore.resize(engine.pairs.size());
  engine.frameStartPoints.resize(engine.pairs.size());
  engine.frameStartPose.resize(engine.pairs.size());
  engine.pairKept.assign(engine.pairs.size(), 0);
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
    if (at < engine.pose.size()) engine.frameStartPose[at] = engine.pose[at];
    const Manifold& manifold = engine.pairs[at].manifold;
    if (manifold.touch == PairPhase::separated) continue;
    if (manifold.count > kFew) {
      savePair(engine, at);
    } else {
      keepPoints(manifold, engine.frameStartPoints[at]);
    }
  }
}

void savePair(Engine& engine, std::size_t at) {
  if (engine.pairKept[at] != 0) return;
  engine.pairKept[at] = 1;
  engine.pairsBefore[at] = engine.pairs[at];
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
