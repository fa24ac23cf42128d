#include "solver/implicit/contact_matrix.h"

#include "core/lanes.h"
#include "solver/algebra/block_kernels.h"
#include "solver/implicit/friction_tangent.h"
#include "solver/law/point_places.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <cmath>

namespace springtower {

namespace {

constexpr std::size_t kQuads = kNodeSize / 4;

// Three numbers, repeated along the twelve of a row of the matrix, [vector][component].
struct Pattern {
  Lanes quad[kQuads];
};

SPRINGTOWER_INLINE void repeat(const double* of, Pattern& pattern) {
  for (std::size_t e = 0; e < kNodeSize; ++e) pattern.quad[e / 4][e % 4] = of[e % 3];
}

// Four numbers, each three times, along a row.
SPRINGTOWER_INLINE void spread(const Lanes& of, Pattern& pattern) {
  shuffle<0, 0, 0, 1>(of, of, pattern.quad[0]);
  shuffle<1, 1, 2, 2>(of, of, pattern.quad[1]);
  shuffle<2, 3, 3, 3>(of, of, pattern.quad[2]);
}

// An orthonormal basis of space: the normal of a contact and two directions across it.
struct Basis {
  double axis[3][3];
  Pattern pattern[3];  // of each axis
};

SPRINGTOWER_INLINE void basisOf(const double* normal, Basis& basis) {
  const double* n = normal;
  // The axis of the world that is farthest from the normal.
  const std::size_t far = std::abs(n[0]) <= std::abs(n[1]) && std::abs(n[0]) <= std::abs(n[2]) ? 0
                          : std::abs(n[1]) <= std::abs(n[2])                                   ? 1
                                                                                               : 2;
  const double scale = 1.0 / std::sqrt(1.0 - n[far] * n[far]);
  for (std::size_t k = 0; k < 3; ++k) {
    basis.axis[0][k] = n[k];
    basis.axis[1][k] = ((k == far ? 1.0 : 0.0) - n[far] * n[k]) * scale;
  }
  const double* t = basis.axis[1];
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3;
    const std::size_t j = (k + 2) % 3;
    basis.axis[2][k] = n[i] * t[j] - n[j] * t[i];
  }
  for (std::size_t a = 0; a < 3; ++a) repeat(basis.axis[a], basis.pattern[a]);
}

// Stiffness of a point in the basis of its contact, N/m: along the normal, and the symmetric matrix across it.
struct Stiffness {
  double normal;
  double first;   // along the first direction
  double mixed;   // between the first and the second
  double second;  // along the second
};

SPRINGTOWER_INLINE void stiffnessOf(const PointStiffness& point, const Basis& basis, Stiffness& stiffness) {
  const double a = point.slip.x() * basis.axis[1][0] + point.slip.y() * basis.axis[1][1] + point.slip.z() * basis.axis[1][2];
  const double b = point.slip.x() * basis.axis[2][0] + point.slip.y() * basis.axis[2][1] + point.slip.z() * basis.axis[2][2];
  const double t = point.tangential;  // none along the slip
  stiffness = {point.normal, t * (1.0 - a * a), -t * a * b, t * (1.0 - b * b)};
}

// A matrix of couplings between the four vectors of two nodes, by rows.
struct Coupling {
  Lanes row[kAffine];
};

// The couplings that a contact adds to one block of the matrix.
struct BlockCoupling {
  Coupling normal, first, mixed, second;
};

SPRINGTOWER_INLINE void addProduct(double factor, const Lanes& p, const Lanes& q, Coupling& sum) {
  for (std::size_t i = 0; i < kAffine; ++i) sum.row[i] += factor * p[i] * q;
}

// Weights of one point on the four vectors of a block.
SPRINGTOWER_INLINE void vectorsOf(const Lanes (&weight)[3], std::size_t lane, Lanes& vectors) {
  vectors = Lanes{1.0, weight[0][lane], weight[1][lane], weight[2][lane]};
}

// Where a point pushes and where its friction acts, on the two nodes of a block of the matrix.
struct PointVectors {
  Lanes row, column;
  Lanes slipRow, slipColumn;
};

SPRINGTOWER_INLINE void addPoint(const Stiffness& s, const PointVectors& at, BlockCoupling& sum) {
  addProduct(s.normal, at.row, at.column, sum.normal);
  addProduct(s.first, at.slipRow, at.slipColumn, sum.first);
  addProduct(s.mixed, at.slipRow, at.slipColumn, sum.mixed);
  addProduct(s.second, at.slipRow, at.slipColumn, sum.second);
}

// Adds sign times the couplings to a block of the matrix.
SPRINGTOWER_INLINE void addBlock(const BlockCoupling& sum, const Basis& basis, double sign, float* block) {
  for (std::size_t p = 0; p < kAffine; ++p) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double n = sign * basis.axis[0][i];
      const double t = sign * basis.axis[1][i];
      const double u = sign * basis.axis[2][i];
      Pattern normal, first, second;
      spread(n * sum.normal.row[p], normal);
      spread(t * sum.first.row[p] + u * sum.mixed.row[p], first);
      spread(t * sum.mixed.row[p] + u * sum.second.row[p], second);
      float* to = block + kNodeSize * (3 * p + i);
      for (std::size_t g = 0; g < kQuads; ++g) {
        const Lanes total = normal.quad[g] * basis.pattern[0].quad[g] + first.quad[g] * basis.pattern[1].quad[g] +
                            second.quad[g] * basis.pattern[2].quad[g];
        Quad old;
        __builtin_memcpy(&old, to + 4 * g, sizeof old);
        old += __builtin_convertvector(total, Quad);
        __builtin_memcpy(to + 4 * g, &old, sizeof old);
      }
    }
  }
}

