#pragma once

#include "core/vector.h"
#include "solver/algebra/block_ldlt.h"

#include <cstdint>
#include <span>

namespace springtower {

// A symmetric positive definite matrix A = L + D + L^T without fill, L its blocks below the diagonal in the elimination order,
// and in place of its factors those of symmetric block Gauss-Seidel, M = (D + L) D^-1 (D + L)^T (Saad 2003): `solve` of
// solver/algebra/block_ldlt.h solves M x = b. They take one product a block, whatever the order.

/// Lays out the matrix for an elimination order of nodes coupled by `edges`, without fill.
void layOutWithoutFill(std::span<const std::int32_t> order, std::span<const BlockPair> edges, BlockCholesky& matrix);

/// Keeps a copy of the matrix in `diagonal` and `lower`, and makes the factors of M of these. Returns false where a block of the
/// diagonal is not positive definite.
bool factoriseWithoutFill(BlockCholesky& matrix);

/// y = A x, both [nodes][12] by node.
void multiply(BlockCholesky& matrix, std::span<const double> x, std::span<double> y);

}  // namespace springtower
