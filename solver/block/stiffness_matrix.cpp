#include "solver/block/stiffness_matrix.h"

#include "solver/block/inertia.h"
#include "solver/block/modes.h"
#include "solver/block/springs.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace springtower {

namespace {

using namespace block_modes;

using Full = Eigen::Matrix<double, 24, 24>;
using Small = Eigen::Matrix<double, 12, 12>;

Eigen::Index at(std::size_t vector, std::size_t component) {
  return static_cast<Eigen::Index>(3 * vector + component);
}

// Index among the twelve warp freedoms.
Eigen::Index warpAt(std::size_t vector, std::size_t component) {
  return at(vector - kAffine, component);
}

// Each column of a matrix by corner and component, transformed to vectors and written as a row. The same done twice is the matrix
// by vector and component.
Full columnsToVectors(const Full& matrix) {
  Full result;
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (std::size_t a = 0; a < 3; ++a) {
      double corners[kCorners];
      double t[kCorners];
      for (std::size_t c = 0; c < kCorners; ++c) corners[c] = matrix(at(c, a), column);
      transform(corners, t);
      for (std::size_t m = 0; m < kCorners; ++m) result(column, at(m, a)) = (m >= 1 && m < kAffine ? 0.5 : 1.0) * t[kPattern[m]];
    }
  }
  return result;
}

}  // namespace

BlockJacobian blockJacobian(const BlockModel& model, Inertia inertia, std::size_t block, double massFactor, double springFactor) {
  BlockJacobian result;
  Full whole = springFactor * columnsToVectors(columnsToVectors(springStiffnessMatrix(model, block)));
  const double corner = model.mass[block] / inverseMass(inertia).own;  // mass of a corner's deviation from the mean
  for (std::size_t m = 0; m < kCorners; ++m) {
    result.mass[m] = m == 0 ? model.mass[block] : corner * static_cast<double>(kCorners) * (m < kAffine ? 0.25 : 1.0);
    for (std::size_t a = 0; a < 3; ++a) whole(at(m, a), at(m, a)) += massFactor * result.mass[m];
  }
  const Small warps = whole.bottomRightCorner<12, 12>().inverse();
  const Small coupling = warps * whole.bottomLeftCorner<12, 12>();
  const Small affine = whole.topLeftCorner<12, 12>() - whole.topRightCorner<12, 12>() * coupling;
  for (std::size_t i = 0; i < kAffineFreedoms; ++i) {
    for (std::size_t j = 0; j < kAffineFreedoms; ++j)
      result.affine[i][j] = affine(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const Others& o = kOthers[a];
    const Eigen::Index first = warpAt(o.withB, o.b);
    const Eigen::Index second = warpAt(o.withC, o.c);
    result.pair[a] = {warps(first, first), warps(first, second), warps(second, second)};
    result.single[a] = warps(warpAt(kXYZ, a), warpAt(kXYZ, a));
    result.shear[a] = {coupling(warpAt(kXYZ, a), at(1 + o.b, o.c)), coupling(warpAt(kXYZ, a), at(1 + o.c, o.b))};
  }
  const Eigen::Index t[3] = {warpAt(kYZ, 0), warpAt(kXZ, 1), warpAt(kXY, 2)};
  result.triple = {warps(t[0], t[0]), warps(t[0], t[1]), warps(t[0], t[2]),
                   warps(t[1], t[1]), warps(t[1], t[2]), warps(t[2], t[2])};
  return result;
}

}  // namespace springtower
