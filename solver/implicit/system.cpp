#include "solver/implicit/system.h"

#include "core/hash.h"
#include "core/lanes.h"
#include "core/tuning.h"
#include "solver/algebra/gauss_seidel.h"
#include "solver/contact/evaluate_forces.h"
#include "solver/implicit/contact_matrix.h"
#include "solver/implicit/friction_tangent.h"
#include "solver/world/over_island.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace springtower {

namespace {

using Axes = std::array<std::array<double, 3>, 3>;

// Orthonormal axes of a block from its mean edges (Gram & Schmidt).
Axes axesOf(const AffineField& place) {
  Vec3 x(place.side[0][0], place.side[0][1], place.side[0][2]);
  Vec3 y(place.side[1][0], place.side[1][1], place.side[1][2]);
  x.normalize();
  y -= y.dot(x) * x;
  y.normalize();
  const Vec3 z = x.cross(y);
  return {{{x[0], x[1], x[2]}, {y[0], y[1], y[2]}, {z[0], z[1], z[2]}}};
}

// Adds a block's own matrix, rotated into the world's frame.
void addOwn(const BlockJacobian& jacobian, const Axes& axes, float* diagonal) {
  for (std::size_t p = 0; p < kAffine; ++p) {
    for (std::size_t q = 0; q < kAffine; ++q) {
      double half[3][3];
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          half[i][k] = 0.0;
          for (std::size_t j = 0; j < 3; ++j) half[i][k] += jacobian.affine[3 * p + i][3 * q + j] * axes[j][k];
        }
      }
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
          double sum = 0.0;
          for (std::size_t j = 0; j < 3; ++j) sum += axes[j][i] * half[j][k];
          diagonal[kNodeSize * (3 * p + i) + 3 * q + k] += static_cast<float>(sum);
        }
      }
    }
  }
}

// Adds all manifolds: those of tasks side by side, then those of the top.
void addManifolds(const IslandStep& step, NewtonSystem& island, double step_s) {
  if (island.taskPairs.empty()) {
    for (std::size_t at = 0; at < island.touching.size(); ++at) addContactStiffness(step, island, at, step_s);
    return;
  }
  const auto addTask = [&](std::size_t task) {
    for (std::int32_t i = island.taskPairStart[task]; i < island.taskPairStart[task + 1]; ++i)
      addContactStiffness(step, island, static_cast<std::size_t>(island.taskPairs[static_cast<std::size_t>(i)]), step_s);
  };
  const std::size_t tasks = island.matrix.tasks.count();
  forRanges(tasks, 1, true, [&](std::size_t first, std::size_t last) {
    for (std::size_t task = first; task < last; ++task) addTask(task);
  });
  addTask(tasks);
}

// Adds the hand's springs on its block; of springs at their limit only a symmetric, positive semidefinite part.
void addTether(const IslandStep& step, NewtonSystem& island, double step_s) {
  const Simulation& simulation = step.simulation;
  TetherMatrix resistance =
      tetherResistance(simulation.tether, simulation.model, simulation.state, step.time_s + step.drift_s, step_s);
  if (island.limited) {
    const Eigen::SelfAdjointEigenSolver<TetherMatrix> modes(0.5 * (resistance + resistance.transpose()));
    resistance = modes.eigenvectors() * modes.eigenvalues().cwiseMax(0.0).asDiagonal() * modes.eigenvectors().transpose();
  }
  const auto node = static_cast<std::size_t>(step.engine.scratch.nodeOf[index(island.tether.block)]);
  float* diagonal = island.matrix.diagonal.data() + kNodeMatrix * static_cast<std::size_t>(island.matrix.position[node]);
  for (std::size_t i = 0; i < kNodeSize; ++i) {
    for (std::size_t k = 0; k < kNodeSize; ++k)
      diagonal[kNodeSize * i + k] += static_cast<float>(resistance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)));
  }
}

