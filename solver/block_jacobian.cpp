#include "solver/block_jacobian.h"

#include "solver/inertia.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace springtower {

namespace {

using Full = Eigen::Matrix<double, 24, 24>;
using Small = Eigen::Matrix<double, 12, 12>;

// Patterns of the vectors by the bits of x, y, z: 1, x, y, z, xy, xz, yz, xyz.
constexpr std::array<std::size_t, kCorners> kPattern = {0, 1, 2, 4, 3, 5, 6, 7};
constexpr std::size_t kXY = 4;
constexpr std::size_t kXZ = 5;
constexpr std::size_t kYZ = 6;
constexpr std::size_t kXYZ = 7;

// For each axis a the two other axes b < c and the warps W_ab and W_ac.
struct Others {
  std::size_t b;
  std::size_t c;
  std::size_t withB;
  std::size_t withC;
};
constexpr std::array<Others, 3> kOthers = {{{1, 2, kXY, kXZ}, {0, 2, kXY, kYZ}, {0, 1, kXZ, kYZ}}};

constexpr double sign(std::size_t corner, std::size_t pattern) {
  double product = 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    if (((pattern >> a) & 1U) != 0U) product *= cornerSide(corner, a);
  }
  return product;
}

// The share of vector m in a corner's place.
double share(std::size_t corner, std::size_t m) {
  const double half = m >= 1 && m < kAffine ? 0.5 : 1.0;
  return half * sign(corner, kPattern[m]);
}

// Sums and differences of eight numbers by the bits of their index: result[p] = sum_c chi_p(c) v_c with chi by set bits; a side
// is -1 where the bit is 0.
void transform(const double* v, double (&t)[kCorners]) {
  const double x0 = v[0] + v[1];
  const double x1 = v[2] + v[3];
  const double x2 = v[4] + v[5];
  const double x3 = v[6] + v[7];
  const double d0 = v[1] - v[0];
  const double d1 = v[3] - v[2];
  const double d2 = v[5] - v[4];
  const double d3 = v[7] - v[6];
  const double xx0 = x0 + x1;
  const double xx1 = x2 + x3;
  const double dx0 = d0 + d1;
  const double dx1 = d2 + d3;
  const double xd0 = x1 - x0;
  const double xd1 = x3 - x2;
  const double dd0 = d1 - d0;
  const double dd1 = d3 - d2;
  t[0] = xx0 + xx1;
  t[4] = xx1 - xx0;
  t[1] = dx0 + dx1;
  t[5] = dx1 - dx0;
  t[2] = xd0 + xd1;
  t[6] = xd1 - xd0;
  t[3] = dd0 + dd1;
  t[7] = dd1 - dd0;
}

Full springStiffness(const BlockModel& model, std::size_t block) {
  Full stiffness = Full::Zero();
  const Vec3& size = model.dimensions[block];
  for (std::size_t group = 1; group <= kSpringGroups; ++group) {
    for (std::size_t p = 0; p < kCorners; ++p) {
      const std::size_t q = p ^ group;
      if (q < p) continue;
      Vec3 along;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        along[axis] = 0.5 * (cornerSide(q, a) - cornerSide(p, a)) * size[axis];
      }
      along.normalize();
      const Eigen::Matrix3d k = model.springStiffness[group - 1][block] * along * along.transpose();
      const auto i = static_cast<Eigen::Index>(3 * p);
      const auto j = static_cast<Eigen::Index>(3 * q);
      stiffness.block<3, 3>(i, i) += k;
      stiffness.block<3, 3>(j, j) += k;
      stiffness.block<3, 3>(i, j) -= k;
      stiffness.block<3, 3>(j, i) -= k;
    }
  }
  return stiffness;
}

Eigen::Index at(std::size_t vector, std::size_t component) {
  return static_cast<Eigen::Index>(3 * vector + component);
}

// Place among the twelve warp freedoms.
Eigen::Index warpAt(std::size_t vector, std::size_t component) {
  return at(vector - kAffine, component);
}

}  // namespace

