#include "solver/world/memory_use.h"

#include "solver/world/engine.h"

#include <algorithm>

namespace springtower {
namespace {

template <class Vector>
std::size_t bytesOf(const Vector& values) {
  return values.size() * sizeof(typename Vector::value_type);
}

std::size_t bytesOf(const ParticleArray& values) {
  std::size_t sum = 0;
  for (const auto& component : values.component) sum += bytesOf(component);
  return sum;
}

std::size_t bytesOf(const MotionState& state) {
  return bytesOf(state.position) + bytesOf(state.velocity);
}

std::size_t bytesOf(const std::vector<std::vector<ReportContact>>& lists) {
  std::size_t sum = 0;
  for (const auto& contacts : lists) sum += bytesOf(contacts);
  return sum;
}

template <class... Parts>
std::size_t sumOf(const Parts&... parts) {
  return (bytesOf(parts) + ...);
}

std::size_t ofReport(const ReportState& report) {
  std::size_t sum = sumOf(report.from, report.to, report.low, report.high, report.version, report.testedAt, report.contacts);
  for (const auto& blocks : report.struck) sum += bytesOf(blocks);
  return sum;
}

std::size_t ofModel(const BlockModel& model) {
  std::size_t sum = sumOf(model.dimensions, model.mass, model.rootRestitution, model.fixed, model.warpStiffness);
  for (std::size_t g = 0; g < kSpringGroups; ++g)
    sum += sumOf(model.restLength[g], model.springStiffness[g], model.springDamping[g]);
  return sum;
}

std::size_t ofFactors(const Memo& memo) {
  std::size_t sum = 0;
  for (const NewtonSystem& island : memo.newtonSystems.all()) {
    const BlockCholesky& matrix = island.matrix;
    const EliminationTasks& tasks = matrix.tasks;
    sum += sumOf(matrix.position, matrix.node, matrix.columnStart, matrix.row, matrix.targetStart, matrix.target, matrix.diagonal,
                 matrix.lower, matrix.ownDiagonal, matrix.ownLower, tasks.columnStart, tasks.column, tasks.taskOf, tasks.firstTop,
                 tasks.top, tasks.sourceStart, tasks.source);
  }
  for (const SparseFactors& sparse : memo.sparseFactors.all()) sum += bytesOf(sparse);
  return sum;
}

std::size_t ofNewton(const NewtonSystem& island) {
  const BlockCholesky& matrix = island.matrix;
  std::size_t sum =
      sizeof(NewtonSystem) +
      sumOf(matrix.mark, matrix.firstChild, matrix.nextChild, matrix.edgeStart, matrix.edgeRow, matrix.work, matrix.divided,
            matrix.taken, island.touching, island.taskPairs, island.taskPairStart, island.tangentStart, island.slot, island.mask,
            island.active, island.axes, island.residual, island.direction, island.affine, island.factorTangents, island.tangents,
            island.coupled, island.coupledIndex, island.coupledMotion, island.coupledForce, island.correction,
            island.blockClasses, island.blockClassOf, island.order.nodes, island.order.centre, island.edges);
  for (const DissectionSpace& space : island.order.space)
    sum += sizeof(space) +
           sumOf(space.neighbourStart, space.neighbour, space.sorted, space.best, space.place, space.reach, space.change);
  return sum;
}

// Without what is counted by pair.
std::size_t ofMemo(const Memo& memo) {
  std::size_t sum = sumOf(memo.travelAtSweep, memo.sweepMargin, memo.pairStart, memo.blockPairStart, memo.blockPairs,
                          memo.blockHistory, memo.islandHistory, memo.stepBound, memo.previous, memo.previousVelocity,
                          memo.carried, memo.force, memo.frames, memo.motion, memo.carriedMotion, memo.forcesBefore);
  sum += sumOf(memo.sweep.order, memo.sweep.place, memo.sweep.columns, memo.sweep.awake, memo.sweep.renewed, memo.sweep.ascending,
               memo.sweep.outOfOrder);
  for (const SortAndSweep::Found& found : memo.sweep.found) sum += sumOf(found.ascending, found.outOfOrder);
  for (std::size_t a = 0; a < 3; ++a) sum += sumOf(memo.boxes.lower[a], memo.boxes.upper[a]);
  sum += sumOf(memo.islands.blocks, memo.islands.start, memo.islands.islandOf, memo.islands.edges, memo.islands.asleep,
               memo.islands.parent);
  for (const NewtonSystem& island : memo.newtonSystems.all()) sum += ofNewton(island);
  sum += memo.newtonSystems.indexBytes() + memo.sparseFactors.indexBytes();
  return sum;
}

// With what is kept for larger islands: the sizes are those of whichever island had it last.
template <class... Parts>
std::size_t reservedFor(const Parts&... parts) {
  return ((parts.capacity() * sizeof(typename Parts::value_type)) + ...);
}

std::size_t ofRigidWork(const RigidIsland& island) {
  const LcpWorkspace& lcp = island.pivoting;
  std::size_t sum =
      sizeof(RigidIsland) + reservedFor(island.bodies, island.contacts, island.places, island.motions, island.changed,
                                        island.listedPairs, island.fastPairs, island.fastPairsBefore, island.outruns, lcp.matrix,
                                        lcp.inverse, lcp.impulse, lcp.velocity, lcp.least, lcp.most, lcp.impulseChange,
                                        lcp.velocityChange, lcp.column, lcp.clamped, lcp.placeOf, island.ranges);
  for (const PointList* list : listsOf(island)) sum += reservedFor(list->points, list->groups);
  for (const PackedPoints* p : packsOf(island))
    sum += reservedFor(p->pairs, p->points, p->places, p->colourStart, p->active, p->activeStart, p->taken, p->kind, p->key,
                       p->keyStart, p->order, p->bodyStart, p->bodyPairs, p->due);
  for (const ListedRange& range : island.ranges) sum += reservedFor(range.list.points, range.list.groups, range.fastPairs);
  return sum;
}

std::size_t ofScratch(const Scratch& s) {
  std::size_t sum = sumOf(s.awakeBlocks, s.reach, s.cursor, s.path, s.assumedPath, s.newContactCount, s.nodeOf, s.contactForce,
                          s.pastPosition, s.freePosition, s.lostNeighbours, s.toWake, s.wakeRoots, s.pushed, s.loadChange,
                          s.support.start, s.support.pairs, s.support.blocks, s.support.parent, s.support.open, s.support.groups,
                          s.support.beneath, s.support.supports, s.touchingEdges, s.restless, s.parent, s.touched, s.joined,
                          s.islandCounters, s.islandTimes, s.islandOutcome, s.inParts, s.takesPart, s.leftBox, s.byDuration,
                          s.islandEdges, s.covered, s.drivenNow, s.sweepAsleep, s.nearDriven, s.drivenOfIslands, s.drivenMean);
  for (const MotionState& stage : s.stage) sum += bytesOf(stage);
  for (const ParticleArray& acceleration : s.stageAcceleration) sum += bytesOf(acceleration);
  s.rigidWork.forEach([&](const RigidIsland& island) { sum += ofRigidWork(island); });
  return sum;
}

// Of all pages that are made, as far as `most` rows can be in use.
template <class Page>
std::size_t rowBytes(const PagePool<Page>& pool, std::size_t most) {
  return sizeof(Page) / kPageRows * std::min(kPageRows * pool.pageCount(), most);
}

std::size_t ofFrameStart(const FrameStart& start) {
  return rowBytes(start.savedBlocks, start.savedBlock.size()) + rowBytes(start.savedPairs, start.savedPair.size()) +
         sumOf(start.in, start.history, start.islandHistory, start.previousVelocity, start.stepTravel, start.savedBlock,
               start.reportContacts);
}

// Columns of the pair table and all lists with one entry a pair.
std::size_t ofPairs(const Engine& engine) {
  const Memo& memo = engine.memo;
  const Scratch& scratch = engine.scratch;
  return PairTable::kBytes * engine.pairs.size() +
         sumOf(engine.checkpoint.savedPair, memo.islandPairs, memo.sweptPairs, scratch.watchedPairs, scratch.mergedKeys,
               scratch.mergedFrom) +
         sizeof(double) * engine.pairs.size();  // mergedColumn at its largest
}

}  // namespace

MemoryUse memoryUse(const Simulation& simulation) {
  const Engine& engine = *simulation.engine;
  MemoryUse use;
  use.state = bytesOf(simulation.state) + sumOf(simulation.asleep, simulation.restTime_s);
  use.model = ofModel(simulation.model) + bytesOf(simulation.scene.blocks);
  use.factor = ofFactors(engine.memo);
  use.nearPairs = engine.pairs.size();
  use.touchingPairs = engine.contacts.inUse();
  use.pairs = ofPairs(engine);
  use.touching = engine.contacts.bytes();
  use.touchingSteps = engine.contacts.stepBytes();
  use.contacts = use.pairs + use.touching;
  use.working = use.touchingSteps + ofMemo(engine.memo) + ofScratch(engine.scratch) + ofFrameStart(engine.checkpoint) +
                ofReport(engine.report) +
                sumOf(engine.springRadius, engine.roundingFactor, engine.staticResponse, engine.responseStart,
                      engine.sleep.windows, engine.sleep.checkedLoads) +
                sumOf(simulation.stiffness.stack_n_m, simulation.stiffness.floor_n_m, simulation.stiffness.edge_n_m,
                      simulation.stiffness.loadShare);
  return use;
}

}  // namespace springtower