// Makes every degree of freedom stiffer by this share of its diagonal entry.
void stiffen(float share, BlockCholesky& matrix) {
  for (std::size_t j = 0; j < matrix.nodeCount(); ++j) {
    float* block = matrix.diagonal.data() + kNodeMatrix * j;
    for (std::size_t i = 0; i < kNodeSize; ++i) block[(kNodeSize + 1) * i] *= 1.0F + share;
  }
}

// Whether a touching pair couples two nodes: neither side is the floor or asleep.
bool isCoupled(const IslandStep& step, const ManifoldShape& m) {
  const std::vector<std::uint8_t>& asleep = step.simulation.asleep;
  return m.lower >= 0 && asleep[static_cast<std::size_t>(m.upper)] == 0 && asleep[static_cast<std::size_t>(m.lower)] == 0;
}

// Fills island.touching, and island.edges with the nodes that these pairs couple.
void findEdges(const IslandStep& step, NewtonSystem& island) {
  const Engine& engine = step.engine;
  island.edges.clear();
  island.touching.clear();
  for (const std::int32_t at : step.pairs) {
    if (!engine.pairs.touches(static_cast<std::size_t>(at))) continue;
    const ManifoldShape m = shapeOf(engine, static_cast<std::size_t>(at));
    island.touching.push_back(at);
    if (!isCoupled(step, m)) continue;
    island.edges.push_back(
        {engine.scratch.nodeOf[static_cast<std::size_t>(m.upper)], engine.scratch.nodeOf[static_cast<std::size_t>(m.lower)]});
  }
}

void listCentres(const IslandStep& step, EliminationOrder& order) {
  order.centre.clear();
  for (const std::int32_t block : step.blocks)
    order.centre.push_back(centre(step.simulation.state.position, static_cast<std::size_t>(block)));
}

// Finds the elimination order and the pattern of the factors: from the bottom up, or by dissection where that gives less fill.
// Returns false where both take too many products.
bool findOrder(NewtonSystem& island) {
  const auto fits = [&](std::size_t mostProducts) {
    return findPattern(island.order.nodes, island.edges, mostProducts, island.matrix);
  };
  orderBottomUp(island.order);
  const bool bandFits = fits(tuning::kMaxFillProducts);
  if (island.order.centre.size() <= tuning::kNarrowBlocks) return bandFits;
  const std::size_t products = bandFits ? island.matrix.products : tuning::kMaxFillProducts;
  orderByDissection(island.edges, island.order);
  if (fits(products)) return true;
  orderBottomUp(island.order);
  return bandFits && fits(tuning::kMaxFillProducts);
}

// The order from the bottom up, of matrices without fill.
void layOutMatrixWithoutFill(const IslandStep& step, NewtonSystem& island) {
  listCentres(step, island.order);
  orderBottomUp(island.order);
  layOutWithoutFill(island.order.nodes, island.edges, island.matrix);
  island.members = 0;
}

// Lays out the matrix for island.edges; false where it would take too many products. A wide island keeps its elimination order
// while its blocks are the same, and the whole layout while that has room for all edges: contacts come and go far more often than
// the best order changes. `members` is a hash of the blocks.
bool layOutMatrix(const IslandStep& step, NewtonSystem& island, std::uint64_t members) {
  BlockCholesky& matrix = island.matrix;
  const bool known = island.members == members && step.blocks.size() > tuning::kNarrowBlocks;
  if (known && holds(matrix, island.edges)) return true;
  if (known && analyse(island.order.nodes, island.edges, tuning::kMaxFillProducts, matrix) &&
      static_cast<double>(matrix.products) <= tuning::kMaxFillGrowth * static_cast<double>(island.orderProducts))
    return true;
  island.members = 0;
  listCentres(step, island.order);
  if (!findOrder(island)) return false;
  listUpdates(matrix);
  island.members = members;
  island.orderProducts = matrix.products;
  return true;
}

