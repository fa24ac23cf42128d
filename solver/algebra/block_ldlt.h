#pragma once

#include "core/ids.h"
#include "core/vector.h"
#include "solver/algebra/block_size.h"
#include "solver/algebra/elimination_tasks.h"

#include <cstdint>
#include <span>
#include <vector>

namespace springtower {

/// Position of a pair of nodes in the matrix: which stored block, and whether the pair's first node is that block's row.
struct BlockSlot {
  std::int32_t at = -1;
  bool firstIsRow = true;
};

/// A symmetric positive definite matrix of 12 x 12 blocks, and its factors A = L D L^T in place (block elimination without
/// pivoting; George & Liu 1981). In float: it serves as an approximate inverse, and its errors are corrected through the exact
/// residual.
struct BlockCholesky {
  std::vector<std::int32_t> position;     ///< of each node in the elimination order
  std::vector<std::int32_t> node;         ///< inverse of `position`
  std::vector<std::int32_t> columnStart;  ///< blocks below the diagonal of column j are columnStart[j] .. columnStart[j + 1]
  std::vector<std::int32_t> row;          ///< their rows, ascending
  std::vector<std::int32_t> targetStart;  ///< per block: start of the list of targets of its updates
  std::vector<std::int32_t> target;       ///< blocks (>= 0) or diagonals (-1 - row) that elimination updates, in order
  std::size_t products = 0;               ///< of 12 x 12 blocks that a factorisation takes
  AlignedVector<float> diagonal;          ///< [nodes][144]; after factorisation the inverse of D
  AlignedVector<float> lower;             ///< [blocks][144]; after factorisation the transposed blocks of L
  std::vector<std::int32_t> mark, firstChild, nextChild, edgeStart, edgeRow;  ///< working space of `analyse`
  AlignedVector<float> work;                                                  ///< working space of solutions, [nodes][12]
  EliminationTasks tasks;                                                     ///< of a wide matrix; else empty
  AlignedVector<float> divided;      ///< working space of the top's eliminations, [tallest column][144]
  AlignedVector<float> taken;        ///< working space of solutions: what tasks take from values of the top, [tasks][top][12]
  bool isWithoutFill = false;        ///< see solver/algebra/gauss_seidel.h
  AlignedVector<float> ownDiagonal;  ///< of a matrix without fill: the matrix itself, [nodes][144]
  AlignedVector<float> ownLower;     ///< the same, [blocks][144]

  [[nodiscard]] std::size_t nodeCount() const { return node.size(); }
  [[nodiscard]] std::size_t blockCount() const { return row.size(); }
};

/// Finds the fill and the number of 12 x 12 block products of a factorisation (matrix.products) for this elimination order; the
/// first part of `analyse`. Returns false if there are more than `mostProducts`.
bool findPattern(std::span<const std::int32_t> order, std::span<const BlockPair> edges, std::size_t mostProducts,
                 BlockCholesky& matrix);

/// The pattern of the matrix itself for this elimination order, without fill.
void layOutPattern(std::span<const std::int32_t> order, std::span<const BlockPair> edges, BlockCholesky& matrix);

/// Lists the updates of each elimination, divides a wide matrix into tasks, and sizes the matrix, for the pattern that
/// `findPattern` found; the second part of `analyse`.
void listUpdates(BlockCholesky& matrix);

/// Returns the working space of the layout.
void releaseLayoutSpace(BlockCholesky& matrix);

/// Lays out the matrix for an elimination order (a permutation: order[k] is the k-th node) of nodes coupled by `edges`, including
/// all fill. Returns false, and lays out nothing, if factorising would take more than `mostProducts` products of 12 x 12 blocks.
bool analyse(std::span<const std::int32_t> order, std::span<const BlockPair> edges, std::size_t mostProducts,
             BlockCholesky& matrix);

/// Whether the layout has a block for each of these pairs of nodes.
bool holds(const BlockCholesky& matrix, std::span<const BlockPair> edges);

/// The block of a coupled pair of nodes.
BlockSlot slotOf(const BlockCholesky& matrix, std::int32_t first, std::int32_t second);

/// Sets all entries to zero.
void clear(BlockCholesky& matrix);

/// Factorises the matrix in `diagonal` (full blocks) and `lower`, a wide one on many threads, with the same bits on any number.
/// Precondition: positive definite. Returns false where a pivot is not positive.
bool factorise(BlockCholesky& matrix);

/// Solves A x = b in place, a wide system on many threads as above; `values` holds 12 numbers a node, by node.
void solve(BlockCholesky& matrix, std::span<double> values);

}  // namespace springtower
