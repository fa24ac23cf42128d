#include "solver/world/memory_use.h"

#include "solver/world/engine.h"

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

std::size_t bytesOf(const ReportState& report);

template <class... Parts>
std::size_t sumOf(const Parts&... parts) {
  return (bytesOf(parts) + ...);
}

std::size_t bytesOf(const ReportState& report) {
  std::size_t sum = sumOf(report.from, report.to, report.low, report.high, report.version, report.testedAt);
  for (const auto& contacts : report.contacts) sum += bytesOf(contacts);
  for (const auto& contacts : report.frameStartContacts) sum += bytesOf(contacts);
  for (const auto& blocks : report.struck) sum += bytesOf(blocks);
  return sum;
}

}  // namespace

MemoryUse memoryUse(const Simulation& simulation) {
  const Engine& engine = *simulation.engine;
  const BlockModel& model = simulation.model;
  MemoryUse use;
  use.state = bytesOf(simulation.state) + sumOf(simulation.asleep, simulation.restTime_s);
  use.model = sumOf(model.dimensions, model.mass);
  for (std::size_t g = 0; g < kSpringGroups; ++g) {
    use.model += sumOf(model.restLength[g], model.springStiffness[g], model.springDamping[g]);
  }
  use.contacts = PairTable::kBytes * engine.pairs.size() + engine.contacts.bytes();
  use.working = sumOf(
      engine.reach, engine.travelAtSweep, engine.sweptPairs, engine.mergedKeys, engine.mergedFrom, engine.mergedColumn, engine.awakeBlocks,
      engine.pairStart, engine.islandPairs, engine.watchedPairs, engine.path, engine.foreseenPath, engine.blockPairStart,
      engine.blockPairs, engine.cursor, engine.touchingEdges, engine.force, engine.frames, engine.motion, engine.carriedMotion,
      engine.contactForce, engine.springRadius, engine.contactMetric, engine.previous, engine.carried,
      engine.blockHistory, engine.lostPartner, engine.toWake, engine.wakeRoots, engine.pushed, engine.change,
      engine.loadPath.start, engine.loadPath.pairs, engine.loadPath.blocks, engine.loadPath.parent, engine.loadPath.open,
      engine.loadPath.groups, engine.loadPath.beneath, engine.loadPath.known, engine.loadPath.supports, engine.newContactCount,
      engine.restless, engine.parent, engine.joined, engine.touched, engine.rest, engine.report, engine.frameStart,
      engine.frameStartClock, engine.savedPair, engine.chunkCounters,
      engine.chunkTimes, engine.islandCounters, engine.islandTimes, engine.islandOutcome);
  use.working += sumOf(engine.sweep.order, engine.sweep.place, engine.sweep.columns, engine.sweep.awake, engine.sweep.renewed,
                       engine.sweep.ascending, engine.sweep.outOfOrder);
  for (const MotionState& stage : engine.stage) use.working += bytesOf(stage);
  for (const ParticleArray& acceleration : engine.stageAcceleration) use.working += bytesOf(acceleration);
  for (std::size_t a = 0; a < 3; ++a) use.working += sumOf(engine.boxes.lower[a], engine.boxes.upper[a]);
  use.working += sumOf(engine.islands.blocks, engine.islands.start, engine.islands.islandOf, engine.islands.edges,
                       engine.islands.asleep, engine.islands.parent);
  for (const NewtonSystem& island : engine.newtonSystems) {
    const BlockCholesky& matrix = island.matrix;
    use.factor += sumOf(matrix.position, matrix.node, matrix.columnStart, matrix.row, matrix.targetStart, matrix.target,
                        matrix.diagonal, matrix.lower);
    use.working += sizeof(NewtonSystem) + sumOf(matrix.mark, matrix.firstChild, matrix.nextChild, matrix.edgeStart,
                                                matrix.edgeRow, matrix.work, island.touching, island.slot, island.mask,
                                                island.axes, island.residual, island.affine, island.factorTangents,
                                                island.tangents, island.coupled, island.coupledAs, island.coupledMotion,
                                                island.coupledForce, island.correction, island.kinds, island.blockClassOf,
                                                island.order.nodes, island.order.centre, island.edges, island.direction);
  }
  for (const NewtonSystem& island : engine.newtonSystems) {
    for (const DissectionSpace& space : island.order.space)
      use.working += sizeof(space) + sumOf(space.neighbourStart, space.neighbour, space.sorted, space.best, space.place,
                                           space.reach, space.change);
  }
  for (const RigidIsland& island : engine.rigidIslands) {
    const LcpWorkspace& pivoting = island.pivoting;
    use.working += sizeof(RigidIsland) + sumOf(island.bodies, island.contacts, island.movers, island.points, island.known,
                                               pivoting.matrix, pivoting.inverse, pivoting.impulse, pivoting.velocity,
                                               pivoting.least, pivoting.most, pivoting.impulseChange, pivoting.velocityChange,
                                               pivoting.column, pivoting.clamped, pivoting.placeOf);
  }
  for (const SparseFactors& sparse : engine.sparseFactors) use.factor += bytesOf(sparse);
  use.working += sumOf(engine.previousVelocity, engine.history, engine.stepVelocity, engine.target, engine.nodeOf,
                       engine.frameStartPrevious, engine.frameStartPreviousVelocity);
  use.working += engine.contacts.stepBytes();
  return use;
}

}  // namespace springtower