// The task of a touching pair: that of its blocks' nodes, or of the top, which is last, where one of them lies there.
std::size_t taskOf(const IslandStep& step, const NewtonSystem& island, std::int32_t pair) {
  const EliminationTasks& tasks = island.matrix.tasks;
  const ManifoldShape m = shapeOf(step.engine, static_cast<std::size_t>(pair));
  std::size_t task = 0;
  for (const std::int32_t block : {m.upper, m.lower}) {
    if (block < 0 || step.simulation.asleep[static_cast<std::size_t>(block)] != 0) continue;
    const std::int32_t node = step.engine.scratch.nodeOf[static_cast<std::size_t>(block)];
    const auto column = static_cast<std::size_t>(island.matrix.position[static_cast<std::size_t>(node)]);
    task = std::max(task, tasks.isTop(column) ? tasks.count() : static_cast<std::size_t>(tasks.taskOf[column]));
  }
  return task;
}

// Lists touching pairs by task, so that tasks add them to the matrix side by side: no two share a node but in the top.
void listByTask(const IslandStep& step, NewtonSystem& island) {
  std::vector<std::int32_t>& start = island.taskPairStart;
  island.taskPairs.clear();
  start.clear();
  if (island.matrix.tasks.empty()) return;
  start.assign(island.matrix.tasks.count() + 3, 0);
  for (const std::int32_t pair : island.touching) ++start[taskOf(step, island, pair) + 2];
  std::partial_sum(start.begin(), start.end(), start.begin());
  island.taskPairs.resize(island.touching.size());
  for (std::size_t at = 0; at < island.touching.size(); ++at) {
    std::int32_t& next = start[taskOf(step, island, island.touching[at]) + 1];
    island.taskPairs[static_cast<std::size_t>(next++)] = static_cast<std::int32_t>(at);
  }
  start.pop_back();
}

void findSlots(const IslandStep& step, NewtonSystem& island) {
  const Engine& engine = step.engine;
  island.slot.clear();
  for (const std::int32_t at : island.touching) {
    const ManifoldShape m = shapeOf(engine, static_cast<std::size_t>(at));
    island.slot.push_back(isCoupled(step, m) ? slotOf(island.matrix, engine.scratch.nodeOf[static_cast<std::size_t>(m.upper)],
                                                      engine.scratch.nodeOf[static_cast<std::size_t>(m.lower)])
                                             : BlockSlot{});
  }
}

}  // namespace

void layOutWork(NewtonSystem& island) {
  const std::size_t count = island.axes.size();
  island.residual.resize(count);
  island.direction.resize(count);
  island.affine.resize(kNodeSize * count);
}

void layOut(IslandStep& step, NewtonSystem& island) {
  Engine& engine = step.engine;
  const std::vector<std::uint8_t>& asleep = step.simulation.asleep;
  Hash hash;
  hash.word(step.withoutFill ? 1U : 0U);
  for (const std::int32_t block : step.blocks) hash.word(static_cast<std::uint64_t>(block));
  const std::uint64_t members = hash.value();
  for (const std::int32_t at : step.pairs) {
    if (!engine.pairs.touches(static_cast<std::size_t>(at))) continue;
    const ManifoldShape m = shapeOf(engine, static_cast<std::size_t>(at));
    hash.word(static_cast<std::uint64_t>(m.upper) << 32U | static_cast<std::uint32_t>(m.lower));
    hash.word(static_cast<std::uint64_t>(at));
    if (m.lower >= 0) {
      hash.word(std::uint64_t{asleep[static_cast<std::size_t>(m.upper)]} << 1U | asleep[static_cast<std::size_t>(m.lower)]);
    }
  }
  // A block may have been in another island since this layout was made, so its index in the island is written every time.
  const std::size_t count = step.blocks.size();
  for (std::size_t i = 0; i < count; ++i)
    engine.scratch.nodeOf[static_cast<std::size_t>(step.blocks[i])] = static_cast<std::int32_t>(i);
  const std::uint64_t pattern = hash.value();
  if (pattern == island.pattern) return;

  findEdges(step, island);
  island.pattern = pattern;
  island.factorised = false;
  if (engine.memo.sparseFactors.isUsed()) engine.memo.sparseFactors.of(step.blocks.front()).analysed = false;
  island.exceedsFill = !step.withoutFill && !layOutMatrix(step, island, members);
  if (step.withoutFill) layOutMatrixWithoutFill(step, island);
  if (island.exceedsFill) return;
  findSlots(step, island);
  listByTask(step, island);
  island.mask.assign(island.touching.size(), 0);
  island.axes.resize(count);
  layOutWork(island);
}

