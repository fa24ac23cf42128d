#pragma once

#include "core/byte_stream.h"
#include "core/scene/scene_fields.h"
#include "solver/world/snapshot.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace springtower {

// Snapshots as bytes: the members of each type (core/byte_stream.h). Working space has its size written alone, as some of it is
// sized when a matrix is laid out.

template <class Stream>
void fieldsOf(Stream& stream, ParticleArray& values) {
  auto& [component] = values;
  stream(component);
}

template <class Stream>
void fieldsOf(Stream& stream, MotionState& state) {
  auto& [position, velocity] = state;
  stream(position, velocity);
}

template <class Stream>
void fieldsOf(Stream& stream, BlockPair& pair) {
  auto& [a, b] = pair;
  stream(a, b);
}

template <class Stream>
void fieldsOf(Stream& stream, Tether& tether) {
  auto& [block, place, velocity, turn, spin, time_s, stiffness_n_m, damping_n_s_m, cornerStiffness_n_m, cornerDamping_n_s_m,
         tiltStiffness_n_m, tiltDamping_n_s_m, carried_n, carriedOnEdges_n, limit_n, line, acrossLimit_n, torqueLimit_n_m] =
      tether;
  stream(block, place, velocity, turn, spin, time_s, stiffness_n_m, damping_n_s_m, cornerStiffness_n_m, cornerDamping_n_s_m,
         tiltStiffness_n_m, tiltDamping_n_s_m, carried_n, carriedOnEdges_n, limit_n, line, acrossLimit_n, torqueLimit_n_m);
}

template <class Stream>
void fieldsOf(Stream& stream, GripForce& grip) {
  auto& [force, torque, limited, acrossLimited, turnLimited] = grip;
  stream(force, torque, limited, acrossLimited, turnLimited);
}

/// Of contacts whether there is one: in which row of the pool it lies depends on threads.
template <class Stream>
void fieldsOf(Stream& stream, PairTable& pairs) {
  auto& [key, phase, contact, clearance, travelAtCheck, axis] = pairs;
  std::vector<std::int32_t> isThere = contact;
  for (std::int32_t& row : isThere) row = std::min(row, 0);
  stream(key, phase, isThere, clearance, travelAtCheck, axis);
  if constexpr (Stream::kReads) contact = isThere;
}

template <class Stream>
void fieldsOf(Stream& stream, SlipPatch& patch) {
  auto& [u, v, shrink] = patch;
  stream(u, v, shrink);
}

template <class Stream>
void fieldsOf(Stream& stream, SleepWindow& window) {
  auto& [centre, velocity, spin, age_s] = window;
  stream(centre, velocity, spin, age_s);
}

template <class Stream>
void fieldsOf(Stream& stream, CheckedLoad& load) {
  auto& [block, force, torque] = load;
  stream(block, force, torque);
}

template <class Stream>
void fieldsOf(Stream& stream, SleepState& sleep) {
  auto& [awakeCount, movableCount, windows, gravity, checkedLoads] = sleep;
  stream(awakeCount, movableCount, windows, gravity, checkedLoads);
}

template <class Stream>
void fieldsOf(Stream& stream, SleepLoad& load) {
  auto& [force, torque] = load;
  stream(force, torque);
}

template <class Stream>
void fieldsOf(Stream& stream, ReportContact& contact) {
  auto& [first, second, firstCount, secondCount, corner, weight, normal, impulse] = contact;
  stream(first, second, firstCount, secondCount, corner, weight, normal, impulse);
}

template <class Stream>
void fieldsOf(Stream& stream, ReportState& report) {
  auto& [contacts, struck, from, to, low, high, version, testedAt] = report;
  stream(contacts, struck, from, to, low, high, version, testedAt);
}

template <class Stream>
void fieldsOf(Stream& stream, SortAndSweep::Entry& entry) {
  auto& [column, block, asleep, lower, upper] = entry;
  stream(column, block, asleep, lower, upper);
}

template <class Stream>
void fieldsOf(Stream& stream, SortAndSweep::Column& column) {
  auto& [key, begin, thickest] = column;
  stream(key, begin, thickest);
}

template <class Stream>
void fieldsOf(Stream& stream, SortAndSweep& sweep) {
  auto& [axis, order, place, columns, awake, renewed, found, ascending, outOfOrder] = sweep;
  stream(axis, order, place, columns, awake);
  if constexpr (Stream::kReads) {  // working space
    renewed.clear();
    found.clear();
    ascending.clear();
    outOfOrder.clear();
  }
}

