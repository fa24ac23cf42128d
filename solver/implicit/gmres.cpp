#include "solver/implicit/gmres.h"

#include "core/elementary.h"
#include "core/lanes.h"
#include "core/tuning.h"
#include "solver/algebra/gauss_seidel.h"
#include "solver/implicit/friction_tangent.h"
#include "solver/implicit/system.h"
#include "solver/world/over_island.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace springtower {

namespace {

// Low-rank structure: the tangent correction acts on few blocks, and right preconditioning makes the residual zero elsewhere, so
// Krylov vectors of the residual are stored for those blocks only. A matrix without fill differs from its preconditioner in all.
void findCoupledNodes(NewtonSystem& island) {
  if (island.matrix.isWithoutFill) {
    island.coupled.resize(island.residual.size());
    std::iota(island.coupled.begin(), island.coupled.end(), 0);
    return;
  }
  island.coupledIndex.assign(island.residual.size(), -1);
  island.coupled.clear();
  const auto place = [&](std::int32_t& node) {
    if (node < 0) return;
    std::int32_t& as = island.coupledIndex[static_cast<std::size_t>(node)];
    if (as < 0) {
      as = static_cast<std::int32_t>(island.coupled.size());
      island.coupled.push_back(node);
    }
    node = as;
  };
  for (ContactTangent& tangent : island.tangents) {
    place(tangent.upper);
    place(tangent.lower);
  }
}

SPRINGTOWER_INLINE double dotOf(const double* p, const double* q, std::size_t count) {
  Lanes total = {};
  for (std::size_t i = 0; i < count; i += 4) {
    Lanes a, b;
    load(p + i, a);
    load(q + i, b);
    total += a * b;
  }
  return sum(total);
}

double dot(const IslandStep& step, const double* p, const double* q, std::size_t count) {
  return sumRanges(count / kNodeSize, tuning::kBlockGrain, isWide(step), [&](std::size_t first, std::size_t last) {
    return dotOf(p + kNodeSize * first, q + kNodeSize * first, kNodeSize * (last - first));
  });
}

void addScaled(const IslandStep& step, double factor, const double* from, std::size_t count, double* to) {
  forRanges(count / kNodeSize, tuning::kBlockGrain, isWide(step), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = kNodeSize * first; i < kNodeSize * last; ++i) to[i] += factor * from[i];
  });
}

// The tangent forces at the coupled nodes' displacements in island.affine, the solution for the forces `right`. Without fill the
// solution is that of the preconditioner: to these forces is added what of `right` it leaves.
void applyTangents(NewtonSystem& island, const double* right, double* force) {
  const std::size_t count = kNodeSize * island.coupled.size();
  for (std::size_t c = 0; c < island.coupled.size(); ++c) {
    std::copy_n(island.affine.data() + kNodeSize * static_cast<std::size_t>(island.coupled[c]), kNodeSize,
                island.coupledMotion.data() + kNodeSize * c);
  }
  std::fill_n(force, count, 0.0);
  addTangentForces(island.tangents, {island.coupledMotion.data(), count}, {force, count});
  if (!island.matrix.isWithoutFill) return;
  multiply(island.matrix, island.affine, island.coupledMotion);
  for (std::size_t i = 0; i < count; ++i) force[i] += right[i] - island.coupledMotion[i];
}

// Whether the displacements of each direction are stored. In a wide island they would be most of its memory, and one more
// solution for the combined forces costs about as much as to read them; what is solved first waits in the affine part of
// island.direction, which is found last.
bool keepsCorrections(const IslandStep& step) {
  return !isWide(step);
}

// Solves for the displacements of forces on the coupled nodes.
void solveForCoupled(IslandStep& step, NewtonSystem& island, const double* force) {
  std::fill(island.affine.begin(), island.affine.end(), 0.0);
  for (std::size_t c = 0; c < island.coupled.size(); ++c)
    std::copy_n(force + kNodeSize * c, kNodeSize, island.affine.data() + kNodeSize * static_cast<std::size_t>(island.coupled[c]));
  solve(step, island);
}

// Makes room for direction j and the residual after it.
void makeRoom(const IslandStep& step, std::size_t j, std::size_t count, NewtonSystem& island) {
  const std::size_t all = island.affine.size();
  const std::size_t room = std::max(tuning::kMinGmresDirections, j + 1);
  if (island.coupledForce.size() < (room + 1) * count) island.coupledForce.resize((room + 1) * count);
  if (keepsCorrections(step) && island.correction.size() < (room + 1) * all) island.correction.resize((room + 1) * all);
}

// Stores the first solution.
void keepFirst(const IslandStep& step, NewtonSystem& island) {
  if (keepsCorrections(step)) {
    std::copy(island.affine.begin(), island.affine.end(), island.correction.begin());
    return;
  }
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t m = 0; m < kAffine; ++m)
        std::copy_n(island.affine.data() + kNodeSize * i + 3 * m, 3, island.direction[i][m].begin());
    }
  });
}

