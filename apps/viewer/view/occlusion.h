#pragma once

#include "core/state.h"

#include <array>
#include <cstdint>
#include <vector>

namespace springtower {

// How much of the sky is hidden by blocks that are near: what makes gaps dark. Blocks are taken as boxes.

/// Boxes of all blocks and which of them are near each other, as the shader of blocks reads them.
struct Nearby {
  static constexpr std::size_t kMost = 8;
  std::vector<std::array<float, 4>> boxes;  ///< [4 block]: the centre; then unit axes, each with half the size along it, m
  std::vector<std::int32_t> near;           ///< [8 block + i]: the nearest blocks within kNearReach_m, -1 for none
};

inline constexpr double kNearReach_m = 0.024;   ///< how far a block darkens others
inline constexpr double kFloorReach_m = 0.045;  ///< and the floor

Nearby nearbyOf(const ParticleArray& position);

/// How much of the sky is seen from the floor, on a square grid; 1 outside.
struct FloorOpenness {
  static constexpr std::size_t kCells = 128;  ///< a side
  std::array<float, 2> corner{};              ///< m, of the grid
  float side = 1.0F;                          ///< m
  std::vector<std::uint8_t> open;             ///< [kCells y + x], 255: all of it
};

/// The openness around a place.
FloorOpenness floorOpenness(const Nearby& nearby, const Vec3& middle, double side_m);

/// The same at one place of the floor.
double opennessAt(const Nearby& nearby, std::size_t block, const Vec3& place);

}  // namespace springtower
