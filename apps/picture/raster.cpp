#include "apps/picture/raster.h"

#include <algorithm>
#include <array>

namespace springtower {
namespace {

// Half-plane left of a directed side, as a distance in samples.
struct Side {
  double x;
  double y;
  double offset;
  Side(const Vec3& from, const Vec3& to) {
    const double length = std::max(std::hypot(to.x() - from.x(), to.y() - from.y()), 1e-9);
    x = -(to.y() - from.y()) / length;
    y = (to.x() - from.x()) / length;
    offset = -(x * from.x() + y * from.y());
  }
  [[nodiscard]] double distance(double column, double line) const { return x * column + y * line + offset; }
};

// Half a face. Corners in screen coordinates; the sides from corner 0 to 1 and from 1 to 2 or from 2 to 0 are edges of the block,
// the third is the diagonal of the face.
void drawTriangle(Raster& raster, std::array<Vec3, 3> corner, bool diagonalLast, std::int32_t face, double edgeWidth) {
  const double area = (corner[1].x() - corner[0].x()) * (corner[2].y() - corner[0].y()) -
                      (corner[1].y() - corner[0].y()) * (corner[2].x() - corner[0].x());
  // Counterclockwise seen from outside is clockwise on the screen, whose y points down: such triangles face the viewer.
  if (area >= 0.0) return;
  const std::array<Side, 3> side = {Side(corner[1], corner[0]), Side(corner[2], corner[1]), Side(corner[0], corner[2])};
  const std::size_t diagonal = diagonalLast ? 2 : 0;
  const Vec3 u = corner[1] - corner[0];
  const Vec3 v = corner[2] - corner[0];
  const double slopeX = (u.z() * v.y() - v.z() * u.y()) / area;
  const double slopeY = (v.z() * u.x() - u.z() * v.x()) / area;
  const auto [left, right] = std::minmax({corner[0].x(), corner[1].x(), corner[2].x()});
  const auto [top, bottom] = std::minmax({corner[0].y(), corner[1].y(), corner[2].y()});
  const auto first = [](double low) { return static_cast<int>(std::ceil(std::max(low, 0.0))); };
  const auto last = [](double high, int size) { return static_cast<int>(std::floor(std::min(high, size - 1.0))); };
  for (int line = first(top); line <= last(bottom, raster.height); ++line) {
    for (int column = first(left); column <= last(right, raster.width); ++column) {
      double toEdge = std::numeric_limits<double>::infinity();
      double inside = std::numeric_limits<double>::infinity();
      for (std::size_t s = 0; s < 3; ++s) {
        const double distance = side[s].distance(column, line);
        inside = std::min(inside, distance);
        if (s != diagonal) toEdge = std::min(toEdge, distance);
      }
      if (inside < 0.0) continue;
      const auto nearness =
          static_cast<float>(corner[0].z() + slopeX * (column - corner[0].x()) + slopeY * (line - corner[0].y()));
      const std::size_t i = raster.at(column, line);
      if (nearness <= raster.nearness[i]) continue;
      raster.nearness[i] = nearness;
      raster.face[i] = 2 * face + (toEdge < edgeWidth ? 1 : 0);
    }
  }
}

}  // namespace

void drawBlocks(Raster& raster, const View& view, const ParticleArray& position, double edgeWidth) {
  for (std::size_t b = 0; b < position.blockCount(); ++b) {
    std::array<Vec3, kCorners> corner;
    bool seen = true;
    for (std::size_t c = 0; c < kCorners; ++c) {
      corner[c] = view.project(position.at(b, c));
      seen = seen && view.sees(position.at(b, c));
    }
    if (!seen) continue;
    for (std::size_t t = 0; t < kTriangles; ++t) {
      const auto& [i, j, k] = kTriangleCorners[t];
      const auto face = static_cast<std::int32_t>(kFaces * b + t / 2);
      // The first triangle of a face is its corners 0, 1, 2, the second 0, 2, 3.
      drawTriangle(
          raster, {corner[static_cast<std::size_t>(i)], corner[static_cast<std::size_t>(j)], corner[static_cast<std::size_t>(k)]},
          t % 2 == 0, face, edgeWidth);
    }
  }
}

}  // namespace springtower
