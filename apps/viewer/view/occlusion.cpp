#include "apps/viewer/view/occlusion.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace springtower {
namespace {

constexpr double kLift_m = 0.008;  // what stands beside a place hides it as seen from so high above
constexpr double kDarkest = 0.6;   // share of the light that a block that touches takes

// A box as it is needed here.
struct Box {
  Vec3 centre;
  Eigen::Matrix3d axes;  // columns
  Vec3 half;
  [[nodiscard]] Vec3 reach() const { return axes.cwiseAbs() * half; }  // half the sides of the upright box around it
};

Box boxAt(const Nearby& nearby, std::size_t block) {
  Box box;
  const auto* texel = &nearby.boxes[4 * block];
  for (int i = 0; i < 3; ++i) {
    box.centre[i] = static_cast<double>(texel[0][static_cast<std::size_t>(i)]);
    box.half[i] = static_cast<double>(texel[1 + i][3]);
    for (int a = 0; a < 3; ++a) box.axes(i, a) = static_cast<double>(texel[1 + a][static_cast<std::size_t>(i)]);
  }
  return box;
}

double gapBetween(const Box& a, const Box& b) {
  const Vec3 gap = ((a.centre - b.centre).cwiseAbs() - a.reach() - b.reach()).cwiseMax(0.0);
  return gap.norm();
}

void addBox(const ParticleArray& position, std::size_t block, Nearby& nearby) {
  const Vec3 middle = centre(position, block);
  const auto four = [](const Vec3& v, double w) {
    return std::array<float, 4>{static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
                                static_cast<float>(w)};
  };
  nearby.boxes.push_back(four(middle, 0.0));
  for (std::size_t a = 0; a < 3; ++a) {
    const Vec3 edge = meanEdge(position, block, a);
    nearby.boxes.push_back(four(edge.normalized(), 0.5 * edge.norm()));
  }
}

}  // namespace

Nearby nearbyOf(const ParticleArray& position) {
  const std::size_t blocks = position.blockCount();
  Nearby nearby;
  for (std::size_t b = 0; b < blocks; ++b) addBox(position, b, nearby);
  std::vector<Box> boxes;
  for (std::size_t b = 0; b < blocks; ++b) boxes.push_back(boxAt(nearby, b));
  // In the order of their lower ends along x, so that only those are compared that overlap there.
  std::vector<std::size_t> order(blocks);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto low = [&](std::size_t b) { return boxes[b].centre.x() - boxes[b].reach().x(); };
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return low(a) < low(b); });
  std::vector<std::vector<std::pair<double, std::int32_t>>> found(blocks);
  for (std::size_t i = 0; i < blocks; ++i) {
    const std::size_t a = order[i];
    const double end = boxes[a].centre.x() + boxes[a].reach().x() + kNearReach_m;
    for (std::size_t j = i + 1; j < blocks && low(order[j]) < end; ++j) {
      const std::size_t b = order[j];
      const double gap = gapBetween(boxes[a], boxes[b]);
      if (gap >= kNearReach_m) continue;
      found[a].emplace_back(gap + 0.1 * (boxes[a].centre - boxes[b].centre).norm(), static_cast<std::int32_t>(b));
      found[b].emplace_back(gap + 0.1 * (boxes[a].centre - boxes[b].centre).norm(), static_cast<std::int32_t>(a));
    }
  }
  nearby.near.assign(Nearby::kMost * blocks, -1);
  for (std::size_t b = 0; b < blocks; ++b) {
    std::sort(found[b].begin(), found[b].end());
    for (std::size_t i = 0; i < std::min(found[b].size(), Nearby::kMost); ++i)
      nearby.near[Nearby::kMost * b + i] = found[b][i].second;
  }
  return nearby;
}

double opennessAt(const Nearby& nearby, std::size_t block, const Vec3& place) {
  const Box box = boxAt(nearby, block);
  const Vec3 lifted = box.axes.transpose() * (place + kLift_m * Vec3::UnitZ() - box.centre);
  const Vec3 nearest = lifted.cwiseMax(-box.half).cwiseMin(box.half);
  const Vec3 way = box.axes * (nearest - lifted) + kLift_m * Vec3::UnitZ();
  const double far = way.norm();
  const double near = std::max(0.0, 1.0 - far / kFloorReach_m);
  return 1.0 - kDarkest * std::max(0.0, way.z() / std::max(far, 1e-9)) * near * near;
}

FloorOpenness floorOpenness(const Nearby& nearby, const Vec3& middle, double side_m) {
  constexpr std::size_t kCells = FloorOpenness::kCells;
  FloorOpenness floor;
  floor.corner = {static_cast<float>(middle.x() - 0.5 * side_m), static_cast<float>(middle.y() - 0.5 * side_m)};
  floor.side = static_cast<float>(side_m);
  std::vector<float> open(kCells * kCells, 1.0F);
  const double cell = side_m / kCells;
  const auto cellOf = [&](double at, int axis) {
    const double from = (at - static_cast<double>(floor.corner[static_cast<std::size_t>(axis)])) / cell;
    return static_cast<std::size_t>(std::clamp(from, 0.0, static_cast<double>(kCells)));
  };
  for (std::size_t b = 0; 4 * b < nearby.boxes.size(); ++b) {
    const Box box = boxAt(nearby, b);
    const Vec3 reach = box.reach();
    if (box.centre.z() - reach.z() > kFloorReach_m) continue;
    const Vec3 low = box.centre - reach - Vec3::Constant(kFloorReach_m);
    const Vec3 high = box.centre + reach + Vec3::Constant(kFloorReach_m);
    for (std::size_t y = cellOf(low.y(), 1); y < std::min(cellOf(high.y(), 1) + 1, kCells); ++y) {
      for (std::size_t x = cellOf(low.x(), 0); x < std::min(cellOf(high.x(), 0) + 1, kCells); ++x) {
        const Vec3 place(static_cast<double>(floor.corner[0]) + (static_cast<double>(x) + 0.5) * cell,
                         static_cast<double>(floor.corner[1]) + (static_cast<double>(y) + 0.5) * cell, 0.0);
        open[kCells * y + x] *= static_cast<float>(opennessAt(nearby, b, place));
      }
    }
  }
  floor.open.resize(open.size());
  for (std::size_t i = 0; i < open.size(); ++i) floor.open[i] = static_cast<std::uint8_t>(std::lround(255.0F * open[i]));
  return floor;
}

}  // namespace springtower
