#include "solver/algebra/eigen_llt.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace springtower {

namespace {

constexpr auto kNode = static_cast<Eigen::Index>(kNodeSize);

// The lower triangle by columns.
void copyMatrix(const BlockCholesky& assembled, std::span<const BlockSlot> coupled, SparseFactors::Matrix& matrix) {
  std::vector<std::uint8_t> used(assembled.blockCount(), 0);
  for (const BlockSlot& slot : coupled) {
    if (slot.at >= 0) used[static_cast<std::size_t>(slot.at)] = 1;
  }
  const auto size = kNode * static_cast<Eigen::Index>(assembled.nodeCount());
  matrix.resize(size, size);
  const auto blocks = static_cast<Eigen::Index>(std::count(used.begin(), used.end(), 1));
  matrix.reserve(size * (kNode + 1) / 2 + blocks * kNode * kNode);
  for (std::size_t j = 0; j < assembled.nodeCount(); ++j) {
    const float* diagonal = assembled.diagonal.data() + kNodeMatrix * j;
    for (std::size_t c = 0; c < kNodeSize; ++c) {
      const auto column = static_cast<Eigen::Index>(kNodeSize * j + c);
      matrix.startVec(column);
      for (std::size_t r = c; r < kNodeSize; ++r) {
        matrix.insertBack(static_cast<Eigen::Index>(kNodeSize * j + r), column) =
            static_cast<double>(diagonal[kNodeSize * r + c]);
      }
      const auto last = static_cast<std::size_t>(assembled.columnStart[j + 1]);
      for (auto i = static_cast<std::size_t>(assembled.columnStart[j]); i < last; ++i) {
        if (used[i] == 0) continue;
        const float* block = assembled.lower.data() + kNodeMatrix * i;
        const auto row = kNode * assembled.row[i];
        for (std::size_t r = 0; r < kNodeSize; ++r) {
          matrix.insertBack(row + static_cast<Eigen::Index>(r), column) = static_cast<double>(block[kNodeSize * r + c]);
        }
      }
    }
  }
  matrix.finalize();
}

}  // namespace

SparseFactors::SparseFactors(const SparseFactors& other) : matrix(other.matrix), analysed(other.analysed) {
  if (matrix.rows() > 0) factors.compute(matrix);
}

SparseFactors& SparseFactors::operator=(const SparseFactors& other) {
  if (this == &other) return *this;
  matrix = other.matrix;
  analysed = other.analysed;
  if (matrix.rows() > 0) factors.compute(matrix);
  return *this;
}

bool factorise(const BlockCholesky& assembled, std::span<const BlockSlot> coupled, SparseFactors& sparse) {
  copyMatrix(assembled, coupled, sparse.matrix);
  if (!sparse.analysed) sparse.factors.analyzePattern(sparse.matrix);
  sparse.analysed = true;
  sparse.factors.factorize(sparse.matrix);
  return sparse.factors.info() == Eigen::Success;
}

void solve(const BlockCholesky& assembled, SparseFactors& sparse, std::span<double> values) {
  sparse.work.resize(sparse.matrix.rows());
  const auto inOrder = [&](std::size_t j) { return sparse.work.data() + kNodeSize * j; };
  const auto byNode = [&](std::size_t j) { return values.data() + kNodeSize * static_cast<std::size_t>(assembled.node[j]); };
  for (std::size_t j = 0; j < assembled.nodeCount(); ++j) std::copy_n(byNode(j), kNodeSize, inOrder(j));
  sparse.work = sparse.factors.solve(sparse.work).eval();
  for (std::size_t j = 0; j < assembled.nodeCount(); ++j) std::copy_n(inOrder(j), kNodeSize, byNode(j));
}

std::size_t bytesOf(const SparseFactors& sparse) {
  if (sparse.matrix.rows() == 0) return 0;
  const Eigen::Index entries = sparse.matrix.nonZeros() + sparse.factors.matrixL().nestedExpression().nonZeros();
  return static_cast<std::size_t>(entries) * (sizeof(double) + sizeof(SparseFactors::Matrix::StorageIndex));
}

}  // namespace springtower
