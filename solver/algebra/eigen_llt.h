#pragma once

#include "solver/algebra/block_ldlt.h"

#include <Eigen/SparseCholesky>
#include <cstddef>
#include <span>

namespace springtower {

/// Eigen's sparse Cholesky factors (L L^T, approximate minimum degree; Davis 2006) of the matrix assembled in a BlockCholesky:
/// the plain reference for the engine's own factors. In double. Eigen allocates in every factorisation and solution.
struct SparseFactors {
  using Matrix = Eigen::SparseMatrix<double>;
  Matrix matrix;                         ///< lower triangle, 12 columns a node in the order of elimination
  Eigen::SimplicialLLT<Matrix> factors;  ///< of `matrix`
  bool analysed = false;  ///< whether `factors` has analysed the present pattern; set to false when another is laid out
  Eigen::VectorXd work;   ///< right-hand sides and solutions

  SparseFactors() = default;
  ~SparseFactors() = default;
  /// Eigen's factors cannot be copied; those of the same matrix are computed anew, bit for bit the same.
  SparseFactors(const SparseFactors& other);
  SparseFactors& operator=(const SparseFactors& other);
};

/// Makes the factors of an island that is gone those of an island to come.
inline void reset(SparseFactors& sparse) {
  sparse.analysed = false;
}

/// Factorises the matrix as assembled, before `factorise` of block_ldlt.h overwrites it. `coupled` are the slots of its pairs (at
/// = -1: none); all other blocks below the diagonal are only room for fill. Returns false where the matrix is not positive
/// definite. Precondition: where `sparse.analysed`, pattern and elimination order are those of the last call.
bool factorise(const BlockCholesky& assembled, std::span<const BlockSlot> coupled, SparseFactors& sparse);

/// Solves A x = b in place; `values` holds 12 numbers a node, by node of `assembled`. Precondition: `factorise` returned true.
void solve(const BlockCholesky& assembled, SparseFactors& sparse, std::span<double> values);

/// Bytes of the matrix and its factors: a number and a row for each entry, without the index vectors of columns and orders.
std::size_t bytesOf(const SparseFactors& sparse);

}  // namespace springtower
