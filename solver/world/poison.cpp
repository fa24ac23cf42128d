#include "solver/world/poison.h"

#include <cstring>
#include <type_traits>

namespace springtower {

namespace {

// All bits set are a NaN in a double, and -1 in an integer.
template <class T, class Allocator>
void poison(std::vector<T, Allocator>& values) {
  if (!values.empty()) std::memset(static_cast<void*>(values.data()), 0xFF, values.size() * sizeof(T));
}

void poison(ParticleArray& values) {
  for (auto& component : values.component) poison(component);
}

template <class... Parts>
void poisonAll(Parts&... parts) {
  (poison(parts), ...);
}

}  // namespace

void poisonScratch(Engine& engine) {
  Scratch& s = engine.scratch;
  poisonAll(s.awakeBlocks, s.reach, s.mergedKeys, s.mergedFrom, s.mergedColumn, s.cursor, s.watchedPairs, s.path, s.assumedPath,
            s.newContactCount, s.nodeOf, s.contactForce, s.stageAcceleration[0], s.stageAcceleration[1], s.stageAcceleration[2],
            s.stageAcceleration[3], s.pastPosition, s.freePosition, s.lostNeighbours, s.toWake, s.wakeRoots, s.pushed,
            s.loadChange, s.support.start, s.support.pairs, s.support.blocks, s.support.parent, s.support.open, s.support.groups,
            s.support.beneath, s.support.supports, s.touchingEdges, s.restless, s.parent, s.touched, s.joined, s.islandCounters,
            s.islandTimes, s.islandOutcome, s.inParts, s.takesPart, s.leftBox, s.byDuration, s.islandEdges, s.covered,
            s.drivenNow, s.sweepAsleep, s.nearDriven, s.drivenOfIslands, s.drivenMean);
  for (MotionState& stage : s.stage) poisonAll(stage.position, stage.velocity);
  for (NewtonSystem& work : engine.memo.newtonSystems.all())
    poisonAll(work.residual, work.direction, work.affine, work.tangents, work.tangentStart, work.coupled, work.coupledIndex,
              work.coupledMotion, work.coupledForce, work.correction);
  engine.contacts.poisonStartRows();
  engine.checkpoint.savedBlocks.forEachPage([](SavedBlocks& page) { std::memset(static_cast<void*>(&page), 0xFF, sizeof page); });
  s.rigidWork.forEach([](RigidIsland& island) {
    LcpWorkspace& lcp = island.pivoting;
    poisonAll(island.bodies, island.contacts, island.places, island.motions, island.changed, island.listedPairs, island.fastPairs,
              island.outruns, lcp.matrix, lcp.inverse, lcp.impulse, lcp.velocity, lcp.least, lcp.most, lcp.impulseChange,
              lcp.velocityChange, lcp.column, lcp.clamped, lcp.placeOf);
    for (PointList* list : listsOf(island)) poisonAll(list->points, list->groups);
    for (PackedPoints* p : packsOf(island))
      poisonAll(p->pairs, p->points, p->places, p->colourStart, p->active, p->activeStart, p->taken, p->kind, p->key, p->keyStart,
                p->order, p->bodyStart, p->bodyPairs, p->due);
    for (ListedRange& range : island.ranges) poisonAll(range.list.points, range.list.groups, range.fastPairs);
  });
}

}  // namespace springtower