template <class Stream>
void fieldsOf(Stream& stream, SweptBoxes& boxes) {
  auto& [lower, upper] = boxes;
  stream(lower, upper);
}

template <class Stream>
void fieldsOf(Stream& stream, Islands& islands) {
  auto& [blocks, start, islandOf, edges, asleep, parent] = islands;
  stream(blocks, start, islandOf, edges, asleep, parent);
}

template <class Stream>
void fieldsOf(Stream& stream, BlockHistory& history) {
  auto& [lastExplicitStep_s, lastImplicitStep_s, startKnown, explicitLast, hasFallen, jerk, motion, travel] = history;
  stream(lastExplicitStep_s, lastImplicitStep_s, startKnown, explicitLast, hasFallen, jerk, motion, travel);
}

template <class Stream>
void fieldsOf(Stream& stream, IslandHistory& history) {
  auto& [rigidFrames, implicitSteps, forced, rigid] = history;
  stream(rigidFrames, implicitSteps, forced, rigid);
}

template <class Stream>
void fieldsOf(Stream& stream, StepBound& bound) {
  auto& [spectralRadius, contactSignature] = bound;
  stream(spectralRadius, contactSignature);
}

template <class Stream>
void fieldsOf(Stream& stream, AffineField& field) {
  auto& [centre, side] = field;
  stream(centre, side);
}

template <class Stream>
void fieldsOf(Stream& stream, BlockFrame& frame) {
  auto& [place, dual, normal] = frame;
  stream(place, dual, normal);
}

template <class Stream>
void fieldsOf(Stream& stream, BlockSlot& slot) {
  auto& [at, firstIsRow] = slot;
  stream(at, firstIsRow);
}

template <class Stream>
void fieldsOf(Stream& stream, EliminationTasks::Source& source) {
  auto& [column, first, last] = source;
  stream(column, first, last);
}

template <class Stream>
void fieldsOf(Stream& stream, EliminationTasks& tasks) {
  auto& [columnStart, column, taskOf, firstTop, top, sourceStart, source, tallestTop] = tasks;
  stream(columnStart, column, taskOf, firstTop, top, sourceStart, source, tallestTop);
}

template <class Stream>
void fieldsOf(Stream& stream, BlockCholesky& matrix) {
  auto& [position, node, columnStart, row, targetStart, target, products, diagonal, lower, mark, firstChild, nextChild, edgeStart,
         edgeRow, work, tasks, divided, taken, isWithoutFill, ownDiagonal, ownLower] = matrix;
  stream(position, node, columnStart, row, targetStart, target, products, diagonal, lower, sizeOf(mark), sizeOf(firstChild),
         sizeOf(nextChild), sizeOf(edgeStart), sizeOf(edgeRow), sizeOf(work), tasks, sizeOf(divided), sizeOf(taken),
         isWithoutFill, ownDiagonal, ownLower);
}

template <class Stream>
void fieldsOf(Stream& stream, EliminationOrder& order) {
  auto& [nodes, centre, space] = order;
  stream(nodes, centre, sizeOf(space));
}

template <class Stream>
void fieldsOf(Stream& stream, TetherStiffness& stiffness) {
  auto& [block, centre, corner, tilt] = stiffness;
  stream(block, centre, corner, tilt);
}

template <class Stream>
void fieldsOf(Stream& stream, BlockJacobian& jacobian) {
  auto& [affine, mass, pair, triple, single, shear] = jacobian;
  stream(affine, mass, pair, triple, single, shear);
}

template <class Stream>
void fieldsOf(Stream& stream, NewtonSystem::BlockClass& blockClass) {
  auto& [dimensions, mass, edge_n_m, jacobian] = blockClass;
  stream(dimensions, mass, edge_n_m, jacobian);
}

template <class Stream>
void fieldsOf(Stream& stream, ContactTangent& tangent) {
  auto& [upper, lower, normal, dual, followsPush, upperWeight, lowerWeight, isotropic, alongNormal, alongSlip, coupling, slip,
         push] = tangent;
  const auto lanes = [&](auto&... values) { (stream.raw(&values, sizeof values), ...); };
  stream(upper, lower, normal, dual, followsPush);
  lanes(upperWeight, lowerWeight, isotropic, alongNormal, alongSlip, coupling, slip, push);
}

template <class Stream>
void fieldsOf(Stream& stream, NewtonWork& work) {
  auto& [residual, direction, affine, tangents, active, tangentStart, coupled, coupledIndex, coupledMotion, coupledForce,
         correction] = work;
  stream(sizeOf(residual), sizeOf(direction), sizeOf(affine), sizeOf(tangents), sizeOf(active), sizeOf(tangentStart),
         sizeOf(coupled), sizeOf(coupledIndex), sizeOf(coupledMotion), sizeOf(coupledForce), sizeOf(correction));
}

