#pragma once

#include "core/state.h"

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace springtower {

/// What a block covers as seen from above: a rectangle along its longest horizontal edge, and the heights it reaches from and to.
struct Footprint {
  Eigen::Vector2d middle;               ///< m
  std::array<Eigen::Vector2d, 2> axis;  ///< unit, at right angles
  Eigen::Vector2d half;                 ///< m along the axes
  double bottom_m = 0.0;
  double top_m = 0.0;
};

/// Of a block as it lies.
Footprint footprintOf(const ParticleArray& position, std::size_t block);

/// Of a block of these dimensions (m) with its centre at a place (m).
Footprint footprintOf(const Vec3& place, const Eigen::Quaterniond& turn, const Vec3& dimensions);

/// Of all blocks, [blocks].
std::vector<Footprint> footprintsOf(const ParticleArray& position);

/// How far two rectangles overlap, m: the least way that parts them; negative where there is a gap between them along one of
/// their axes.
double overlapOf(const Footprint& a, const Footprint& b);

/// The same rectangle with its sides moved outwards by a margin, m.
Footprint grown(Footprint footprint, double margin_m);

/// The height of the highest block under a footprint, m, without the block `except`; 0 (the floor) where there is none. Blocks
/// that overlap it by less than tuning::kMinOutlineOverlap_m lie beside it.
double levelBelow(std::span<const Footprint> all, std::size_t except, const Footprint& footprint);

}  // namespace springtower
