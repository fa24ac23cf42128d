#include "solver/algebra/block_ldlt.h"

#include "core/lanes.h"

#include <algorithm>

namespace springtower {

namespace {

using Quad = float __attribute__((vector_size(16)));
using Octet = float __attribute__((vector_size(32)));

// One row of a block: twelve floats.
struct Row {
  Octet low;
  Quad high;
};

SPRINGTOWER_INLINE void loadRow(const float* from, Row& to) {
  __builtin_memcpy(&to.low, from, sizeof to.low);
  __builtin_memcpy(&to.high, from + 8, sizeof to.high);
}
SPRINGTOWER_INLINE void storeRow(const Row& from, float* to) {
  __builtin_memcpy(to, &from.low, sizeof from.low);
  __builtin_memcpy(to + 8, &from.high, sizeof from.high);
}
SPRINGTOWER_INLINE void subtract(float factor, const Row& row, Row& from) {
  from.low -= factor * row.low;
  from.high -= factor * row.high;
}
SPRINGTOWER_INLINE void add(float factor, const Row& row, Row& to) {
  to.low += factor * row.low;
  to.high += factor * row.high;
}

// Four rows processed together: enough for their sums to hide one another's latency, and few enough for the registers.
struct Rows {
  Row a, b, c, d;
};

SPRINGTOWER_INLINE void loadRows(const float* from, Rows& to) {
  loadRow(from, to.a);
  loadRow(from + kNodeSize, to.b);
  loadRow(from + 2 * kNodeSize, to.c);
  loadRow(from + 3 * kNodeSize, to.d);
}
SPRINGTOWER_INLINE void storeRows(const Rows& from, float* to) {
  storeRow(from.a, to);
  storeRow(from.b, to + kNodeSize);
  storeRow(from.c, to + 2 * kNodeSize);
  storeRow(from.d, to + 3 * kNodeSize);
}

// c -= w t, all 12 x 12 row by row.
SPRINGTOWER_INLINE void subtractProduct(const float* w, const float* t, float* c) {
  for (std::size_t i = 0; i < kNodeMatrix; i += 4 * kNodeSize) {
    Rows sum;
    loadRows(c + i, sum);
    for (std::size_t k = 0; k < kNodeSize; ++k) {
      Row row;
      loadRow(t + kNodeSize * k, row);
      subtract(w[i + k], row, sum.a);
      subtract(w[i + kNodeSize + k], row, sum.b);
      subtract(w[i + 2 * kNodeSize + k], row, sum.c);
      subtract(w[i + 3 * kNodeSize + k], row, sum.d);
    }
    storeRows(sum, c + i);
  }
}

// c = s t for symmetric s.
SPRINGTOWER_INLINE void product(const float* s, const float* t, float* c) {
  for (std::size_t i = 0; i < kNodeMatrix; i += 4 * kNodeSize) {
    Rows sum{};
    for (std::size_t k = 0; k < kNodeSize; ++k) {
      Row row;
      loadRow(t + kNodeSize * k, row);
      add(s[i + k], row, sum.a);
      add(s[i + kNodeSize + k], row, sum.b);
      add(s[i + 2 * kNodeSize + k], row, sum.c);
      add(s[i + 3 * kNodeSize + k], row, sum.d);
    }
    storeRows(sum, c + i);
  }
}

// Transposes four by four at a time.
SPRINGTOWER_INLINE void transpose(const float* from, float* to) {
  for (std::size_t i = 0; i < kNodeSize; i += 4) {
    for (std::size_t k = 0; k < kNodeSize; k += 4) {
      Quad a, b, c, d;
      __builtin_memcpy(&a, from + kNodeSize * i + k, sizeof a);
      __builtin_memcpy(&b, from + kNodeSize * (i + 1) + k, sizeof b);
      __builtin_memcpy(&c, from + kNodeSize * (i + 2) + k, sizeof c);
      __builtin_memcpy(&d, from + kNodeSize * (i + 3) + k, sizeof d);
      const Quad ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
      const Quad cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
      const Quad abLast = __builtin_shufflevector(a, b, 2, 6, 3, 7);
      const Quad cdLast = __builtin_shufflevector(c, d, 2, 6, 3, 7);
      const Quad first = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
      const Quad second = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
      const Quad third = __builtin_shufflevector(abLast, cdLast, 0, 1, 4, 5);
      const Quad fourth = __builtin_shufflevector(abLast, cdLast, 2, 3, 6, 7);
      __builtin_memcpy(to + kNodeSize * k + i, &first, sizeof first);
      __builtin_memcpy(to + kNodeSize * (k + 1) + i, &second, sizeof second);
      __builtin_memcpy(to + kNodeSize * (k + 2) + i, &third, sizeof third);
      __builtin_memcpy(to + kNodeSize * (k + 3) + i, &fourth, sizeof fourth);
    }
  }
}

// Splits a row into its entry p alone and the rest.
using OctetOfPlaces = std::int32_t __attribute__((vector_size(32)));
using QuadOfPlaces = std::int32_t __attribute__((vector_size(16)));
SPRINGTOWER_INLINE void split(std::int32_t p, const Row& row, float entry, Row& without, Row& alone) {
  const OctetOfPlaces low = OctetOfPlaces{0, 1, 2, 3, 4, 5, 6, 7} == p;
  const QuadOfPlaces high = QuadOfPlaces{8, 9, 10, 11} == p;
  without.low = low ? Octet{} : row.low;
  without.high = high ? Quad{} : row.high;
  alone.low = low ? Octet{} + entry : Octet{};
  alone.high = high ? Quad{} + entry : Quad{};
}

// Gauss-Jordan without pivoting, in place; for positive definite blocks every pivot is positive. Rows are changed as vectors
// only: storing a single number into a row would stall the next load of it.
SPRINGTOWER_INLINE bool invert(float* m) {
  bool positive = true;
  for (std::size_t p = 0; p < kNodeSize; ++p) {
    const float pivot = m[kNodeSize * p + p];
    positive = positive && pivot > 0.0F;
    const float inverse = 1.0F / pivot;
    const auto at = static_cast<std::int32_t>(p);
    Row row, alone;
    loadRow(m + kNodeSize * p, row);
    split(at, row, inverse, row, alone);
    row.low = row.low * inverse + alone.low;
    row.high = row.high * inverse + alone.high;
    storeRow(row, m + kNodeSize * p);
    for (std::size_t i = 0; i < kNodeSize; ++i) {
      if (i == p) continue;
      const float factor = m[kNodeSize * i + p];
      Row other;
      loadRow(m + kNodeSize * i, other);
      split(at, other, 0.0F, other, alone);
      subtract(factor, row, other);
      storeRow(other, m + kNodeSize * i);
    }
  }
  return positive;
}

// y -= t^T x
SPRINGTOWER_INLINE void subtractTransposed(const float* t, const float* x, float* y) {
  Row sum;
  loadRow(y, sum);
  for (std::size_t k = 0; k < kNodeSize; ++k) {
    Row row;
    loadRow(t + kNodeSize * k, row);
    subtract(x[k], row, sum);
  }
  storeRow(sum, y);
}

// The sum over the lanes of each of four quads.
SPRINGTOWER_INLINE void laneSums(const Quad& a, const Quad& b, const Quad& c, const Quad& d, Quad& result) {
  const Quad ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Quad cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  result = __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

SPRINGTOWER_INLINE void rowTimes(const float* t, const Quad& x0, const Quad& x1, const Quad& x2, Quad& result) {
  Quad a, b, c;
  __builtin_memcpy(&a, t, sizeof a);
  __builtin_memcpy(&b, t + 4, sizeof b);
  __builtin_memcpy(&c, t + 8, sizeof c);
  result = a * x0 + b * x1 + c * x2;
}

// y -= t x
SPRINGTOWER_INLINE void subtractTimes(const float* t, const float* x, float* y) {
  Quad x0, x1, x2;
  __builtin_memcpy(&x0, x, sizeof x0);
  __builtin_memcpy(&x1, x + 4, sizeof x1);
  __builtin_memcpy(&x2, x + 8, sizeof x2);
  for (std::size_t r = 0; r < kNodeSize; r += 4) {
    Quad a, b, c, d, total, old;
    rowTimes(t + kNodeSize * r, x0, x1, x2, a);
    rowTimes(t + kNodeSize * (r + 1), x0, x1, x2, b);
    rowTimes(t + kNodeSize * (r + 2), x0, x1, x2, c);
    rowTimes(t + kNodeSize * (r + 3), x0, x1, x2, d);
    laneSums(a, b, c, d, total);
    __builtin_memcpy(&old, y + r, sizeof old);
    old -= total;
    __builtin_memcpy(y + r, &old, sizeof old);
  }
}

float* blockOf(AlignedVector<float>& values, std::size_t block) {
  return values.data() + kNodeMatrix * block;
}

std::int32_t find(const BlockCholesky& matrix, std::int32_t column, std::int32_t row) {
  const auto first = matrix.row.begin() + matrix.columnStart[static_cast<std::size_t>(column)];
  const auto last = matrix.row.begin() + matrix.columnStart[static_cast<std::size_t>(column) + 1];
  return static_cast<std::int32_t>(std::lower_bound(first, last, row) - matrix.row.begin());
}

// The pattern of A below the diagonal by columns: edgeRow[edgeStart[j] .. edgeStart[j + 1]], by a counting sort.
void findColumns(std::span<const BlockPair> edges, BlockCholesky& matrix) {
  const auto ends = [&](const BlockPair& edge) {
    const std::int32_t p = matrix.position[static_cast<std::size_t>(edge.a)];
    const std::int32_t q = matrix.position[static_cast<std::size_t>(edge.b)];
    return std::pair{static_cast<std::size_t>(std::min(p, q)), std::max(p, q)};
  };
  const std::size_t count = matrix.node.size();
  matrix.edgeStart.assign(count + 2, 0);
  matrix.edgeRow.resize(edges.size());
  for (const BlockPair& edge : edges) ++matrix.edgeStart[ends(edge).first + 2];
  for (std::size_t j = 2; j < count + 2; ++j) matrix.edgeStart[j] += matrix.edgeStart[j - 1];
  for (const BlockPair& edge : edges) {
    const auto [column, row] = ends(edge);
    matrix.edgeRow[static_cast<std::size_t>(matrix.edgeStart[column + 1]++)] = row;
  }
}

}  // namespace

bool findPattern(std::span<const std::int32_t> order, std::span<const BlockPair> edges, std::size_t mostProducts,
                 BlockCholesky& matrix) {
  const std::size_t count = order.size();
  matrix.node.assign(order.begin(), order.end());
  matrix.position.resize(count);
  for (std::size_t k = 0; k < count; ++k) matrix.position[static_cast<std::size_t>(order[k])] = static_cast<std::int32_t>(k);
  findColumns(edges, matrix);

  // The pattern of L: column j is the union of its own part of A and the remainders of the columns whose first row below the
  // diagonal is j (their parent in the elimination tree).
  matrix.columnStart.assign(1, 0);
  matrix.row.clear();
  matrix.mark.assign(count, -1);
  matrix.firstChild.assign(count, -1);
  matrix.nextChild.assign(count, -1);
  std::size_t products = 0;
  for (std::size_t j = 0; j < count; ++j) {
    const auto column = static_cast<std::int32_t>(j);
    const std::size_t first = matrix.row.size();
    matrix.mark[j] = column;
    const auto add = [&](std::int32_t row) {
      if (matrix.mark[static_cast<std::size_t>(row)] == column) return;
      matrix.mark[static_cast<std::size_t>(row)] = column;
      matrix.row.push_back(row);
    };
    for (std::int32_t i = matrix.edgeStart[j]; i < matrix.edgeStart[j + 1]; ++i) add(matrix.edgeRow[static_cast<std::size_t>(i)]);
    for (std::int32_t child = matrix.firstChild[j]; child >= 0; child = matrix.nextChild[static_cast<std::size_t>(child)]) {
      const auto c = static_cast<std::size_t>(child);
      for (std::int32_t i = matrix.columnStart[c]; i < matrix.columnStart[c + 1]; ++i)
        add(matrix.row[static_cast<std::size_t>(i)]);
    }
    const std::size_t below = matrix.row.size() - first;
    products += below * (below + 3) / 2;
    if (products > mostProducts) return false;
    std::sort(matrix.row.begin() + static_cast<std::ptrdiff_t>(first), matrix.row.end());
    matrix.columnStart.push_back(static_cast<std::int32_t>(matrix.row.size()));
    if (below == 0) continue;
    const auto parent = static_cast<std::size_t>(matrix.row[first]);
    matrix.nextChild[j] = matrix.firstChild[parent];
    matrix.firstChild[parent] = column;
  }
  matrix.products = products;
  return true;
}

bool analyse(std::span<const std::int32_t> order, std::span<const BlockPair> edges, std::size_t mostProducts,
             BlockCholesky& matrix) {
  if (!findPattern(order, edges, mostProducts, matrix)) return false;
  listUpdates(matrix);
  return true;
}

void listUpdates(BlockCholesky& matrix) {
  const std::size_t count = matrix.node.size();
  matrix.target.clear();
  matrix.targetStart.clear();
  for (std::size_t j = 0; j < count; ++j) {
    const auto first = static_cast<std::size_t>(matrix.columnStart[j]);
    const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (std::size_t i = first; i < last; ++i) {
      matrix.targetStart.push_back(static_cast<std::int32_t>(matrix.target.size()));
      for (std::size_t k = first; k < i; ++k) matrix.target.push_back(find(matrix, matrix.row[k], matrix.row[i]));
      matrix.target.push_back(-1 - matrix.row[i]);
    }
  }
  matrix.diagonal.resize(kNodeMatrix * count);
  matrix.lower.resize(kNodeMatrix * matrix.row.size());
  matrix.work.resize(kNodeSize * count);
}

bool holds(const BlockCholesky& matrix, std::span<const BlockPair> edges) {
  return std::all_of(edges.begin(), edges.end(), [&](const BlockPair& edge) {
    const std::int32_t p = matrix.position[static_cast<std::size_t>(edge.a)];
    const std::int32_t q = matrix.position[static_cast<std::size_t>(edge.b)];
    const std::int32_t at = find(matrix, std::min(p, q), std::max(p, q));
    return at < matrix.columnStart[static_cast<std::size_t>(std::min(p, q)) + 1] &&
           matrix.row[static_cast<std::size_t>(at)] == std::max(p, q);
  });
}

BlockSlot slotOf(const BlockCholesky& matrix, std::int32_t first, std::int32_t second) {
  const std::int32_t p = matrix.position[static_cast<std::size_t>(first)];
  const std::int32_t q = matrix.position[static_cast<std::size_t>(second)];
  return {find(matrix, std::min(p, q), std::max(p, q)), p > q};
}

void clear(BlockCholesky& matrix) {
  std::fill(matrix.diagonal.begin(), matrix.diagonal.end(), 0.0F);
  std::fill(matrix.lower.begin(), matrix.lower.end(), 0.0F);
}

SPRINGTOWER_KERNEL
bool factorise(BlockCholesky& matrix) {
  bool positive = true;
  for (std::size_t j = 0; j < matrix.nodeCount(); ++j) {
    float* inverse = blockOf(matrix.diagonal, j);
    positive = invert(inverse) && positive;
    const auto first = static_cast<std::size_t>(matrix.columnStart[j]);
    const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (std::size_t i = first; i < last; ++i) {
      alignas(32) float turned[kNodeMatrix];
      alignas(32) float divided[kNodeMatrix];
      float* block = blockOf(matrix.lower, i);
      transpose(block, turned);
      product(inverse, turned, divided);
      const std::int32_t* target = matrix.target.data() + matrix.targetStart[i];
      for (std::size_t k = first; k < i; ++k) {
        subtractProduct(block, blockOf(matrix.lower, k), blockOf(matrix.lower, static_cast<std::size_t>(target[k - first])));
      }
      subtractProduct(block, divided, blockOf(matrix.diagonal, static_cast<std::size_t>(-1 - target[i - first])));
      for (std::size_t r = 0; r < kNodeMatrix; r += 4 * kNodeSize) {
        Rows rows;
        loadRows(divided + r, rows);
        storeRows(rows, block + r);
      }
    }
  }
  return positive;
}

SPRINGTOWER_KERNEL
void solve(BlockCholesky& matrix, std::span<double> values) {
  float* y = matrix.work.data();
  const std::size_t count = matrix.nodeCount();
  for (std::size_t j = 0; j < count; ++j) {
    const double* from = values.data() + kNodeSize * static_cast<std::size_t>(matrix.node[j]);
    for (std::size_t c = 0; c < kNodeSize; ++c) y[kNodeSize * j + c] = static_cast<float>(from[c]);
  }
  for (std::size_t j = 0; j < count; ++j) {
    const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (auto i = static_cast<std::size_t>(matrix.columnStart[j]); i < last; ++i) {
      subtractTransposed(blockOf(matrix.lower, i), y + kNodeSize * j, y + kNodeSize * static_cast<std::size_t>(matrix.row[i]));
    }
  }
  for (std::size_t j = count; j-- > 0;) {
    float scaled[kNodeSize];
    float* mine = y + kNodeSize * j;
    Row sum{};
    const float* inverse = blockOf(matrix.diagonal, j);
    for (std::size_t k = 0; k < kNodeSize; ++k) {
      Row row;
      loadRow(inverse + kNodeSize * k, row);
      add(mine[k], row, sum);
    }
    storeRow(sum, scaled);
    const auto last = static_cast<std::size_t>(matrix.columnStart[j + 1]);
    for (auto i = static_cast<std::size_t>(matrix.columnStart[j]); i < last; ++i) {
      subtractTimes(blockOf(matrix.lower, i), y + kNodeSize * static_cast<std::size_t>(matrix.row[i]), scaled);
    }
    for (std::size_t c = 0; c < kNodeSize; ++c) mine[c] = scaled[c];
    double* to = values.data() + kNodeSize * static_cast<std::size_t>(matrix.node[j]);
    for (std::size_t c = 0; c < kNodeSize; ++c) to[c] = static_cast<double>(scaled[c]);
  }
}

}  // namespace springtower
