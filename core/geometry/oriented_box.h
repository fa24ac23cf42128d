#pragma once

#include "core/vector.h"

#include <cstddef>

namespace springtower {

/// A cuboid: its centre (m), its own axes as columns (unit, orthogonal), its half lengths along them (m).
struct OrientedBox {
  Vec3 centre;
  Eigen::Matrix3d axes;
  Vec3 half;

  /// How far it reaches from its centre along a unit direction, m.
  [[nodiscard]] double reachAlong(const Vec3& direction) const { return (axes.transpose() * direction).cwiseAbs().dot(half); }
  /// The same along the world's axes: half lengths of its bounding box, m.
  [[nodiscard]] Vec3 reach() const { return axes.cwiseAbs() * half; }
  /// A corner, m; bit a of its number says on which side along axis a.
  [[nodiscard]] Vec3 corner(unsigned bits) const {
    Vec3 side;
    for (unsigned a = 0; a < 3; ++a) side[a] = ((bits >> a) & 1U) != 0U ? half[a] : -half[a];
    return centre + axes * side;
  }
};

/// The box of a block as a scene places it (m; a unit quaternion).
inline OrientedBox orientedBox(const Vec3& centre, const Eigen::Quaterniond& orientation, const Vec3& dimensions) {
  return {centre, orientation.toRotationMatrix(), 0.5 * dimensions};
}

/// Calls visit(i, j, axis) for the products of axes of two boxes, axis i of the one and j of the other: with their faces the
/// directions along which two boxes that do not overlap are separated (separating axis theorem). `axisOfA` and `axisOfB` give the
/// axes by number, `axis` is unit. Nearly parallel axes, with a sine of `leastSine` or less, are left out: faces decide there.
/// Stops where visit returns false. Contacts of deformed blocks have their own search (narrowphase/separation), whose face
/// normals are not the axes of edges, and which names the edges that cross.
template <class AxisOfA, class AxisOfB, class Visit>
void forEachEdgeProduct(const AxisOfA& axisOfA, const AxisOfB& axisOfB, double leastSine, const Visit& visit) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vec3 product = Vec3(axisOfA(i)).cross(Vec3(axisOfB(j)));
      const double sine = product.norm();
      if (sine > leastSine && !visit(i, j, Vec3(product / sine))) return;
    }
  }
}

}  // namespace springtower