TetherStiffness tetherStiffness(const IslandStep& step, double step_s) {
  if (!holdsTether(step)) return {};
  const Tether& tether = step.simulation.tether;
  return {tether.block, tether.stiffness_n_m + tether.damping_n_s_m / step_s,
          tether.cornerStiffness_n_m + tether.cornerDamping_n_s_m / step_s,
          tether.tiltStiffness_n_m + tether.tiltDamping_n_s_m / step_s};
}

bool isTetherLimited(const IslandStep& step) {
  const GripForce& now = step.engine.memo.tetherForce;
  return holdsTether(step) && (now.limited || now.acrossLimited || now.turnLimited);
}

namespace {

// The matrix M / step^2 + K, with every degree of freedom stiffer by this share.
void fillMatrix(IslandStep& step, NewtonSystem& island, double step_s, float stiffer) {
  clear(island.matrix);
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      island.axes[i] = axesOf(step.engine.memo.frames[static_cast<std::size_t>(step.blocks[i])].place);
      addOwn(jacobianOf(island, i), island.axes[i],
             island.matrix.diagonal.data() + kNodeMatrix * static_cast<std::size_t>(island.matrix.position[i]));
    }
  });
  addManifolds(step, island, step_s);
  if (island.tether.block != kFloor) addTether(step, island, step_s);
  if (stiffer > 0.0F) stiffen(stiffer, island.matrix);
}

bool factoriseMatrix(IslandStep& step, NewtonSystem& island) {
  ++step.counters.factorisations;
  if (island.matrix.isWithoutFill) return island.factorised = factoriseWithoutFill(island.matrix);
  ByIsland<SparseFactors>& sparse = step.engine.memo.sparseFactors;
  island.factorised =
      !sparse.isUsed() ? factorise(island.matrix) : factorise(island.matrix, island.slot, sparse.of(step.blocks.front()));
  return island.factorised;
}

// The share by which the diagonal is stiffer at the next try.
float nextShare(const IslandStep& step) {
  return std::max(tuning::kDiagonalRounding, tuning::kDiagonalGrowth * step.diagonalShare);
}

}  // namespace

bool assemble(IslandStep& step, NewtonSystem& island, double step_s) {
  island.tether = tetherStiffness(step, step_s);
  island.limited = isTetherLimited(step);
  island.step_s = step_s;
  island.directions = 0;
  findFactorTangents(step, island, step_s);
  // In the long steps from rest the inertia is smaller than the rounding error of stiff contacts, and a pivot may turn out
  // negative, as in the widest pyramids. Then the diagonal is made stiffer, by the least share that helps. The next factorisation
  // begins one try below what this one needed.
  step.diagonalShare /= tuning::kDiagonalGrowth;
  if (step.diagonalShare < tuning::kDiagonalRounding) step.diagonalShare = 0.0F;
  for (;;) {
    fillMatrix(step, island, step_s, step.diagonalShare);
    if (factoriseMatrix(step, island)) return true;
    const float next = nextShare(step);
    if (!step.unforced || next > tuning::kMaxDiagonalRounding) return false;
    step.diagonalShare = next;
  }
}

void stiffenDiagonal(IslandStep& step) {
  if (step.diagonalShare > tuning::kMaxShortLineShare) return;
  step.diagonalShare =
      tuning::kDiagonalGrowth * std::min(nextShare(step), tuning::kMaxShortLineShare);  // assemble() divides by the growth first
}

void solve(IslandStep& step, NewtonSystem& island) {
  ByIsland<SparseFactors>& sparse = step.engine.memo.sparseFactors;
  if (!sparse.isUsed()) {
    solve(island.matrix, island.affine);
  } else {
    solve(island.matrix, sparse.of(step.blocks.front()), island.affine);
  }
}

}  // namespace springtower