void modeForces(const CornerArray& force, std::size_t block, ModeVectors& modes) {
  for (std::size_t a = 0; a < 3; ++a) {
    double t[kCorners];
    transform(force.values(a, block), t);
    for (std::size_t m = 0; m < kCorners; ++m) modes[m][a] = (m >= 1 && m < kAffine ? 0.5 : 1.0) * t[kPattern[m]];
  }
}

void modeDifferences(const CornerArray& to, const CornerArray& from, std::size_t block, ModeVectors& modes) {
  for (std::size_t a = 0; a < 3; ++a) {
    double difference[kCorners];
    for (std::size_t c = 0; c < kCorners; ++c) difference[c] = to.values(a, block)[c] - from.values(a, block)[c];
    double t[kCorners];
    transform(difference, t);
    for (std::size_t m = 0; m < kCorners; ++m) modes[m][a] = (m >= 1 && m < kAffine ? 0.25 : 0.125) * t[kPattern[m]];
  }
}

void addModes(const ModeVectors& modes, CornerArray& values, std::size_t block) {
  for (std::size_t a = 0; a < 3; ++a) {
    double* v = values.values(a, block);
    const double up[4] = {modes[0][a], 0.5 * modes[1][a], 0.5 * modes[2][a], modes[kXY][a]};
    const double zed[4] = {0.5 * modes[3][a], modes[kXZ][a], modes[kYZ][a], modes[kXYZ][a]};
    for (std::size_t half = 0; half < 2; ++half) {
      const double side = half == 0 ? -1.0 : 1.0;
      const double one = up[0] + side * zed[0];
      const double x = up[1] + side * zed[1];
      const double y = up[2] + side * zed[2];
      const double xy = up[3] + side * zed[3];
      v[4 * half + 0] += one - x - y + xy;
      v[4 * half + 1] += one + x - y - xy;
      v[4 * half + 2] += one - x + y - xy;
      v[4 * half + 3] += one + x + y + xy;
    }
  }
}

BlockJacobian blockJacobian(const BlockModel& model, Inertia inertia, std::size_t block, double massFactor, double springFactor) {
  Full basis = Full::Zero();
  for (std::size_t c = 0; c < kCorners; ++c) {
    for (std::size_t m = 0; m < kCorners; ++m) {
      basis.block<3, 3>(static_cast<Eigen::Index>(3 * c), static_cast<Eigen::Index>(3 * m)) =
          share(c, m) * Eigen::Matrix3d::Identity();
    }
  }
  BlockJacobian result;
  Full whole = springFactor * (basis.transpose() * springStiffness(model, block) * basis);
  const double corner = model.mass[block] / inverseMass(inertia).own;  // of what differs from the mean
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

void eliminateWarps(const BlockJacobian& jacobian, ModeVectors& residual) {
  for (std::size_t c = 0; c < 3; ++c) {
    const Others& o = kOthers[c];
    residual[1 + o.b][o.c] -= jacobian.shear[c][0] * residual[kXYZ][c];
    residual[1 + o.c][o.b] -= jacobian.shear[c][1] * residual[kXYZ][c];
  }
}

void recoverWarps(const BlockJacobian& jacobian, const ModeVectors& residual, ModeVectors& change) {
  for (std::size_t a = 0; a < 3; ++a) {
    const Others& o = kOthers[a];
    const double first = residual[o.withB][o.b];
    const double second = residual[o.withC][o.c];
    change[o.withB][o.b] = jacobian.pair[a][0] * first + jacobian.pair[a][1] * second;
    change[o.withC][o.c] = jacobian.pair[a][1] * first + jacobian.pair[a][2] * second;
    change[kXYZ][a] = jacobian.single[a] * residual[kXYZ][a] - jacobian.shear[a][0] * change[1 + o.b][o.c] -
                      jacobian.shear[a][1] * change[1 + o.c][o.b];
  }
  const double r[3] = {residual[kYZ][0], residual[kXZ][1], residual[kXY][2]};
  const auto& t = jacobian.triple;
  change[kYZ][0] = t[0] * r[0] + t[1] * r[1] + t[2] * r[2];
  change[kXZ][1] = t[1] * r[0] + t[3] * r[1] + t[4] * r[2];
  change[kXY][2] = t[2] * r[0] + t[4] * r[1] + t[5] * r[2];
}

}  // namespace springtower
