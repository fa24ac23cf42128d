#pragma once

#include <array>
#include <cstdint>

namespace springtower::look {

// How blocks, table and light look, in the viewer's pictures and in those of `run --picture` alike. Colours are red, green, blue,
// 0..1, as a screen shows them.

using Rgb = std::array<double, 3>;

inline constexpr Rgb kWood = {0.900, 0.735, 0.505};
inline constexpr Rgb kEdge = {0.36, 0.24, 0.13};  ///< of a block's edges, mixed with its wood
inline constexpr Rgb kTable = {0.475, 0.365, 0.285};
inline constexpr Rgb kBackdrop = {0.885, 0.875, 0.855};
inline constexpr double kEndGrain = 0.88;  ///< brightness of a block's ends, of that of its sides

/// The sun stands behind the left shoulder of a viewer at the usual place: shares of the directions towards the viewer, to the
/// right and up.
inline constexpr Rgb kSun = {1.0, -0.75, 1.05};

/// A number from 0 to 1 that looks random, the same for a block in every picture.
inline double noise(std::uint32_t block, std::uint32_t salt) {
  std::uint32_t x = block * 0x9e3779b9U + salt * 0x85ebca6bU + 1U;
  x = (x ^ (x >> 16U)) * 0x7feb352dU;
  x = (x ^ (x >> 15U)) * 0x846ca68bU;
  return static_cast<double>(x ^ (x >> 16U)) / 4294967296.0;
}

/// The wood of one block: no two boards are alike.
inline Rgb woodOf(std::uint32_t block) {
  const double light = 0.93 + 0.12 * noise(block, 1);
  const double warm = 0.035 * (noise(block, 2) - 0.5);
  return {(kWood[0] + warm) * light, kWood[1] * light, (kWood[2] - warm) * light};
}

}  // namespace springtower::look
