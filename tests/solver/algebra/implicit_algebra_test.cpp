#include "solver/algebra/block_ldlt.h"
#include "solver/algebra/eigen_llt.h"
#include "solver/algebra/elimination_order.h"
#include "solver/algebra/gauss_seidel.h"
#include "solver/block/inertia.h"
#include "solver/block/modes.h"
#include "solver/block/springs.h"
#include "tests/support/block_scenes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <random>
#include <vector>

namespace springtower {
namespace {

constexpr std::size_t kNoLimit = 1000000;
constexpr Eigen::Index kNode = static_cast<Eigen::Index>(kNodeSize);

// Nodes coupled as the blocks of a tower of rows of three: each to the three below.
std::vector<BlockPair> towerEdges(std::int32_t rows) {
  std::vector<BlockPair> edges;
  for (std::int32_t row = 1; row < rows; ++row) {
    for (std::int32_t i = 0; i < 3; ++i) {
      for (std::int32_t k = 0; k < 3; ++k) edges.push_back({3 * row + i, 3 * (row - 1) + k});
    }
  }
  return edges;
}

// A random matrix of that pattern, diagonally dominant and so positive definite; stored in `matrix` and returned as a dense one.
Eigen::MatrixXd randomMatrix(const std::vector<BlockPair>& edges, BlockCholesky& matrix) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto count = static_cast<Eigen::Index>(matrix.nodeCount());
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(kNode * count, kNode * count);
  const auto draw = [&] { return Eigen::MatrixXd::NullaryExpr(kNode, kNode, [&] { return number(random); }); };
  clear(matrix);
  const auto put = [](const Eigen::MatrixXd& block, float* to) {
    for (Eigen::Index i = 0; i < kNode; ++i) {
      for (Eigen::Index k = 0; k < kNode; ++k) to[kNode * i + k] = static_cast<float>(block(i, k));
    }
  };
  for (const BlockPair& edge : edges) {
    const Eigen::MatrixXd block = draw();
    full.block(kNode * edge.a, kNode * edge.b, kNode, kNode) = block;
    full.block(kNode * edge.b, kNode * edge.a, kNode, kNode) = block.transpose();
    const BlockSlot slot = slotOf(matrix, edge.a, edge.b);
    EXPECT_GE(slot.at, 0);
    put(slot.firstIsRow ? block : Eigen::MatrixXd(block.transpose()),
        matrix.lower.data() + kNodeMatrix * static_cast<std::size_t>(slot.at));
  }
  for (Eigen::Index n = 0; n < count; ++n) {
    const Eigen::MatrixXd half = draw();
    const Eigen::MatrixXd block = half + half.transpose() + 80.0 * Eigen::MatrixXd::Identity(kNode, kNode);
    full.block(kNode * n, kNode * n, kNode, kNode) = block;
    put(block, matrix.diagonal.data() + kNodeMatrix * static_cast<std::size_t>(matrix.position[static_cast<std::size_t>(n)]));
  }
  return full;
}

constexpr std::int32_t kWideRows = 100;

// The pattern of a tower of so many rows, whose matrix is eliminated in tasks.
BlockCholesky dissectedTower(const std::vector<BlockPair>& edges) {
  EliminationOrder order;
  for (std::int32_t node = 0; node < 3 * kWideRows; ++node) order.centre.emplace_back(node % 3, 0.0, node / 3);
  orderByDissection(edges, order);
  BlockCholesky matrix;
  EXPECT_TRUE(analyse(order.nodes, edges, kNoLimit, matrix));
  return matrix;
}

// In float with some hundred additions an entry: 1e-5 of the largest entry of the solution.
TEST(BlockCholesky, SolvesAsADenseFactorisationDoes) {
  const std::int32_t rows = 7;
  std::vector<std::int32_t> order(static_cast<std::size_t>(3 * rows));
  std::iota(order.begin(), order.end(), 0);
  for (const bool shuffled : {false, true}) {
    if (shuffled) std::shuffle(order.begin(), order.end(), std::mt19937_64(2));
    const std::vector<BlockPair> edges = towerEdges(rows);
    BlockCholesky matrix;
    ASSERT_TRUE(analyse(order, edges, kNoLimit, matrix));
    const Eigen::MatrixXd full = randomMatrix(edges, matrix);
    Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(full.rows(), -1.0, 1.0);
    const Eigen::VectorXd expected = full.ldlt().solve(values);
    ASSERT_TRUE(factorise(matrix));
    solve(matrix, {values.data(), static_cast<std::size_t>(values.size())});
    EXPECT_LT((values - expected).cwiseAbs().maxCoeff(), 1e-5 * expected.cwiseAbs().maxCoeff()) << "shuffled " << shuffled;
  }
}

// A wide matrix is eliminated in tasks, with the same bits on any number of threads: a tower of 100 rows in an order that
// dissects it, which has a top above tasks. The residual is that of float: 1e-5 of the right-hand side.
TEST(BlockCholesky, AWideMatrixHasTheSameBitsOnAnyNumberOfThreads) {
  const std::vector<BlockPair> edges = towerEdges(kWideRows);
  BlockCholesky matrix = dissectedTower(edges);
  EXPECT_GE(matrix.tasks.count(), 8U);
  EXPECT_GE(matrix.tasks.top.size(), 9U);
  const Eigen::MatrixXd full = randomMatrix(edges, matrix);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(full.rows(), -1.0, 1.0);
  std::vector<Eigen::VectorXd> solutions;
  for (const std::size_t threads : {1U, 2U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    tbb::task_arena arena(static_cast<int>(threads));
    arena.execute([&] {
      BlockCholesky work = matrix;
      EXPECT_TRUE(factorise(work));
      solutions.push_back(right);
      solve(work, {solutions.back().data(), static_cast<std::size_t>(right.size())});
    });
    EXPECT_LT((full * solutions.back() - right).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_EQ(solutions.back(), solutions.front()) << threads << " threads";
  }
}

// The diagonal blocks of a matrix, and its blocks below them in the order of elimination.
struct Parts {
  Eigen::MatrixXd diagonal;
  Eigen::MatrixXd lower;
};

Parts partsOf(const Eigen::MatrixXd& full, const BlockCholesky& matrix) {
  Parts parts{Eigen::MatrixXd::Zero(full.rows(), full.rows()), Eigen::MatrixXd::Zero(full.rows(), full.rows())};
  const auto count = static_cast<Eigen::Index>(matrix.nodeCount());
  for (Eigen::Index row = 0; row < count; ++row) {
    for (Eigen::Index column = 0; column < count; ++column) {
      const std::int32_t p = matrix.position[static_cast<std::size_t>(row)];
      const std::int32_t q = matrix.position[static_cast<std::size_t>(column)];
      if (p < q) continue;
      (p == q ? parts.diagonal : parts.lower).block(kNode * row, kNode * column, kNode, kNode) =
          full.block(kNode * row, kNode * column, kNode, kNode);
    }
  }
  return parts;
}

// M = (D + L) D^-1 (D + L)^T in place of the matrix D + L + L^T, for any order, with a block for each edge and no more. In float,
// with some dozens of additions an entry: 1e-5 of the largest entry.
TEST(GaussSeidel, SolvesAndMultipliesAsDenseMatricesDo) {
  const std::vector<BlockPair> edges = towerEdges(7);
  std::vector<std::int32_t> order(21);
  std::iota(order.begin(), order.end(), 0);
  for (const bool shuffled : {false, true}) {
    if (shuffled) std::shuffle(order.begin(), order.end(), std::mt19937_64(2));
    BlockCholesky matrix;
    std::vector<BlockPair> twice = edges;  // two contacts between the same blocks
    twice.push_back(edges.front());
    layOutWithoutFill(order, twice, matrix);
    EXPECT_EQ(matrix.blockCount(), edges.size());
    const Eigen::MatrixXd full = randomMatrix(edges, matrix);
    const Parts parts = partsOf(full, matrix);
    const Eigen::MatrixXd half = parts.diagonal + parts.lower;
    ASSERT_TRUE(factoriseWithoutFill(matrix));

    Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(full.rows(), -1.0, 1.0);
    const Eigen::VectorXd expected =
        half.transpose().partialPivLu().solve(Eigen::VectorXd(parts.diagonal * half.partialPivLu().solve(values)));
    Eigen::VectorXd product(values.size());
    multiply(matrix, {values.data(), static_cast<std::size_t>(values.size())},
             {product.data(), static_cast<std::size_t>(values.size())});
    const Eigen::VectorXd exact = full * values;
    EXPECT_LT((product - exact).cwiseAbs().maxCoeff(), 1e-5 * exact.cwiseAbs().maxCoeff()) << "shuffled " << shuffled;
    solve(matrix, {values.data(), static_cast<std::size_t>(values.size())});
    EXPECT_LT((values - expected).cwiseAbs().maxCoeff(), 1e-5 * expected.cwiseAbs().maxCoeff()) << "shuffled " << shuffled;
  }
}

TEST(GaussSeidel, RefusesADiagonalBlockThatIsNotPositive) {
  const std::vector<BlockPair> edges = towerEdges(2);
  std::vector<std::int32_t> order(6);
  std::iota(order.begin(), order.end(), 0);
  BlockCholesky matrix;
  layOutWithoutFill(order, edges, matrix);
  randomMatrix(edges, matrix);
  matrix.diagonal[kNodeMatrix * 4] = -1.0F;
  EXPECT_FALSE(factoriseWithoutFill(matrix));
}

// What fills in is the smaller the farther apart two blocks are: coupled by 1e-13 of their diagonal, neighbours of neighbours of
// neighbours would have 1e-39, below the normal numbers of float. Such fill is zero, on any thread, and the caller computes with
// denormal numbers as before.
TEST(BlockCholesky, FillsInWithoutDenormalNumbers) {
  const std::vector<BlockPair> edges = towerEdges(kWideRows);
  BlockCholesky matrix = dissectedTower(edges);
  randomMatrix(edges, matrix);
  for (float& entry : matrix.lower) entry *= 1e-13F;
  const auto isDenormal = [](float value) { return std::fpclassify(value) == FP_SUBNORMAL; };
  for (const std::size_t threads : {1U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    tbb::task_arena arena(static_cast<int>(threads));
    arena.execute([&] {
      BlockCholesky work = matrix;
      EXPECT_TRUE(factorise(work));
      EXPECT_TRUE(std::none_of(work.lower.begin(), work.lower.end(), isDenormal)) << threads << " threads";
    });
  }
  volatile double least = std::numeric_limits<double>::min();
  EXPECT_GT(0.5 * least, 0.0) << "flushes only inside";
}

// In double, for a matrix rounded to float; a copy gives the same bits.
TEST(SparseFactors, SolveAsADenseFactorisationDoes) {
  const std::int32_t rows = 7;
  std::vector<std::int32_t> order(static_cast<std::size_t>(3 * rows));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937_64(2));
  const std::vector<BlockPair> edges = towerEdges(rows);
  BlockCholesky matrix;
  ASSERT_TRUE(analyse(order, edges, kNoLimit, matrix));
  const Eigen::MatrixXd full = randomMatrix(edges, matrix).cast<float>().cast<double>();
  std::vector<BlockSlot> slots(1);  // of a contact with the floor
  for (const BlockPair& edge : edges) slots.push_back(slotOf(matrix, edge.a, edge.b));
  SparseFactors factors;
  ASSERT_TRUE(factorise(matrix, slots, factors));
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(full.rows(), -1.0, 1.0);
  const Eigen::VectorXd expected = full.ldlt().solve(right);
  Eigen::VectorXd values = right;
  solve(matrix, factors, {values.data(), static_cast<std::size_t>(values.size())});
  EXPECT_LT((values - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
  SparseFactors copy(factors);
  Eigen::VectorXd again = right;
  solve(matrix, copy, {again.data(), static_cast<std::size_t>(again.size())});
  EXPECT_EQ(again, values);
  matrix.diagonal[kNodeMatrix * 4 + kNodeSize * 3 + 3] = -80.0F;
  EXPECT_FALSE(factorise(matrix, slots, factors)) << "not positive definite";
}

TEST(BlockCholesky, ReportsAMatrixThatIsNotPositiveDefinite) {
  const std::vector<BlockPair> edges = towerEdges(3);
  std::vector<std::int32_t> order(9);
  std::iota(order.begin(), order.end(), 0);
  BlockCholesky matrix;
  ASSERT_TRUE(analyse(order, edges, kNoLimit, matrix));
  randomMatrix(edges, matrix);
  matrix.diagonal[kNodeMatrix * 4 + kNodeSize * 3 + 3] = -80.0F;
  EXPECT_FALSE(factorise(matrix));
}

// Eliminated bottom up, the matrix of a tower is a band three blocks wide: the only fill is between the blocks of a row.
TEST(BlockCholesky, ATowerFillsInNoMoreThanItsRows) {
  const std::int32_t rows = 10;
  std::vector<std::int32_t> order(static_cast<std::size_t>(3 * rows));
  std::iota(order.begin(), order.end(), 0);
  BlockCholesky matrix;
  ASSERT_TRUE(analyse(order, towerEdges(rows), kNoLimit, matrix));
  EXPECT_EQ(matrix.blockCount(), static_cast<std::size_t>((rows - 1) * 9 + (rows - 1) * 3));
  EXPECT_FALSE(analyse(order, towerEdges(rows), 100, matrix)) << "more than a hundred products";
}

struct JacobianTest : ::testing::TestWithParam<Inertia> {};

std::pair<std::size_t, Eigen::Index> at(Eigen::Index i) {
  return {static_cast<std::size_t>(i / 3), i % 3};
}

// The block's 24 x 24 matrix: its springs differentiated by central differences, and its mass.
Eigen::MatrixXd fullMatrix(const Simulation& simulation, Inertia inertia, double rate, double springFactor) {
  const std::vector<std::int32_t> blocks = {0};
  const std::vector<AffineField> none(1);
  const auto forces = [&](Eigen::Index moved, double by) {
    MotionState state = simulation.state;
    Vec3 x = state.position.at(0, at(moved).first);
    x[at(moved).second] += by;
    state.position.set(0, at(moved).first, x);
    ParticleArray force;
    force.resize(1);
    springForces(simulation.model, state, blocks, none, force);
    Eigen::VectorXd values(24);
    for (Eigen::Index i = 0; i < 24; ++i) values[i] = force.at(0, at(i).first)[at(i).second];
    return values;
  };
  const double step = 1e-8;
  Eigen::MatrixXd full(24, 24);
  for (Eigen::Index i = 0; i < 24; ++i) full.col(i) = springFactor * (forces(i, -step) - forces(i, step)) / (2.0 * step);
  ParticleArray unit[2];
  for (Eigen::Index i = 0; i < 24; ++i) {
    for (Eigen::Index k = 0; k < 24; ++k) {
      for (ParticleArray& field : unit) {
        field = ParticleArray{};
        field.resize(1);
      }
      unit[0].set(0, at(i).first, Vec3::Unit(at(i).second));
      unit[1].set(0, at(k).first, Vec3::Unit(at(k).second));
      full(i, k) += rate * simulation.model.mass[0] * massProduct(inertia, unit[0], unit[1], 0);
    }
  }
  return full;
}

// Against the block's 24 x 24 matrix, with its springs differentiated by central differences: with steps of 1e-7 of the block
// these are accurate to 1e-7.
TEST_P(JacobianTest, SolvesAsTheFullMatrixDoes) {
  Scene scene = oneBlockScene(false);
  scene.settings.inertia = GetParam();
  Simulation simulation(scene);
  const double rate = 1.0 / (3e-3 * 3e-3);
  const double springFactor = 1.01;
  const Eigen::MatrixXd full = fullMatrix(simulation, GetParam(), rate, springFactor);
  Eigen::VectorXd load(24);
  ParticleArray force;
  force.resize(1);
  for (std::size_t c = 0; c < kCorners; ++c) {
    const double d = static_cast<double>(c);
    const Vec3 f(1.0 + 0.3 * d, -0.7 * d * d, 2.0 - std::sin(d));
    force.set(0, c, f);
    load.segment<3>(3 * static_cast<Eigen::Index>(c)) = f;
  }
  const Eigen::VectorXd expected = full.fullPivLu().solve(load);

  const BlockJacobian jacobian = blockJacobian(simulation.model, GetParam(), 0, rate, springFactor);
  ModeVectors residual;
  modeForces(force, 0, residual);
  ModeVectors reduced = residual;
  eliminateWarps(jacobian, reduced);
  Eigen::Matrix<double, 12, 12> matrix;
  Eigen::Matrix<double, 12, 1> right;
  for (std::size_t i = 0; i < kAffineFreedoms; ++i) {
    right[static_cast<Eigen::Index>(i)] = reduced[i / 3][i % 3];
    for (std::size_t k = 0; k < kAffineFreedoms; ++k)
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = jacobian.affine[i][k];
  }
  const Eigen::Matrix<double, 12, 1> affine = matrix.ldlt().solve(right);
  ModeVectors change{};
  for (std::size_t i = 0; i < kAffineFreedoms; ++i) change[i / 3][i % 3] = affine[static_cast<Eigen::Index>(i)];
  recoverWarps(jacobian, residual, change);
  ParticleArray moved;
  moved.resize(1);
  addModes(change, moved, 0);
  for (Eigen::Index i = 0; i < 24; ++i) {
    EXPECT_NEAR(moved.at(0, at(i).first)[at(i).second], expected[i], 1e-5 * expected.cwiseAbs().maxCoeff()) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Inertias, JacobianTest, ::testing::Values(Inertia::cuboid, Inertia::lumped),
                         [](const auto& tested) { return std::string(nameOf(tested.param)); });

}  // namespace
}  // namespace springtower