template <class Stream>
void fieldsOf(Stream& stream, NewtonSystem& system) {
  // It has a base with members, so no structured binding; a new member changes its size.
  static_assert(sizeof(NewtonSystem) == sizeof(NewtonWork) + 1040);
  fieldsOf(stream, static_cast<NewtonWork&>(system));
  stream(system.pattern, system.exceedsFill, system.factorised, system.step_s, system.tether, system.limited, system.directions,
         system.trialIsAhead, system.trialLags, system.isNear, system.changedIterations, system.assumesSupport,
         system.forcesKnown, system.matrix, system.touching, system.slot, system.taskPairs, system.taskPairStart, system.mask,
         system.axes, system.blockClasses, system.blockClassOf, system.jacobianStep_s, system.factorTangents, system.order,
         system.members, system.orderProducts, system.edges);
}

/// The matrix; its factors are those of it.
template <class Stream>
void fieldsOf(Stream& stream, SparseFactors& sparse) {
  using Matrix = SparseFactors::Matrix;
  using Index = Matrix::StorageIndex;
  std::int64_t size = sparse.matrix.rows();
  std::vector<Index> start;
  std::vector<Index> row;
  std::vector<double> value;
  if constexpr (!Stream::kReads) {
    if (size > 0) {
      const auto entries = sparse.matrix.nonZeros();  // compressed, as copyMatrix leaves it
      start.assign(sparse.matrix.outerIndexPtr(), sparse.matrix.outerIndexPtr() + size + 1);
      row.assign(sparse.matrix.innerIndexPtr(), sparse.matrix.innerIndexPtr() + entries);
      value.assign(sparse.matrix.valuePtr(), sparse.matrix.valuePtr() + entries);
    }
  }
  stream(sparse.analysed, size, start, row, value);
  if constexpr (Stream::kReads) {
    if (size == 0) return;
    if (size < 0 || start.size() != static_cast<std::size_t>(size) + 1 || row.size() != value.size() || start.front() != 0 ||
        start.back() != static_cast<Index>(row.size())) {
      stream.refuse("one whose lists do not fit", "a sparse matrix as it was written");
    }
    sparse.matrix =
        Eigen::Map<const Matrix>(size, size, static_cast<Eigen::Index>(row.size()), start.data(), row.data(), value.data());
    sparse.factors.compute(sparse.matrix);
  }
}

template <class Stream, class Record>
void fieldsOf(Stream& stream, ByIsland<Record>& records) {
  records.transfer(stream);
}

template <class Stream>
void fieldsOf(Stream& stream, Memo& memo) {
  auto& [sweep, boxes, travelAtSweep, sweepMargin, prepared, swept, sweptPairs, islands, topologyChanged, pairStart, islandPairs,
         blockPairStart, blockPairs, blockHistory, islandHistory, stepBound, previous, previousVelocity, carried, force, frames,
         motion, carriedMotion, newtonSystems, sparseFactors, forcesBefore, tetherForce] = memo;
  stream(sweep, boxes, travelAtSweep, sweepMargin, prepared, swept, sweptPairs, islands, topologyChanged, pairStart, islandPairs,
         blockPairStart, blockPairs, blockHistory, islandHistory, stepBound, previous, previousVelocity, carried, force, frames,
         motion, carriedMotion, newtonSystems, sparseFactors, forcesBefore, tetherForce);
}

template <class Stream>
void fieldsOf(Stream& stream, Counters& counters) {
  auto& [frames, steps, replayedFrames, blockPairs, clearanceChecks, candidateTests, boxOverlaps, planeCrossings, cubicTests,
         cubicHits, contactsCreated, contactsCreatedPenetrating, manifoldRefreshes, contactEvaluations, springEvaluations,
         implicitSteps, implicitIterations, factorisations, newtonFailures, responseIterations] = counters;
  stream(frames, steps, replayedFrames, blockPairs, clearanceChecks, candidateTests, boxOverlaps, planeCrossings, cubicTests,
         cubicHits, contactsCreated, contactsCreatedPenetrating, manifoldRefreshes, contactEvaluations, springEvaluations,
         implicitSteps, implicitIterations, factorisations, newtonFailures, responseIterations);
}

template <class Stream>
void fieldsOf(Stream& stream, StageTimes& times) {
  auto& [seconds] = times;
  stream(seconds);
}

}  // namespace springtower
