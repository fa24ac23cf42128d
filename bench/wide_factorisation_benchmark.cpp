// Factors and solutions of a wide island's matrix: that of a pyramid of blocks, each coupled to the two below and to its
// neighbours in the row, eliminated by nested dissection. In tasks (on all threads) beside column by column (on one).
#include "solver/algebra/block_ldlt.h"
#include "solver/algebra/elimination_order.h"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <random>
#include <vector>

namespace springtower {
namespace {

BlockCholesky pyramidMatrix(std::int32_t base) {
  EliminationOrder order;
  std::vector<BlockPair> edges;
  std::int32_t below = -1;  // first node of the row below
  for (std::int32_t row = 0; row < base; ++row) {
    const auto first = static_cast<std::int32_t>(order.centre.size());
    for (std::int32_t k = 0; k < base - row; ++k) {
      order.centre.emplace_back(k + 0.5 * row, 0.0, row);
      if (k > 0) edges.push_back({first + k, first + k - 1});
      if (row == 0) continue;
      edges.push_back({first + k, below + k});
      edges.push_back({first + k, below + k + 1});
    }
    below = first;
  }
  orderByDissection(edges, order);
  BlockCholesky matrix;
  analyse(order.nodes, edges, 100'000'000, matrix);
  clear(matrix);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> number(-1.0F, 1.0F);
  for (const BlockPair& edge : edges) {
    float* block = matrix.lower.data() + kNodeMatrix * static_cast<std::size_t>(slotOf(matrix, edge.a, edge.b).at);
    std::generate_n(block, kNodeMatrix, [&] { return number(random); });
  }
  for (std::size_t node = 0; node < matrix.nodeCount(); ++node) {
    for (std::size_t k = 0; k < kNodeSize; ++k) matrix.diagonal[kNodeMatrix * node + (kNodeSize + 1) * k] = 100.0F;
  }
  return matrix;
}

void factorisePyramid(benchmark::State& run) {
  const BlockCholesky matrix = pyramidMatrix(static_cast<std::int32_t>(run.range(0)));
  BlockCholesky work = matrix;
  if (run.range(1) == 0) work.tasks = {};
  for (auto iteration : run) {
    run.PauseTiming();
    std::copy(matrix.diagonal.begin(), matrix.diagonal.end(), work.diagonal.begin());
    std::copy(matrix.lower.begin(), matrix.lower.end(), work.lower.begin());
    run.ResumeTiming();
    if (!factorise(work)) run.SkipWithError("not positive definite");
  }
}

void solvePyramid(benchmark::State& run) {
  BlockCholesky matrix = pyramidMatrix(static_cast<std::int32_t>(run.range(0)));
  if (run.range(1) == 0) matrix.tasks = {};
  if (!factorise(matrix)) run.SkipWithError("not positive definite");
  std::vector<double> values(kNodeSize * matrix.nodeCount(), 1.0);
  for (auto iteration : run) {
    std::fill(values.begin(), values.end(), 1.0);
    solve(matrix, values);
    benchmark::DoNotOptimize(values.data());
  }
}

void sizes(benchmark::internal::Benchmark* cases) {
  cases->ArgNames({"base", "tasks"})->ArgsProduct({{40, 60, 100}, {0, 1}});
  cases->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
}
BENCHMARK(factorisePyramid)->Apply(sizes);
BENCHMARK(solvePyramid)->Apply(sizes);

}  // namespace
}  // namespace springtower
