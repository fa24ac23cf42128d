#include "apps/viewer/session/footprint.h"

#include "core/tuning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace springtower {
namespace {

Footprint aroundCorners(std::span<const Vec3> corners, const Vec3& longest) {
  Footprint footprint;
  footprint.axis[0] = longest.head<2>().normalized();
  footprint.axis[1] = {-footprint.axis[0].y(), footprint.axis[0].x()};
  Eigen::Vector2d least = Eigen::Vector2d::Constant(1e300);
  Eigen::Vector2d most = -least;
  footprint.bottom_m = 1e300;
  footprint.top_m = -1e300;
  for (const Vec3& corner : corners) {
    const Eigen::Vector2d flat = corner.head<2>();
    const Eigen::Vector2d along(flat.dot(footprint.axis[0]), flat.dot(footprint.axis[1]));
    least = least.cwiseMin(along);
    most = most.cwiseMax(along);
    footprint.bottom_m = std::min(footprint.bottom_m, corner.z());
    footprint.top_m = std::max(footprint.top_m, corner.z());
  }
  const Eigen::Vector2d middle = 0.5 * (least + most);
  footprint.middle = middle.x() * footprint.axis[0] + middle.y() * footprint.axis[1];
  footprint.half = 0.5 * (most - least);
  return footprint;
}

// The edge that is longest as seen from above.
Vec3 longestSeen(const Eigen::Matrix3d& edges) {
  Eigen::Index best = 0;
  edges.topRows<2>().colwise().norm().maxCoeff(&best);
  return edges.col(best);
}

}  // namespace

Footprint footprintOf(const ParticleArray& position, std::size_t block) {
  std::array<Vec3, kCorners> corners;
  for (std::size_t c = 0; c < kCorners; ++c) corners[c] = position.at(block, c);
  return aroundCorners(corners, longestSeen(meanEdges(position, block)));
}

Footprint footprintOf(const Vec3& place, const Eigen::Quaterniond& turn, const Vec3& dimensions) {
  const Eigen::Matrix3d edges = turn.toRotationMatrix() * dimensions.asDiagonal();
  std::array<Vec3, kCorners> corners;
  for (std::size_t c = 0; c < kCorners; ++c) {
    corners[c] = place;
    for (std::size_t a = 0; a < 3; ++a) corners[c] += 0.5 * cornerSide(c, a) * edges.col(static_cast<Eigen::Index>(a));
  }
  return aroundCorners(corners, longestSeen(edges));
}

std::vector<Footprint> footprintsOf(const ParticleArray& position) {
  std::vector<Footprint> all;
  all.reserve(position.blockCount());
  for (std::size_t b = 0; b < position.blockCount(); ++b) all.push_back(footprintOf(position, b));
  return all;
}

double overlapOf(const Footprint& a, const Footprint& b) {
  const Eigen::Vector2d between = b.middle - a.middle;
  double least = 1e300;
  for (const Footprint* own : {&a, &b}) {
    for (const Eigen::Vector2d& axis : own->axis) {
      double reach = 0.0;
      for (const Footprint* each : {&a, &b}) {
        for (std::size_t i = 0; i < 2; ++i) reach += each->half[static_cast<Eigen::Index>(i)] * std::abs(axis.dot(each->axis[i]));
      }
      least = std::min(least, reach - std::abs(between.dot(axis)));
    }
  }
  return least;
}

Footprint grown(Footprint footprint, double margin_m) {
  footprint.half.array() += margin_m;
  return footprint;
}

double levelBelow(std::span<const Footprint> all, std::size_t except, const Footprint& footprint) {
  double level = 0.0;
  for (std::size_t b = 0; b < all.size(); ++b) {
    if (b == except || all[b].top_m <= level) continue;
    if (overlapOf(all[b], footprint) > tuning::kMinOutlineOverlap_m) level = all[b].top_m;
  }
  return level;
}

}  // namespace springtower
