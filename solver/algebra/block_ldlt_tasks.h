#pragma once

#include "solver/algebra/block_ldlt.h"

#include <span>

namespace springtower {

/// `factorise` and `solve` of block_ldlt.h on many threads. Precondition: matrix.tasks is not empty. Every block is updated by
/// the columns of tasks in ascending order, then by those of the top: the same sums for any number of threads.
bool factoriseInTasks(BlockCholesky& matrix);
void solveInTasks(BlockCholesky& matrix, std::span<double> values);

}  // namespace springtower
