#pragma once

#include "core/vector.h"
#include "solver/algebra/block_ldlt.h"

#include <cstdint>
#include <span>

namespace springtower {

// Symmetric block Gauss-Seidel as preconditioner of a symmetric positive definite matrix A = L + D + L^T, L its blocks below the
// diagonal in the elimination order: M = (D + L) D^-1 (D + L)^T (Saad 2003). M = (I + L D^-1) D (I + L D^-1)^T has the form of
// factors, so `solve` of solver/algebra/block_ldlt.h solves M x = b; making them takes one product a block, whatever the order.

/// Lays out the matrix for an elimination order of nodes coupled by `edges`, without fill.
void layOutWithoutFill(std::span<const std::int32_t> order, std::span<const BlockPair> edges, BlockCholesky& matrix);

/// Keeps a copy of the matrix in `diagonal` and `lower`, and makes the factors of M of these. Returns false where a block of the
/// diagonal is not positive definite.
bool factoriseWithoutFill(BlockCholesky& matrix);

/// y = A x, both [nodes][12] by node.
void multiply(BlockCholesky& matrix, std::span<const double> x, std::span<double> y);

}  // namespace springtower
