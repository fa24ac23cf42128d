#pragma once

#include "core/state.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace springtower {

/// A view of the scene: a frame of axes (right, up, towards the viewer) at a point, in perspective unless the distance is
/// endless. Precondition: it does not look straight down or up.
struct View {
  Vec3 middle;
  Vec3 right;
  Vec3 up;
  Vec3 back;
  double distance = std::numeric_limits<double>::infinity();  ///< of the eye from the middle, m
  double scale = 1.0;                                         ///< samples a metre at the middle
  double x = 0.0;                                             ///< sample of the middle
  double y = 0.0;

  View(const Vec3& lookedAt, const Vec3& towardsViewer) : middle(lookedAt), back(towardsViewer.normalized()) {
    right = Vec3::UnitZ().cross(back).normalized();
    up = back.cross(right);
  }
  /// Sample x and y, and a nearness that is linear over the samples of a plane: larger is nearer.
  [[nodiscard]] Vec3 project(const Vec3& point) const {
    const Vec3 d = point - middle;
    const bool perspective = std::isfinite(distance);
    const double shrink = perspective ? 1.0 / std::max(1.0 - d.dot(back) / distance, kNearest) : 1.0;
    return {x + scale * shrink * d.dot(right), y - scale * shrink * d.dot(up), perspective ? shrink : d.dot(back)};
  }
  /// Whether a point lies in front of the eye and not too near to it.
  [[nodiscard]] bool sees(const Vec3& point) const { return (point - middle).dot(back) < (1.0 - kNearest) * distance; }

  static constexpr double kNearest = 0.05;  ///< least distance from the eye, in distances of the middle
};

/// Nearness of the nearest face at each sample, and which face it is.
struct Raster {
  int width;
  int height;
  std::vector<float> nearness;
  std::vector<std::int32_t> face;  ///< 2 (6 block + face), + 1 on an edge; -1 for none

  Raster(int w, int h)
      : width(w),
        height(h),
        nearness(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), -std::numeric_limits<float>::infinity()),
        face(nearness.size(), -1) {}
  [[nodiscard]] std::size_t at(int column, int line) const {
    return static_cast<std::size_t>(line) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
};

/// Draws all blocks: a sample within `edgeWidth` samples of the side of a face belongs to its edge. Nearer faces cover others,
/// faces turned away are left out.
void drawBlocks(Raster& raster, const View& view, const ParticleArray& position, double edgeWidth);

}  // namespace springtower