// Adds the first solution of a wide island to the last.
void addFirst(const IslandStep& step, NewtonSystem& island) {
  overBlocks(step, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t m = 0; m < kAffine; ++m) {
        for (std::size_t k = 0; k < 3; ++k) island.affine[kNodeSize * i + 3 * m + k] += island.direction[i][m][k];
      }
    }
  });
}

// Rotates column j of the Hessenberg matrix into triangular form (Givens), and the right-hand side with it.
struct LeastSquares {
  double column[tuning::kMaxGmresDirections][tuning::kMaxGmresDirections + 1];
  double cosine[tuning::kMaxGmresDirections];
  double sine[tuning::kMaxGmresDirections];
  double right[tuning::kMaxGmresDirections + 1];

  void turn(std::size_t j) {
    double* h = column[j];
    for (std::size_t k = 0; k < j; ++k) {
      const double turned = cosine[k] * h[k] + sine[k] * h[k + 1];
      h[k + 1] = cosine[k] * h[k + 1] - sine[k] * h[k];
      h[k] = turned;
    }
    const double length = elementary::hypot(h[j], h[j + 1]);
    cosine[j] = h[j] / length;
    sine[j] = h[j + 1] / length;
    h[j] = length;
    right[j + 1] = -sine[j] * right[j];
    right[j] *= cosine[j];
  }
  void backSubstitute(std::size_t count) {
    for (std::size_t j = count; j-- > 0;) {
      right[j] /= column[j][j];
      for (std::size_t k = 0; k < j; ++k) right[k] -= column[j][k] * right[j];
    }
  }
};

}  // namespace

std::size_t mostDirections(const NewtonSystem& island) {
  if (island.matrix.isWithoutFill) return tuning::kMaxGmresDirections;
  if (island.residual.size() <= tuning::kNarrowBlocks) return tuning::kMinGmresDirections;
  const std::size_t blocks = std::max<std::size_t>(1, island.matrix.blockCount());
  return std::clamp(tuning::kGmresDirectionsPerProduct * island.matrix.products / blocks, tuning::kMinGmresDirections,
                    tuning::kMaxGmresDirections);
}

bool solveCoupled(IslandStep& step, NewtonSystem& island, const GmresTolerance& tolerance) {
  island.directions = 0;
  if (island.tangents.empty() && !island.matrix.isWithoutFill) {
    solve(step, island);
    return true;
  }
  const std::size_t all = island.affine.size();
  const double allowed =
      std::max(tolerance.absolute_n, tolerance.relative * std::sqrt(dot(step, island.affine.data(), island.affine.data(), all)));
  findCoupledNodes(island);
  const std::size_t count = kNodeSize * island.coupled.size();
  island.coupledMotion.resize(count);
  makeRoom(step, 0, count, island);
  const auto force = [&](std::size_t j) { return island.coupledForce.data() + j * count; };
  const auto correction = [&](std::size_t j) { return island.correction.data() + (j + 1) * all; };

  LeastSquares squares;
  if (island.matrix.isWithoutFill) std::copy(island.affine.begin(), island.affine.end(), force(1));
  solve(step, island);
  keepFirst(step, island);
  applyTangents(island, force(1), force(0));
  squares.right[0] = std::sqrt(dot(step, force(0), force(0), count));
  if (!(squares.right[0] > allowed)) return true;
  for (std::size_t i = 0; i < count; ++i) force(0)[i] /= squares.right[0];

  std::size_t used = 0;
  const std::size_t most = mostDirections(island);
  while (used < most) {
    const std::size_t j = used++;
    makeRoom(step, j, count, island);
    solveForCoupled(step, island, force(j));
    if (keepsCorrections(step)) std::copy(island.affine.begin(), island.affine.end(), correction(j));
    double* next = force(j + 1);
    applyTangents(island, force(j), next);
    for (std::size_t i = 0; i < count; ++i) next[i] = force(j)[i] - next[i];
    for (std::size_t k = 0; k <= j; ++k) {
      squares.column[j][k] = dot(step, next, force(k), count);
      addScaled(step, -squares.column[j][k], force(k), count, next);
    }
    const double length = std::sqrt(dot(step, next, next, count));
    squares.column[j][j + 1] = length;
    squares.turn(j);
    if (!(std::abs(squares.right[j + 1]) > allowed) || !(length > 0.0)) break;
    for (std::size_t i = 0; i < count; ++i) next[i] /= length;
  }
  const bool reached = !(std::abs(squares.right[used]) > allowed);
  island.directions = static_cast<int>(used);
  squares.backSubstitute(used);
  if (!keepsCorrections(step)) {
    double* sum = force(used);
    std::fill_n(sum, count, 0.0);
    for (std::size_t j = 0; j < used; ++j) addScaled(step, squares.right[j], force(j), count, sum);
    solveForCoupled(step, island, sum);
    addFirst(step, island);
    return reached;
  }
  std::copy_n(island.correction.data(), all, island.affine.data());
  for (std::size_t j = 0; j < used; ++j) addScaled(step, squares.right[j], correction(j), all, island.affine.data());
  return reached;
}

}  // namespace springtower
