#include "core/nearest_rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace springtower {

Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& product) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sense = svd.matrixU().determinant() * svd.matrixV().determinant();  // -1: the nearest one is a mirror image
  return svd.matrixU() * Vec3(1.0, 1.0, sense).asDiagonal() * svd.matrixV().transpose();
}

}  // namespace springtower