// The blocks of the matrix that a pair adds to; null where a side is the floor or asleep.
struct PairBlocks {
  float* upper;
  float* lower;
  float* both;
};

PairBlocks blocksOf(const IslandStep& step, NewtonSystem& island, const ContactView& m, const BlockSlot& slot) {
  BlockCholesky& matrix = island.matrix;
  const auto diagonalOf = [&](std::int32_t block) -> float* {
    if (block < 0 || step.simulation.asleep[static_cast<std::size_t>(block)] != 0) return nullptr;
    const auto node = static_cast<std::size_t>(step.engine.scratch.nodeOf[static_cast<std::size_t>(block)]);
    return matrix.diagonal.data() + kNodeMatrix * static_cast<std::size_t>(matrix.position[node]);
  };
  return {diagonalOf(m.upper), diagonalOf(m.lower),
          slot.at >= 0 ? matrix.lower.data() + kNodeMatrix * static_cast<std::size_t>(slot.at) : nullptr};
}

}  // namespace

SPRINGTOWER_KERNEL
void addContactStiffness(const IslandStep& step, NewtonSystem& island, std::size_t at, double step_s) {
  const Engine& engine = step.engine;
  const auto pair = static_cast<std::size_t>(island.touching[at]);
  const ActiveSetBits mask = island.mask[at];
  if ((mask & kAllPoints) == 0) return;
  const ContactView m = contactOf(engine, pair);
  const ContactView trial = trialOf(engine, pair, m);
  const PlacedBlocks blocks{engine.memo.frames[static_cast<std::size_t>(m.upper)],
                            m.lower < 0 ? nullptr : &engine.memo.frames[static_cast<std::size_t>(m.lower)]};
  const BlockSlot& slot = island.slot[at];
  const PairBlocks to = blocksOf(step, island, m, slot);
  const bool nearer = actsNearer(m);

  double normal[3];
  normalOf(m, blocks, normal);
  Basis basis;
  basisOf(normal, basis);
  BlockCoupling upper{}, lower{}, both{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(m.count);) {
    PlacedPoints points, friction;
    placePoints(m, blocks, normal, rowOf(i), points);
    if (nearer) placeFriction(m, blocks, normal, rowOf(i), friction);
    const PlacedPoints& slips = nearer ? friction : points;
    const std::size_t end = std::min(i + kRowPoints, static_cast<std::size_t>(m.count));
    for (; i < end; ++i) {
      if ((mask & kPushBit << i) == 0) continue;
      Stiffness stiffness;
      stiffnessOf(pointStiffness(step, m, trial, mask, i, step_s), basis, stiffness);
      Lanes onUpper, onLower, slipUpper, slipLower;
      vectorsOf(points.upper, laneOf(i), onUpper);
      vectorsOf(slips.upper, laneOf(i), slipUpper);
      if (to.upper != nullptr) addPoint(stiffness, {onUpper, onUpper, slipUpper, slipUpper}, upper);
      if (to.lower == nullptr) continue;
      vectorsOf(points.lower, laneOf(i), onLower);
      vectorsOf(slips.lower, laneOf(i), slipLower);
      addPoint(stiffness, {onLower, onLower, slipLower, slipLower}, lower);
      if (to.both == nullptr) continue;
      slot.firstIsRow ? addPoint(stiffness, {onUpper, onLower, slipUpper, slipLower}, both)
                      : addPoint(stiffness, {onLower, onUpper, slipLower, slipUpper}, both);
    }
  }
  if (to.upper != nullptr) addBlock(upper, basis, 1.0, to.upper);
  if (to.lower != nullptr) addBlock(lower, basis, 1.0, to.lower);
  if (to.both != nullptr) addBlock(both, basis, -1.0, to.both);
}

}  // namespace springtower
