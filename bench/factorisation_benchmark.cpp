// The tuned factorisation of an implicit step's matrix beside the plain one: Eigen's sparse Cholesky (method `implicit-eigen`
// uses it in double and in Eigen's own order: LltOrdered). The matrix has the pattern of a tower of 18 rows (54 nodes of 12
// freedoms, each coupled to the three below) and random entries that make it positive definite. Patterns are analysed before; a
// factorisation and a solution with its factors are timed, each alone.
#include "solver/algebra/block_ldlt.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <benchmark/benchmark.h>
#include <numeric>
#include <random>
#include <vector>

namespace springtower {
namespace {

constexpr std::int32_t kFactorisedRows = 18;
constexpr std::int32_t kNodes = 3 * kFactorisedRows;
constexpr auto kNode = static_cast<Eigen::Index>(kNodeSize);

struct TowerMatrix {
  BlockCholesky ours;
  Eigen::SparseMatrix<double> eigen;
};

TowerMatrix towerMatrix() {
  TowerMatrix made;
  std::vector<BlockPair> edges;
  for (std::int32_t node = 3; node < kNodes; ++node) {
    for (std::int32_t k = 0; k < 3; ++k) edges.push_back({node, 3 * (node / 3 - 1) + k});
  }
  std::vector<std::int32_t> order(kNodes);
  std::iota(order.begin(), order.end(), 0);
  analyse(order, edges, 1000000, made.ours);
  clear(made.ours);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::vector<Eigen::Triplet<double>> entries;
  const auto put = [&](std::int32_t row, std::int32_t column, const Eigen::MatrixXd& block, float* to) {
    for (Eigen::Index i = 0; i < kNode; ++i) {
      for (Eigen::Index k = 0; k < kNode; ++k) {
        to[kNode * i + k] = static_cast<float>(block(i, k));
        entries.emplace_back(kNode * row + i, kNode * column + k, block(i, k));
        if (row != column) entries.emplace_back(kNode * column + k, kNode * row + i, block(i, k));
      }
    }
  };
  const auto draw = [&] { return Eigen::MatrixXd::NullaryExpr(kNode, kNode, [&] { return number(random); }).eval(); };
  for (const BlockPair& edge : edges) {
    const BlockSlot slot = slotOf(made.ours, edge.a, edge.b);
    const Eigen::MatrixXd block = draw();
    float* const to = made.ours.lower.data() + kNodeMatrix * static_cast<std::size_t>(slot.at);
    if (slot.firstIsRow) {
      put(edge.a, edge.b, block, to);
    } else {
      put(edge.b, edge.a, block, to);
    }
  }
  for (std::int32_t node = 0; node < kNodes; ++node) {
    const Eigen::MatrixXd half = draw();
    const Eigen::MatrixXd block = half + half.transpose() + 80.0 * Eigen::MatrixXd::Identity(kNode, kNode);
    put(node, node, block, made.ours.diagonal.data() + kNodeMatrix * static_cast<std::size_t>(node));
  }
  made.eigen.resize(kNode * kNodes, kNode * kNodes);
  made.eigen.setFromTriplets(entries.begin(), entries.end());
  return made;
}

void factoriseOurs(benchmark::State& run) {
  const TowerMatrix matrix = towerMatrix();
  BlockCholesky work = matrix.ours;
  for (auto iteration : run) {
    std::copy(matrix.ours.diagonal.begin(), matrix.ours.diagonal.end(), work.diagonal.begin());
    std::copy(matrix.ours.lower.begin(), matrix.ours.lower.end(), work.lower.begin());
    if (!factorise(work)) run.SkipWithError("not positive definite");
  }
}
BENCHMARK(factoriseOurs)->Unit(benchmark::kMicrosecond);

void solveOurs(benchmark::State& run) {
  TowerMatrix matrix = towerMatrix();
  if (!factorise(matrix.ours)) run.SkipWithError("not positive definite");
  std::vector<double> values(static_cast<std::size_t>(kNode * kNodes), 1.0);
  for (auto iteration : run) {
    std::fill(values.begin(), values.end(), 1.0);
    solve(matrix.ours, values);
    benchmark::DoNotOptimize(values.data());
  }
}
BENCHMARK(solveOurs)->Unit(benchmark::kMicrosecond);

// The order of elimination that Eigen finds best (approximate minimum degree), and ours.
template <class Solver>
void factoriseEigen(benchmark::State& run) {
  using Number = typename Solver::Scalar;
  const Eigen::SparseMatrix<Number> matrix = towerMatrix().eigen.cast<Number>();
  Solver solver;
  solver.analyzePattern(matrix);
  for (auto iteration : run) {
    solver.factorize(matrix);
    if (solver.info() != Eigen::Success) run.SkipWithError("not positive definite");
  }
}
template <class Solver>
void solveEigen(benchmark::State& run) {
  using Number = typename Solver::Scalar;
  const Eigen::SparseMatrix<Number> matrix = towerMatrix().eigen.cast<Number>();
  Solver solver;
  solver.compute(matrix);
  const Eigen::Matrix<Number, Eigen::Dynamic, 1> right = Eigen::Matrix<Number, Eigen::Dynamic, 1>::Ones(matrix.rows());
  Eigen::Matrix<Number, Eigen::Dynamic, 1> values(matrix.rows());
  for (auto iteration : run) {
    values = solver.solve(right);
    benchmark::DoNotOptimize(values.data());
  }
}

using Natural = Eigen::NaturalOrdering<int>;
using LltOrdered = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>;
using LdltOrdered = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
using LltNatural = Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Natural>;
using LltFloat = Eigen::SimplicialLLT<Eigen::SparseMatrix<float>, Eigen::Lower, Natural>;
BENCHMARK_TEMPLATE(factoriseEigen, LltOrdered)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(factoriseEigen, LdltOrdered)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(factoriseEigen, LltNatural)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(factoriseEigen, LltFloat)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(solveEigen, LltOrdered)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(solveEigen, LltNatural)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(solveEigen, LltFloat)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace springtower
